from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from scipy.interpolate import RegularGridInterpolator

import pacinian as pc
from pacinian.scene.shapes.texture import Texture, grating

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Floats

bounded = settings(max_examples=30)
WIDTH, HEIGHT = 0.03, 0.02  # [m]
VALUES = np.random.default_rng(0).uniform(0.0, 1.0, (4, 6))


def spread(seed: int, count: int = 200, reach: float = 0.1) -> Floats:
    return np.random.default_rng(seed).uniform(-reach, reach, (count, 3))


def centre(row: int, column: int) -> tuple[float, float, float]:
    """Return the position of a value of VALUES; the first row has the largest y."""
    return (column + 0.5) / 6 * WIDTH - WIDTH / 2, HEIGHT / 2 - (row + 0.5) / 4 * HEIGHT, 0.0


@pytest.mark.parametrize("repeat", [True, False])
def test_each_value_is_where_it_is_in_the_picture(repeat: bool) -> None:
    texture = Texture(values=VALUES, size=(WIDTH, HEIGHT), repeat=repeat)
    points = np.array([centre(row, column) for row in range(4) for column in range(6)])
    assert texture.at(points) == pytest.approx(VALUES.ravel())
    assert texture.at(np.empty((0, 3))).shape == (0,)
    one = Texture(values=[[0.25]], size=(WIDTH, HEIGHT), repeat=repeat)
    assert one.at(spread(0)) == pytest.approx(np.full(200, 0.25))


@given(seed=st.integers(0, 2**31))
@bounded
def test_between_its_values_it_is_bilinear_and_beyond_as_on_the_rim(seed: int) -> None:
    texture = Texture(values=VALUES, size=(WIDTH, HEIGHT), repeat=False)
    x = [centre(0, column)[0] for column in range(6)]
    y = [centre(row, 0)[1] for row in reversed(range(4))]
    points = spread(seed)
    held = np.clip(points[:, :2], [x[0], y[0]], [x[-1], y[-1]])
    expected = RegularGridInterpolator((y, x), VALUES[::-1])(held[:, ::-1])
    assert texture.at(points) == pytest.approx(expected)


@given(seed=st.integers(0, 2**31), i=st.integers(-5, 5), j=st.integers(-5, 5))
@bounded
def test_it_is_repeated_without_a_seam(seed: int, i: int, j: int) -> None:
    texture = Texture(values=VALUES, size=(WIDTH, HEIGHT))
    points = spread(seed)
    factors = texture.at(points)
    assert texture.at(points + np.array([i * WIDTH, j * HEIGHT, 0.0])) == pytest.approx(
        factors, abs=1e-9
    )
    beside = texture.at(points + np.array([1e-7, -1e-7, 0.0]))
    assert beside == pytest.approx(factors, abs=1e-4)


@given(seed=st.integers(0, 2**31), repeat=st.booleans(), z=st.floats(-1.0, 1.0))
@bounded
def test_factors_are_within_the_values_and_the_same_at_every_z(
    seed: int, repeat: bool, z: float
) -> None:
    texture = Texture(values=VALUES, size=(WIDTH, HEIGHT), repeat=repeat)
    points = spread(seed)
    factors = texture.at(points)
    assert factors.shape == (len(points),)
    assert VALUES.min() - 1e-12 <= factors.min()
    assert factors.max() <= VALUES.max() + 1e-12
    assert np.array_equal(texture.at(points + np.array([0.0, 0.0, z])), factors)


# --------------------------------------------------------------------------------- gratings


@pytest.mark.parametrize("duty", [0.0, 0.3, 1.0])
def test_a_grating_presses_for_its_share(duty: float) -> None:
    points = np.zeros((10_000, 3))
    points[:, 0] = np.linspace(-0.05, 0.05, 10_000, endpoint=False)
    points[:, 1] = spread(0, 10_000)[:, 1]
    factors = grating(0.01, duty).at(points)
    assert factors.mean() == pytest.approx(duty, abs=1e-3)
    assert np.mean((factors > 0.01) & (factors < 0.99)) < 0.07  # edges are sharp
    points[:, 0] += 0.01
    assert grating(0.01, duty).at(points) == pytest.approx(factors, abs=1e-9)


# -------------------------------------------------------------------------------- how given


def test_values_may_be_lists_arrays_a_npy_file_or_a_picture(tmp_path: Path) -> None:
    grey = np.round(255 * VALUES).astype(np.uint8)
    Image.fromarray(grey).save(tmp_path / "grey.png")
    np.save(tmp_path / "grey.npy", grey / 255)
    given_so = Texture(values=grey / 255, size=(WIDTH, HEIGHT))
    assert Texture(values=(grey / 255).tolist(), size=[WIDTH, HEIGHT]) == given_so  # type: ignore[arg-type]
    for name in ("grey.png", "grey.npy"):
        read = Texture(file=str(tmp_path / name), size=(WIDTH, HEIGHT))
        assert read.at(spread(0)) == pytest.approx(given_so.at(spread(0)), abs=1e-12)
        (tmp_path / name).unlink()
        assert read.at(spread(1)) == pytest.approx(given_so.at(spread(1)), abs=1e-12)


@pytest.mark.parametrize("form", [msgspec.json, msgspec.msgpack])
def test_textures_are_the_same_after_a_journey(form: Any) -> None:
    for texture in (
        Texture(values=VALUES, size=(WIDTH, HEIGHT), repeat=False),
        Texture(file="grey.png", size=(WIDTH, HEIGHT)),
        grating(0.01),
    ):
        assert form.decode(form.encode(texture), type=Texture) == texture


def test_a_scene_file_may_hold_its_numbers() -> None:
    texture = msgspec.toml.decode("values = [[0, 1]]\nsize = [0.02, 0.02]\n", type=Texture)
    assert texture.at(np.array([[-0.005, 0, 0], [0, 0, 0], [0.005, 0, 0]])) == pytest.approx(
        [0, 0.5, 1]
    )
    assert msgspec.json.schema(Texture)["$defs"]["Texture"]["required"] == ["size"]


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        (np.zeros(5), "2 dimensions"),
        ([[0.0, math.nan]], "finite"),
        ([[0.0, 1.001]], "from 0 to 1"),
        ([[-0.1, 1.0]], "from 0 to 1"),
        ([[0.0, 1.0], [0.0]], "numbers on a grid"),
        (None, "`file` must be given"),
    ],
)
def test_what_are_no_factors_is_refused(values: Any, problem: str) -> None:
    with pytest.raises(pc.ArgumentError, match=problem) as caught:
        Texture(values=values, size=(WIDTH, HEIGHT))
    assert caught.value.argument == "values"


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("size", lambda: Texture(values=VALUES, size=(0.0, 0.1))),
        ("size", lambda: Texture(values=VALUES, size=(20.0, 1.0))),
        ("size", lambda: Texture(values=VALUES, size=(0.1,))),  # type: ignore[arg-type]
        ("size", lambda: Texture(values=VALUES, size=None)),  # type: ignore[arg-type]
        ("period", lambda: grating(0.0)),
        ("duty", lambda: grating(0.01, -0.1)),
        ("duty", lambda: grating(0.01, 1.1)),
        ("values` of .*none.png", lambda: Texture(file="none.png", size=(0.1, 0.1)).factors),
    ],
)
def test_a_texture_that_cannot_be_is_refused_by_name(argument: str, make: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}"):
        make()


@bounded
@given(st.floats(0.001, 0.1), st.integers(1, 5), st.booleans())
def test_the_period_of_a_wave_is_its_own(period: float, count: int, upright: bool) -> None:
    wave = np.tile(0.5 + 0.5 * np.sin(np.arange(40 * count) * np.pi / 20.0), (3, 1))
    size = count * period, 0.02
    wave, size = (wave.T, size[::-1]) if upright else (wave, size)
    assert Texture(values=wave, size=size).period == pytest.approx(period)
    assert grating(period).period == pytest.approx(period)
    assert Texture(values=wave[:1, :1], size=size).period == math.inf


def test_the_period_lies_between_those_of_which_a_texture_has_most() -> None:
    rng = np.random.default_rng(5)
    noise = Texture(values=rng.random((2000, 1500)), size=(0.15, 0.2))  # pixels of 0.1 mm
    assert 2e-4 < noise.period < 4e-4
