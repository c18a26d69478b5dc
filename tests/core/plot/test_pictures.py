"""Plots of scenes and solutions show the right data."""

import errno
import os
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import pacinian as pc
from pacinian import plot
from pacinian.plot.discs import Discs, array_of, make_object, skin, towards

ARRAY = pc.autd()
FOCUS = np.array([[0.01, -0.02, 0.15]])
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.165)))
BALL = pc.Volume(shape=pc.Sphere(0.02), pose=pc.Pose((0.0, 0.0, 0.14)), radiation_pressure=5.0)


def gains(q: Any = FOCUS, asked: float = 200.0) -> pc.Gains:
    return pc.solve(ARRAY, q, np.full(len(q), asked)).gains


def felt(scene: pc.Scene) -> pc.Samples:
    sampler = pc.Sampler()
    sampler.prepare(ARRAY, pc.Air())
    return sampler.sample(scene)


def images(page: Any) -> list[Any]:
    return [panel.images[0] for panel in page.axes if panel.images]


def test_slices_show_the_focus_where_it_is() -> None:
    page = plot.slices(ARRAY, gains(), FOCUS, title="a focus", medium=pc.Air())
    peak = float(pc.radiation_pressure(np.array([200.0]), pc.Air())[0])
    for image, (i, j) in zip(images(page), ((0, 1), (0, 2)), strict=True):
        P = np.asarray(image.get_array())
        left, right, bottom, top = image.get_extent()
        row, column = np.unravel_index(P.argmax(), P.shape)
        high, wide = P.shape
        at = (
            left + (column + 0.5) / wide * (right - left),
            bottom + (row + 0.5) / high * (top - bottom),
        )
        np.testing.assert_allclose(at, 1e3 * FOCUS[0, [i, j]], atol=4.0)
        assert P.max() == pytest.approx(peak, rel=0.05)
    assert page.get_suptitle() == "a focus"


def test_silence_and_nothing_to_feel_can_be_drawn_too() -> None:
    none = np.zeros(len(ARRAY), dtype=np.complex64)
    page = plot.slices(ARRAY, none, np.empty((0, 3)), medium=pc.Air())
    assert all(not np.asarray(image.get_array()).any() for image in images(page))
    plot.scene(ARRAY, pc.Scene(), felt(pc.Scene()), none, medium=pc.Air())


def test_a_scene_is_shown_in_space_and_in_two_planes() -> None:
    scene = pc.Scene((BALL,), hands=(HAND,))
    samples = felt(scene)
    page = plot.scene(
        ARRAY, scene, samples, gains(samples.positions), title="a ball", medium=pc.Air()
    )
    views = [panel for panel in page.axes if panel.name == "3d"]
    assert [len(view.collections) for view in views] == [
        1,
        2,
    ]  # the close-up shows the samples separately
    close = views[1].collections[1]
    assert len(close.get_sizes()) == len(samples)
    assert (close.get_sizes() > 10.0).all()
    assert len(images(page)) == 2
    lines = [
        line
        for panel in page.axes
        if panel.images
        for line in panel.collections
        if line.get_paths()
    ]
    assert len(lines) == 4  # the hand and the ball, in both planes


def test_objects_that_move_are_drawn_where_they_are_at_the_time() -> None:
    moving = pc.Motion(velocity=(1.0, 0.0, 0.0))
    ball = pc.Volume(shape=pc.Sphere(0.01), pose=BALL.pose, motion=moving, radiation_pressure=5.0)
    scene = pc.Scene((ball,))
    samples = felt(pc.Scene((BALL,)))
    middle = []
    for t in (0.0, 0.03):
        page = plot.scene(ARRAY, scene, samples, gains(), t=t, medium=pc.Air())
        panel = next(panel for panel in page.axes if panel.images)
        middle.append(panel.collections[0].get_paths()[0].vertices.mean(axis=0))
    np.testing.assert_allclose(middle[1] - middle[0], (30.0, 0.0), atol=1.0)


@pytest.mark.parametrize(
    "item",
    [
        pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0),
        pc.Path(shape=pc.Circle(0.02), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0),
        pc.Particles(positions=((0.0, 0.0, 0.15),), radiation_pressure=5.0),
        pc.Surface(shape=pc.Disc(0.02), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0),
    ],
)
def test_all_kinds_of_objects_have_discs(item: Any) -> None:
    for elevation in (20.0, -20.0):
        made = make_object(item, item.pose, towards(elevation, 0.0))
        assert len(made.points)
        assert ((made.colours >= 0.0) & (made.colours <= 1.0)).all()


def test_only_what_is_turned_to_the_eye_is_drawn() -> None:
    eye = towards(-90.0, 0.0)
    np.testing.assert_allclose(eye, (0.0, 0.0, -1.0), atol=1e-12)
    below, above = skin(HAND, eye), skin(HAND, -eye)
    assert below.points[:, 2].mean() < above.points[:, 2].mean()
    half = make_object(BALL, BALL.pose, eye).points[:, 2]
    assert half.max() <= 0.14
    assert len(array_of(ARRAY).points) == len(ARRAY)


def test_a_surface_is_seen_through_and_shows_its_texture() -> None:
    from pacinian.scene.shapes.texture import grating

    plate = pc.Surface(shape=pc.Rectangle(0.1, 0.1), texture=grating(0.02), radiation_pressure=5.0)
    made = make_object(plate, plate.pose, towards(30.0, 0.0))
    assert (made.colours[:, 3] < 1.0).all()
    assert np.ptp(made.colours[:, 0]) > 0.1


def test_discs_are_kept_within_a_box() -> None:
    discs = Discs.of(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), (1.0, 0.0, 0.0), 0.01)
    kept = discs.within(np.array([[-0.1] * 3, [0.1] * 3]))
    np.testing.assert_array_equal(kept.points, [[0.0, 0.0, 0.0]])


def test_a_lost_hand_is_left_out() -> None:
    lost = pc.Hand(np.full((26, 3), np.nan))
    samples = felt(pc.Scene((BALL,)))
    drawn = [
        plot.scene(ARRAY, pc.Scene((BALL,), hands=hands), samples, gains(), medium=pc.Air())
        for hands in ((lost,), ())
    ]
    assert len({page._repr_png_()[0] for page in drawn}) == 1  # type: ignore[attr-defined]


def test_few_colours_make_a_small_file(tmp_path: Path) -> None:
    page = plot.slices(ARRAY, gains(), FOCUS, medium=pc.Air())
    sizes = []
    for name, colours in (("all", None), ("few", 64)):
        plot.save(page, tmp_path / f"{name}.png", colours)
        sizes.append((tmp_path / f"{name}.png").stat().st_size)
        with Image.open(tmp_path / f"{name}.png") as picture:
            picture.load()
    assert sizes[1] < 0.7 * sizes[0]


def test_without_matplotlib_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(pc.MissingExtra, match=r"\[plot\]"):
        plot.figure(1.0, 1.0)


def test_vector_files_keep_their_text(tmp_path: Path) -> None:
    page = plot.field(ARRAY, gains(), "xy", FOCUS[0], medium=pc.Air())
    width = page.get_size_inches()[0]
    plot.save(page, tmp_path / "field.svg")
    drawing = (tmp_path / "field.svg").read_text()
    assert ">radiation pressure on skin [Pa]</text>" in drawing
    assert f'width="{72.0 * width:g}pt"' in drawing
    plot.save(page, tmp_path / "field.pdf")
    printed = (tmp_path / "field.pdf").read_bytes()
    assert b"/FontFile2" in printed  # TrueType, which journals accept
    assert b"/Subtype /Type3" not in printed
    box = f"/MediaBox [ 0 0 {72.0 * width:g} ".encode()
    assert box in printed


def test_a_figure_is_as_wide_as_a_papers_column_with_text_of_its_size() -> None:
    for page in (plot.field(ARRAY, gains(), medium=pc.Air()), plot.drive(ARRAY, gains())):
        assert page.get_size_inches()[0] == 3.5
        for panel in page.axes:
            sizes = [panel.xaxis.label.get_size(), panel.yaxis.label.get_size()]
            sizes += [text.get_size() for text in panel.get_xticklabels() + panel.get_yticklabels()]
            assert {*sizes} <= {7.0, 8.0}


def test_a_notebook_gets_a_sharp_picture_of_a_readable_size() -> None:
    data, shown = plot.figure(3.5, 2.0)._repr_png_()  # type: ignore[attr-defined]
    with Image.open(BytesIO(data)) as picture:
        assert picture.size == (700, 400)
    assert shown == {"width": 385, "height": 220}


def test_nothing_is_cut_off_at_the_edge() -> None:
    nine = pc.autd(3, 3)
    two = pc.solve(nine, [[0.03, 0.0, 0.2], [-0.03, 0.0, 0.2]], [900.0, 600.0])
    for page in (
        plot.drive(nine, two.gains),
        plot.field(ARRAY, gains(), "xy", FOCUS[0], show="level", medium=pc.Air()),
        plot.field(ARRAY, gains(), "xz", FOCUS[0], size=(0.2, 0.1), medium=pc.Air()),
    ):
        width, height = page.bbox.size
        for panel in page.axes:
            box = panel.get_tightbbox()
            assert box is not None
            assert box.x0 > -1.0
            assert box.y0 > -1.0
            assert box.x1 < width + 1.0
            assert box.y1 < height + 1.0


def test_a_sheet_is_drawn_where_it_crosses_a_plane_and_not_as_all_that_is_behind_it() -> None:
    plate = pc.Surface(
        shape=pc.Rectangle(0.06, 0.06), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0
    )
    page = plot.scene(ARRAY, pc.Scene((plate,)), felt(pc.Scene((plate,))), gains(), medium=pc.Air())
    upright = [panel for panel in page.axes if panel.images][1]
    (line,) = upright.collections
    x, z = np.concatenate([path.vertices for path in line.get_paths()]).T
    assert np.ptp(x) == pytest.approx(60.0, abs=2.0)
    np.testing.assert_allclose(z, 150.0, atol=4.0)


def test_curves_have_colours_that_every_eye_tells_apart() -> None:
    panel = plot.figure().subplots()
    assert [panel.plot([0, 1])[0].get_color() for _ in range(2)] == ["#0072b2", "#d55e00"]


@pytest.mark.parametrize(
    ("name", "colours", "argument"),
    [("a.pdf", 64, "colours"), ("a.png", 1, "colours"), ("a.png", 257, "colours"),
     ("a.tex", None, "path"), ("a", None, "path")],
)  # fmt: skip
def test_a_file_that_cannot_be_is_refused(
    name: str, colours: int | None, argument: str, tmp_path: Path
) -> None:
    with pytest.raises(pc.ArgumentError) as told:
        plot.save(plot.figure(), tmp_path / name, colours)
    assert told.value.argument == argument
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "colours"), [("a.png", None), ("a.png", 16), ("a.pdf", None), ("a.svg", None)]
)
def test_a_picture_that_cannot_be_written_leaves_an_earlier_one(
    name: str, colours: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(number: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    file = tmp_path / name
    plot.save(plot.figure(), file, colours)
    before = file.read_bytes()
    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match=f"No space left.*{name}"):
        plot.save(plot.figure(2.0, 2.0), file, colours)
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]


def test_a_figure_has_a_size() -> None:
    for wrong in ((0.0, 1.0), (float("nan"), 1.0), (3.5, 1000.0)):
        with pytest.raises(pc.ArgumentError, match=r"width|height"):
            plot.figure(*wrong)
