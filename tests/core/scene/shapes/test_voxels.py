from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.shapes import array_data
from pacinian.scene.shapes.sdf import gradient, sample_interior
from pacinian.scene.shapes.voxels import Voxels

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Floats

bounded = settings(max_examples=8)
PITCH = 0.002  # [m]


def centres(*shape: int, pitch: float = PITCH) -> Floats:
    """Return the positions of the voxels, shape + (3,)."""
    last = np.array(shape) - 1.0
    return pitch * (np.moveaxis(np.indices(shape), 0, -1) - last / 2.0)


def voxelised(solid: Any, shape: tuple[int, ...], pitch: float = PITCH) -> Voxels:
    """Return the share of each voxel that a solid fills."""
    d = solid.distance(centres(*shape, pitch=pitch).reshape(-1, 3)).reshape(shape)
    return Voxels(values=np.clip(0.5 - d / pitch, 0.0, 1.0), pitch=pitch)


BALL = pc.Sphere(0.02)
GRID = voxelised(BALL, (24, 25, 26))
STAIRS = Voxels(
    values=BALL.distance(centres(24, 24, 24).reshape(-1, 3)).reshape((24,) * 3) < 0, pitch=PITCH
)
BLOCK = np.zeros((6, 8, 10))
BLOCK[1:-1, 1:-1, 1:-1] = 1.0  # 4 x 6 x 8 full ones


@given(
    radius=st.floats(0.01, 0.02),
    at=st.tuples(*[st.floats(-0.004, 0.004)] * 3),
    seed=st.integers(0, 2**31),
)
@bounded
def test_distances_are_those_of_the_solid_to_a_fraction_of_a_voxel(
    radius: float, at: tuple[float, float, float], seed: int
) -> None:
    from pacinian.scene.shapes.csg import Placed

    ball = Placed(pc.Sphere(radius), pc.Pose(at))
    solid = voxelised(ball, (26, 26, 26))
    points = np.random.default_rng(seed).uniform(-0.026, 0.026, (300, 3))
    expected, d = ball.distance(points), solid.distance(points)
    near = np.abs(expected) < 2 * PITCH
    assert d[near] == pytest.approx(expected[near], abs=0.15 * PITCH)
    assert d == pytest.approx(expected, abs=0.5 * PITCH)


def test_stairs_are_cut_to_about_half_a_voxel() -> None:
    points = np.random.default_rng(0).uniform(-0.024, 0.024, (500, 3))
    assert STAIRS.distance(points) == pytest.approx(BALL.distance(points), abs=0.75 * PITCH)


@pytest.mark.parametrize("level", [0.25, 0.5, 0.75])
def test_a_block_is_a_box_with_its_shell_at_the_level(level: float) -> None:
    solid = Voxels(values=BLOCK, pitch=0.01, level=level)
    half = np.array([0.02, 0.03, 0.04]) + (0.5 - level) * 0.01
    assert solid.extent == pytest.approx(half)
    for axis in range(3):
        line = np.zeros((50, 3))
        line[:, axis] = np.linspace(half[axis] - 0.01, 0.08, 50)
        assert solid.distance(line) == pytest.approx(line[:, axis] - half[axis], abs=1e-8)


def test_deep_inside_and_far_outside_it_is_still_about_right() -> None:
    box = pc.Box((0.16, 0.16, 0.16))
    solid = voxelised(box, (84, 84, 84))
    points = np.random.default_rng(0).uniform(-0.079, 0.079, (500, 3))
    error = solid.distance(points) - box.distance(points)
    assert np.sqrt((error**2).mean()) < 0.25 * PITCH
    assert np.abs(error).max() < 1.5 * PITCH
    away = np.random.default_rng(0).uniform(-1.0, 1.0, (500, 3))
    expected = GRID.distance(away) / BALL.distance(away)
    assert expected.min() > 0.99
    assert expected.max() < 1.8  # none is seen from the front


def test_distance_grows_about_as_fast_as_one_goes() -> None:
    points = np.random.default_rng(0).uniform(-0.024, 0.024, (500, 3))
    slope = np.linalg.norm(gradient(GRID, points, 1e-7), axis=1)
    assert np.median(slope) == pytest.approx(1.0, abs=0.02)
    assert slope.max() < 1.5
    shell = np.linalg.norm(gradient(GRID, GRID.sample_surface(0.004).points), axis=1)
    assert shell == pytest.approx(np.ones(len(shell)), abs=0.1)


@given(spacing=st.floats(0.003, 0.03))
@bounded
def test_samples_lie_on_the_shell_and_stand_for_all_of_it(spacing: float) -> None:
    points, normals, area = GRID.sample_surface(spacing)
    assert len(points) >= 1
    assert np.abs(GRID.distance(points)).max() < 1e-9
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)))
    assert (GRID.distance(points + 1e-5 * normals) > 0.0).all()
    assert (GRID.distance(points - 1e-5 * normals) < 0.0).all()
    assert area.sum() == pytest.approx(GRID.area, rel=1e-9)
    assert len(points) == pytest.approx(BALL.area / spacing**2, rel=0.3, abs=2)


def test_normals_are_about_those_of_the_solid() -> None:
    points, normals, _ = GRID.sample_surface(0.004)
    outward = points / np.linalg.norm(points, axis=1, keepdims=True)
    assert (normals * outward).sum(axis=1).min() > math.cos(math.radians(15))


def test_area_extent_and_reach_are_about_those_of_the_solid() -> None:
    assert GRID.area == pytest.approx(BALL.area, rel=0.02)
    assert STAIRS.area == pytest.approx(BALL.area, rel=0.15)
    assert GRID.extent == pytest.approx(BALL.extent, abs=0.1 * PITCH)
    assert GRID.bounding_radius == pytest.approx(BALL.bounding_radius, abs=0.2 * PITCH)


def test_the_interior_is_full() -> None:
    points, _, area = sample_interior(GRID, 0.003)
    volume = (
        math.prod(2 * half / math.floor(2 * half / 0.003) for half in GRID.extent)
        * (area == area.max()).sum()
    )
    assert volume == pytest.approx(4 / 3 * math.pi * (0.02 - 0.6 * 0.003) ** 3, rel=0.05)
    assert (BALL.distance(points) < 0.1 * PITCH).all()


def test_axes_are_those_of_the_array() -> None:
    corner = np.zeros((4, 5, 6))
    corner[3, 0, 5] = 1.0
    solid = Voxels(values=corner, pitch=0.01)
    at = np.array([[0.015, -0.02, 0.025]])
    assert solid.distance(at) < 0.0
    assert (solid.distance(-at) > 0.0).all()
    with_nan = solid.distance(np.concatenate([[[math.nan, 0.0, 0.0]], at]))
    assert with_nan[1] == solid.distance(at)[0]


def test_solids_that_touch_the_rim_are_closed_there() -> None:
    values = np.ones((4, 4, 4))
    values[0, 0, 0] = 0.0
    solid = Voxels(values=values, pitch=0.01)
    assert solid.extent == pytest.approx((0.02, 0.02, 0.02))
    assert (solid.distance(np.array([[0.02, 0.0, 0.0], [0.0, -0.02, 0.0]])) == 0.0).all()


# -------------------------------------------------------------------------------- how given


def test_they_can_be_given_as_lists_arrays_or_a_file(tmp_path: Path) -> None:
    np.save(tmp_path / "block.npy", BLOCK)
    given_so = Voxels(values=BLOCK, pitch=0.01)
    assert Voxels(values=BLOCK.tolist(), pitch=0.01) == given_so
    assert Voxels(values=np.asfortranarray(BLOCK), pitch=0.01) == given_so
    read = Voxels(file=str(tmp_path / "block.npy"), pitch=0.01)
    points = np.random.default_rng(0).uniform(-0.05, 0.05, (100, 3))
    for solid in (read, Voxels(values=BLOCK > 0.5, pitch=0.01)):
        assert np.array_equal(solid.distance(points), given_so.distance(points))


def test_a_file_is_read_once_and_where_it_is_said_to_be(tmp_path: Path) -> None:
    solid = Voxels(file="block.npy", pitch=0.01)
    with pytest.raises(pc.ArgumentError, match=r"block\.npy"):
        _ = solid.area
    path = tmp_path / "block.npy"
    np.save(path, BLOCK)
    found = msgspec.structs.replace(solid, file=str(path))
    area = found.area
    path.unlink()
    assert found.area == area
    assert found.distance(np.zeros((1, 3))) < 0.0


@pytest.mark.parametrize("form", [msgspec.json, msgspec.msgpack])
@pytest.mark.parametrize("dtype", [np.bool_, np.uint8, np.float32])
def test_they_are_the_same_after_a_journey(form: Any, dtype: Any) -> None:
    solid = Voxels(values=BLOCK.astype(dtype), pitch=0.01, level=0.4)
    decoded = form.decode(form.encode(solid), type=Voxels)
    assert decoded == solid
    assert hash(decoded) == hash(solid)
    assert decoded.area == solid.area
    named = Voxels(file="block.npy", pitch=0.01)
    assert form.decode(form.encode(named), type=Voxels) == named


def test_a_scene_file_may_hold_their_numbers() -> None:
    text = f'{{"type": "voxels", "pitch": 0.01, "values": {BLOCK.astype(int).tolist()}}}'
    solid = msgspec.json.decode(text, type=Voxels)
    assert solid.distance(np.array([[0.015, 0.0, 0.0]])) == pytest.approx([-0.005])


def with_one(value: float) -> Floats:
    values = BLOCK.copy()
    values[0, 0, 0] = value
    return values


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        (np.zeros((0, 3, 3)), "3 dimensions"),
        (1.0, "3 dimensions"),
        (np.zeros((3, 3, 3)), "none is above"),
        (np.ones((3, 3, 3)), "all is above"),
        (with_one(math.nan), "finite"),
        (with_one(1.5), "from 0 to 1"),
        (with_one(-0.5), "from 0 to 1"),
        (BLOCK + 0j, "real"),
        ([[[0.0, 1.0], [1.0]]], "numbers on a grid"),
        (b"\x93NUMPY nonsense", "numbers on a grid"),
        (None, "`file` must be given"),
    ],
)
def test_what_is_no_grid_is_refused(values: Any, problem: str) -> None:
    with pytest.raises(pc.ArgumentError, match=problem) as caught:
        Voxels(values=values, pitch=0.01)
    assert caught.value.argument == "values"


def test_too_many_are_refused_before_memory_is(tmp_path: Path, monkeypatch: Any) -> None:
    many = np.broadcast_to(np.uint8(1), (1000, 1000, 101))
    with pytest.raises(pc.ArgumentError, match=r"101,000,000 numbers: keep to 100,000,000"):
        Voxels(values=many, pitch=1e-5)
    np.save(tmp_path / "block.npy", BLOCK)
    monkeypatch.setattr(array_data, "MAX_NUMBERS", 100)
    with pytest.raises(pc.ArgumentError, match="480 numbers"):
        _ = Voxels(file=str(tmp_path / "block.npy"), pitch=0.01).area


def test_files_that_are_none_are_named(tmp_path: Path) -> None:
    np.save(tmp_path / "flat.npy", np.zeros((3, 3)))
    np.save(tmp_path / "objects.npy", np.array([[[None]]]), allow_pickle=True)
    np.save(tmp_path / "good.npy", BLOCK)
    (tmp_path / "cut.npy").write_bytes((tmp_path / "good.npy").read_bytes()[:-100])
    (tmp_path / "text.npy").write_text("0 1")
    np.savez(tmp_path / "many.npz", BLOCK)
    (tmp_path / "many.npz").rename(tmp_path / "zip.npy")
    (tmp_path / "folder.npy").mkdir()
    (tmp_path / "text.txt").write_text("0 1")
    for name in ("flat", "objects", "cut", "text", "zip", "folder", "none"):
        with pytest.raises(pc.ArgumentError, match=rf"{name}\.npy") as caught:
            _ = Voxels(file=str(tmp_path / f"{name}.npy"), pitch=0.01).area
        assert caught.value.argument == "values"
    with pytest.raises(pc.ArgumentError, match=r"text\.txt"):
        _ = Voxels(file=str(tmp_path / "text.txt"), pitch=0.01).area


@pytest.mark.parametrize(
    ("argument", "how"),
    [
        ("pitch` .*more than 0", {"pitch": 0.0}),
        ("pitch` .*millimetres", {"pitch": 20.0}),
        ("pitch` .*millimetres", {"pitch": 2.0}),  # makes the whole grid too large
        ("level", {"level": 0.0}),
        ("level", {"level": math.nan}),
        ("values` .*not both", {"file": "block.npy"}),
    ],
)
def test_bad_arguments_are_refused_by_name(argument: str, how: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}"):
        Voxels(**{"values": BLOCK, "pitch": 0.01, **how})
