from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from scipy.interpolate import RegularGridInterpolator

import pacinian as pc
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.sdf import gradient

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Floats

bounded = settings(max_examples=20)
WIDTH, HEIGHT = 0.09, 0.06  # [m]


def hilly(rows: int, columns: int, seed: int = 0) -> HeightMap:
    heights = np.random.default_rng(seed).uniform(-0.01, 0.01, (rows, columns))
    return HeightMap(heights=heights, width=WIDTH, height=HEIGHT)


def sloped(x: float, y: float) -> HeightMap:
    """Return a plane with these slopes."""
    X, Y = np.meshgrid([-WIDTH / 2, WIDTH / 2], [HEIGHT / 2, -HEIGHT / 2])
    return HeightMap(heights=x * X + y * Y, width=WIDTH, height=HEIGHT)


def inside(seed: int, count: int = 200) -> Floats:
    """Draw points within the outline."""
    half = np.array([WIDTH / 2, HEIGHT / 2, 0.03])
    return np.random.default_rng(seed).uniform(-0.99 * half, 0.99 * half, (count, 3))


maps = st.builds(hilly, st.integers(2, 9), st.integers(2, 9), st.integers(0, 1000))
slopes = st.floats(-2.0, 2.0)


@given(surface=maps, seed=st.integers(0, 2**31))
@bounded
def test_between_its_points_it_is_bilinear(surface: HeightMap, seed: int) -> None:
    rows, columns = surface.z.shape
    axes = np.linspace(-HEIGHT / 2, HEIGHT / 2, rows), np.linspace(-WIDTH / 2, WIDTH / 2, columns)
    height = RegularGridInterpolator(axes, surface.z)
    points = inside(seed)
    points[:, 2] = height(points[:, [1, 0]])
    assert surface.distance(points) == pytest.approx(np.zeros(len(points)), abs=1e-12)
    above = points + np.array([0.0, 0.0, 0.01])
    assert (surface.distance(above) > 0.0).all()
    assert (surface.distance(above) <= 0.01 + 1e-12).all()
    assert (surface.distance(points - [0.0, 0.0, 0.01]) < 0.0).all()


@given(x=slopes, y=slopes, seed=st.integers(0, 2**31))
@bounded
def test_the_distance_to_a_plane_is_exact(x: float, y: float, seed: int) -> None:
    points, up = inside(seed), np.array([-x, -y, 1.0]) / math.hypot(x, y, 1.0)
    surface = sloped(x, y)
    assert surface.distance(points) == pytest.approx(points @ up, abs=1e-12)
    assert gradient(surface, points) == pytest.approx(np.tile(up, (len(points), 1)), abs=1e-6)
    assert surface.area == pytest.approx(WIDTH * HEIGHT * math.hypot(x, y, 1.0))
    assert surface.sample_surface(0.0085).normals == pytest.approx(
        np.tile(up, (len(surface.sample_surface(0.0085).points), 1))
    )


@given(seed=st.integers(0, 2**31))
@bounded
def test_a_flat_one_is_a_rectangle(seed: int) -> None:
    flat, rectangle = sloped(0.0, 0.0), pc.Rectangle(WIDTH, HEIGHT)
    points = np.random.default_rng(seed).uniform(-0.1, 0.1, (200, 3))
    assert flat.distance(points) == pytest.approx(rectangle.distance(points), abs=1e-15)
    for ours, theirs in zip(
        flat.sample_surface(0.0085), rectangle.sample_surface(0.0085), strict=True
    ):
        assert ours == pytest.approx(theirs, abs=1e-15)
    assert flat.area == pytest.approx(rectangle.area)
    assert flat.bounding_radius == pytest.approx(rectangle.bounding_radius)


@given(surface=maps, seed=st.integers(0, 2**31))
@bounded
def test_beside_the_outline_the_distance_is_positive(surface: HeightMap, seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-0.1, 0.1, (200, 3))
    away = np.abs(points[:, :2]) - [WIDTH / 2, HEIGHT / 2]
    beside = away.max(axis=1) > 0.0
    assert (surface.distance(points)[beside] >= away.max(axis=1)[beside]).all()


def test_the_distance_to_a_gentle_hill_is_about_that_to_a_fine_mesh() -> None:
    x, y = np.linspace(-WIDTH / 2, WIDTH / 2, 91), np.linspace(HEIGHT / 2, -HEIGHT / 2, 61)
    X, Y = np.meshgrid(x, y)
    Z = 0.01 * np.exp(-(X**2 + Y**2) / 0.02**2)
    surface = HeightMap(heights=Z, width=WIDTH, height=HEIGHT)
    points = inside(0, 100) * (0.7, 0.7, 0.1) + [0.0, 0.0, 0.005]
    i = np.arange(60 * 91).reshape(60, 91)[:, :-1].ravel()
    faces = np.concatenate([np.stack([i, i + 91, i + 1], 1), np.stack([i + 1, i + 91, i + 92], 1)])
    mesh = trimesh.Trimesh(np.stack([X, Y, Z], axis=-1).reshape(-1, 3), faces, process=False)
    exact = trimesh.proximity.closest_point_naive(mesh, points)[1]
    near = exact < 0.003
    assert near.sum() > 20
    assert np.abs(surface.distance(points))[near] == pytest.approx(exact[near], abs=4e-4)
    assert surface.area == pytest.approx(mesh.area, rel=1e-3)


@given(surface=maps, spacing=st.floats(0.004, 0.1))
@bounded
def test_samples_lie_on_it_with_normals_upward_and_stand_for_all_of_it(
    surface: HeightMap, spacing: float
) -> None:
    points, normals, area = surface.sample_surface(spacing)
    flat = pc.Rectangle(WIDTH, HEIGHT).sample_surface(spacing)
    assert np.array_equal(points[:, :2], flat.points[:, :2])
    assert np.abs(surface.distance(points)).max() < 1e-12
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)))
    assert normals[:, 2].min() > 0.0
    assert area.sum() == pytest.approx(surface.area, rel=1e-9)
    stretched = area * normals[:, 2] / flat.area
    assert stretched == pytest.approx(np.full(len(area), stretched[0]))


@given(surface=maps)
@bounded
def test_area_and_reach_are_those_of_a_fine_cover(surface: HeightMap) -> None:
    rows, columns = surface.z.shape
    n = 40
    s, t = np.meshgrid(
        np.linspace(0, 1, n * (columns - 1) + 1), np.linspace(0, 1, n * (rows - 1) + 1)
    )
    x, y = (s - 0.5) * WIDTH, (t - 0.5) * HEIGHT
    axes = np.linspace(0, 1, rows), np.linspace(0, 1, columns)
    z = RegularGridInterpolator(axes, surface.z)(np.stack([t, s], axis=-1))
    p = np.stack([x, y, z], axis=-1)
    across = np.cross(p[1:, 1:] - p[:-1, :-1], p[1:, :-1] - p[:-1, 1:])
    assert surface.area == pytest.approx(np.linalg.norm(across, axis=-1).sum() / 2, rel=0.01)
    assert surface.bounding_radius == pytest.approx(np.linalg.norm(p, axis=-1).max())


def test_rows_and_columns_are_those_of_a_picture() -> None:
    surface = HeightMap(heights=[[0.01, 0.02], [0.03, 0.04]], width=WIDTH, height=HEIGHT)
    corners = [
        (-WIDTH, HEIGHT, 0.02),
        (WIDTH, HEIGHT, 0.04),
        (-WIDTH, -HEIGHT, 0.06),
        (WIDTH, -HEIGHT, 0.08),
    ]
    assert surface.distance(np.array(corners) / 2) == pytest.approx(np.zeros(4), abs=1e-15)


# -------------------------------------------------------------------------------- how given


@pytest.mark.parametrize(
    ("mode", "dtype", "white"), [("L", np.uint8, 255), ("I;16", np.uint16, 65535)]
)
def test_a_picture_s_white_is_as_high_as_its_depth(
    tmp_path: Path, mode: str, dtype: Any, white: int
) -> None:
    grey = np.random.default_rng(0).integers(0, white, (5, 7)).astype(dtype)
    grey[0, 0] = white
    path = tmp_path / "hill.png"
    Image.fromarray(grey).save(path)
    with Image.open(path) as image:
        assert image.mode == mode
    read = HeightMap(file=str(path), width=WIDTH, height=HEIGHT, depth=0.01)
    same = HeightMap(heights=grey / white, width=WIDTH, height=HEIGHT, depth=0.01)
    assert read.z == pytest.approx(same.z, abs=1e-12)
    assert read.z.max() == pytest.approx(0.01)
    path.unlink()
    assert read.area == pytest.approx(same.area)
    Image.new("RGB", (3, 2), (255, 255, 255)).save(path)  # colours count by their lightness
    white_one = HeightMap(file=str(path), width=WIDTH, height=HEIGHT, depth=0.01)
    assert (white_one.z == 0.01).all()


def test_heights_may_be_lists_arrays_or_a_npy_file(tmp_path: Path) -> None:
    heights = np.random.default_rng(0).uniform(0.0, 0.01, (4, 3))
    np.save(tmp_path / "hill.npy", heights)
    surface = HeightMap(heights=heights, width=WIDTH, height=HEIGHT)
    assert HeightMap(heights=heights.tolist(), width=WIDTH, height=HEIGHT) == surface
    read = HeightMap(file=str(tmp_path / "hill.npy"), width=WIDTH, height=HEIGHT)
    assert np.array_equal(read.z, surface.z)
    heights[:] = 1.0
    assert np.array_equal(read.z, surface.z)  # the given array is not used any more
    tall = HeightMap(heights=[[0, 1], [2, 3]], width=WIDTH, height=HEIGHT, depth=0.01)
    assert tall.z == pytest.approx(np.array([[0.02, 0.03], [0.0, 0.01]]))
    points = np.array([[math.nan, 0.0, 0.0], [0.0, 0.0, 0.1]])
    assert surface.distance(points)[1] > 0.0  # NaN does not affect other points


@pytest.mark.parametrize("form", [msgspec.json, msgspec.msgpack])
def test_they_are_the_same_after_a_journey(form: Any) -> None:
    surface = hilly(5, 6)
    decoded = form.decode(form.encode(surface), type=HeightMap)
    assert decoded == surface
    assert np.array_equal(decoded.z, surface.z)
    named = HeightMap(file="hill.png", width=WIDTH, height=HEIGHT, depth=0.01)
    assert form.decode(form.encode(named), type=HeightMap) == named


def test_a_scene_file_may_hold_their_numbers() -> None:
    text = 'type = "height-map"\nwidth = 0.09\nheight = 0.06\nheights = [[0, 0.01], [0, 0.01]]\n'
    surface = msgspec.toml.decode(text, type=HeightMap)
    assert surface.distance(np.zeros((1, 3))) == pytest.approx([-0.005 / math.hypot(1, 1 / 9)])


@pytest.mark.parametrize(
    ("heights", "problem"),
    [
        (np.zeros(5), "2 dimensions"),
        (np.zeros((1, 5)), "at least 2 x 2"),
        (np.zeros((5, 1)), "at least 2 x 2"),
        ([[0.0, math.nan], [0.0, 0.0]], "finite"),
        ([[0.0, 1.0], [0.0]], "numbers on a grid"),
        ([[0.0, 30.0], [0.0, 0.0]], r"metres.*millimetres"),
        ([["a", "b"], ["c", "d"]], "real numbers"),
        (None, "`file` must be given"),
    ],
)
def test_what_are_no_heights_is_refused(heights: Any, problem: str) -> None:
    with pytest.raises(pc.ArgumentError, match=problem) as caught:
        HeightMap(heights=heights, width=WIDTH, height=HEIGHT)
    assert caught.value.argument == "heights"


def test_files_that_are_none_are_named(tmp_path: Path) -> None:
    (tmp_path / "text.png").write_text("no picture")
    (tmp_path / "empty.png").write_bytes(b"")
    (tmp_path / "folder.png").mkdir()
    Image.new("L", (1, 1)).save(tmp_path / "dot.png")
    np.save(tmp_path / "block.npy", np.zeros((2, 2, 2)))
    for name in ("text.png", "empty.png", "folder.png", "none.png", "block.npy", "dot.png"):
        with pytest.raises(pc.ArgumentError, match="heights") as caught:
            _ = HeightMap(file=str(tmp_path / name), width=WIDTH, height=HEIGHT).area
        assert caught.value.argument == "heights"
        assert name in str(caught.value) or name == "dot.png"


@pytest.mark.parametrize("name", ["width", "height", "depth"])
def test_bad_sizes_are_refused_by_the_argument_s_name(name: str) -> None:
    for bad in (0.0, 20.0):
        with pytest.raises(pc.ArgumentError, match=f"^`{name}` "):
            HeightMap(heights=np.zeros((2, 2)), **{"width": WIDTH, "height": HEIGHT, name: bad})
