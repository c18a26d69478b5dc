"""Animations: the right number of pictures, each with the field of its time."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from PIL import Image

import pacinian as pc
from pacinian import plot
from pacinian.plot import animations
from pacinian.plot.emissions import Emission
from pacinian.plot.planes import cut
from pacinian.testing import ManualClock

ARRAY = pc.lattice(0.06, 0.06)
HEIGHT, RADIUS = 0.06, 0.015  # [m]
SCENE = pc.Scene(
    (
        pc.Point(
            position=(0.0, 0.0, HEIGHT),
            radiation_pressure=0.5,
            technique=pc.STM(50.0, along=pc.Circle(RADIUS)),
        ),
    )
)


def renderer(scene: Any = SCENE, array: pc.Array = ARRAY) -> pc.Renderer:
    return pc.Renderer(array, scene, adaptive=False, clock=ManualClock())


def read_pictures(path: Path) -> list[Any]:
    """Return the pictures of a file, (height, width, 3) each."""
    with Image.open(path) as found:
        pictures = []
        for k in range(getattr(found, "n_frames", 1)):
            found.seek(k)
            pictures.append(np.asarray(found.convert("RGB"), np.float64))
    return pictures


def brightest(picture: Any) -> Any:
    """Return the position of the brightest colour, x to the right and y up [px]."""
    green = np.where(np.ptp(picture, axis=2) > 40.0, picture[..., 1], 0.0)  # only coloured pixels
    green[:, int(0.68 * green.shape[1]) :] = 0.0  # the colour bar
    y, x = np.nonzero(green > 0.95 * green.max())
    return np.array([x.mean(), -y.mean()])


@pytest.mark.parametrize("kind", [".gif", ".webp", ".png"])
def test_a_focus_runs_along_its_circle(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"circle{kind}"
    # one turn in 20 ms, 10 times slower, at 25 pictures per second: 5 pictures, a fifth of a turn each
    made = plot.animate(renderer(), path, start=0.02, duration=0.02, slower=10.0, fps=25.0)
    assert made == path
    pictures = read_pictures(path)
    assert len(pictures) == 5
    with Image.open(path) as found:
        found.seek(1)
        found.load()
        assert found.info["duration"] == pytest.approx(40.0)
    places = np.array([brightest(picture) for picture in pictures])
    around = places - places.mean(axis=0)
    angles = np.unwrap(np.arctan2(around[:, 1], around[:, 0]))
    np.testing.assert_allclose(np.diff(angles), 2.0 * np.pi / 5, atol=0.25)
    radii = np.hypot(*around.T)
    np.testing.assert_allclose(radii, radii.mean(), rtol=0.15)
    assert pictures[0].shape[0] % 2 == pictures[0].shape[1] % 2 == 0


def test_a_picture_shows_the_mean_of_its_time() -> None:
    chance = np.random.default_rng(2)
    N, rows = len(ARRAY), 5
    gains = (chance.normal(size=(rows, N)) + 1j * chance.normal(size=(rows, N))).astype(
        np.complex64
    )
    emission = Emission(ARRAY, pc.Air(), 1000.0, 0.0, gains, ())
    plane = animations._thin(cut(ARRAY, "xy", (0.0, 0.0, 0.1), np.empty((0, 3)), 0.05))
    found = animations._compute_mean(emission, 1, 4, plane, "radiation")
    p = np.array(
        [pc.field(ARRAY, g, plane.points, precision="double", medium=pc.Air()) for g in gains[1:4]]
    )
    P = pc.radiation_pressure(p, pc.Air()).mean(axis=0)
    np.testing.assert_allclose(found, P, atol=1e-3 * P.max())
    phase = animations._compute_mean(emission, 1, 4, plane, "phase")
    turn = np.exp(1j * phase) * np.exp(-1j * np.angle(p[0]))
    loud = np.abs(p[0]) > 0.05 * np.abs(p[0]).max()
    np.testing.assert_allclose(turn[loud], 1.0, atol=0.01)


def test_outlines_move_with_their_objects(tmp_path: Path) -> None:
    def scene(t: float) -> pc.Scene:
        pose = pc.Pose((0.02 * np.sign(t - 0.05), 0.0, HEIGHT))
        ball = pc.Volume(shape=pc.Sphere(0.01), pose=pose, radiation_pressure=0.0)
        return pc.Scene((ball,))

    path = plot.animate(
        renderer(scene), tmp_path / "ball.png", "xz", duration=0.1, slower=10.0, fps=2.0
    )
    left, right = read_pictures(path)
    dashes = np.abs(left - right).sum(axis=2) > 60.0
    columns = np.flatnonzero(dashes[30:].any(axis=0))  # below the title
    width = left.shape[1]
    assert columns.min() < 0.45 * width
    assert columns.max() > columns.min() + 0.2 * width


def test_the_colours_end_where_told(tmp_path: Path) -> None:
    whole, dim = (
        read_pictures(plot.animate(renderer(), tmp_path / f"{top}.png", duration=0.05, top=top))[0]
        for top in (None, 100.0)
    )
    assert (whole[..., 0] > 200).sum() > (dim[..., 0] > 200).sum()
    for show in ("pressure", "level", "phase"):
        plot.animate(renderer(), tmp_path / "it.gif", show=show, duration=0.05, top=50.0)


def test_without_ffmpeg_it_says_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(pc.ArgumentError, match="needs the program ffmpeg: install it"):
        plot.animate(renderer(), tmp_path / "it.mp4", duration=0.1)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg is not installed")
def test_a_film_has_its_pictures(tmp_path: Path) -> None:
    path = plot.animate(renderer(), tmp_path / "it.mp4", duration=0.2)
    head = path.read_bytes()[:64]
    assert b"ftyp" in head


@pytest.mark.parametrize(
    ("argument", "how"),
    [
        ("path", {"path": "it.avi"}),
        ("path", {"path": "it"}),
        ("plane", {"plane": "zz"}),
        ("at", {"at": (0.0, 0.0)}),
        ("at", {"at": (0.0, 0.0, 150.0)}),  # millimetres
        ("show", {"show": "colour"}),
        ("size", {"size": -1.0}),
        ("slower", {"slower": 0.0}),
        ("fps", {"fps": 1000.0}),
        ("top", {"top": -1.0}),
        ("duration", {"duration": None}),
        ("duration", {"duration": 1e6}),
        ("duration", {"slower": 1e5}),
        ("run", {"run": ARRAY}),
    ],
)
def test_bad_arguments_are_named(argument: str, how: dict[str, Any], tmp_path: Path) -> None:
    good: dict[str, Any] = {"run": renderer(), "path": "it.gif", "duration": 0.1}
    given = good | how
    with pytest.raises(pc.ArgumentError) as told:
        plot.animate(**given | {"path": tmp_path / given["path"]})
    assert told.value.argument == argument
    assert not list(tmp_path.iterdir())
