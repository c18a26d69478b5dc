from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.scene.shapes.csg import (
    MAX_DEPTH,
    MAX_SOLIDS,
    Difference,
    Intersection,
    Placed,
    SolidShape,
    Union,
    check_closed,
)
from pacinian.scene.shapes.voxels import Voxels

from ..tools import mesh_of

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Flags, Floats

bounded = settings(max_examples=20)
lengths = st.floats(0.01, 0.05)
angles = st.floats(-math.pi, math.pi)
poses = st.builds(
    lambda axis, angle, position: pc.Pose(position).rotate(axis, angle),
    st.sampled_from("xyz"),
    angles,
    st.tuples(*[st.floats(-0.03, 0.03)] * 3),
)
primitives = st.one_of(
    st.builds(pc.Sphere, lengths),
    st.builds(lambda *size: pc.Box(size), lengths, lengths, lengths),
    st.builds(pc.Capsule, lengths, lengths),
)
placed = st.builds(Placed, primitives, poses)
parts = st.lists(placed, min_size=1, max_size=3)
simple = st.one_of(
    st.builds(Union, parts), st.builds(Intersection, parts), st.builds(Difference, placed, parts)
)
combinations = st.one_of(
    simple,
    st.builds(Difference, simple, parts),
    st.builds(lambda a, b, pose: Union((a, Placed(b, pose))), simple, placed, poses),
)

BALL = pc.Sphere(0.03)
BALLS = (BALL,)
CUBE = pc.Box((0.04, 0.04, 0.04))
APART = 0.03  # distance of the centres of two balls [m]


def at(shape: Any, *position: float) -> Placed:
    return Placed(shape, pc.Pose(position))


def inside(solid: Any, points: Floats) -> Flags:
    """Return which points are inside, by the distances of the parts alone."""
    match solid:
        case Placed():
            R = solid.pose.matrix
            return inside(solid.shape, np.linalg.solve(R, (points - solid.pose.position).T).T)
        case Union():
            return np.any([inside(part, points) for part in solid.parts], axis=0)
        case Intersection():
            return np.all([inside(part, points) for part in solid.parts], axis=0)
        case Difference():
            out = [~inside(part, points) for part in solid.less]
            return np.all([inside(solid.of, points), *out], axis=0)
    return np.asarray(solid.distance(points) < 0.0)


@given(solid=combinations, seed=st.integers(0, 2**31))
@bounded
def test_distance_is_negative_where_the_parts_say_that_it_is_inside(solid: Any, seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-0.1, 0.1, (500, 3))
    d = solid.distance(points)
    sure = np.abs(d) > 1e-9
    assert ((d < 0.0) == inside(solid, points))[sure].all()


@given(solid=combinations, seed=st.integers(0, 2**31))
@bounded
def test_distance_is_never_more_than_to_the_nearest_sample(solid: Any, seed: int) -> None:
    samples = solid.sample_surface(0.004).points
    points = np.random.default_rng(seed).uniform(-0.1, 0.1, (200, 3))
    if len(samples):
        assert (np.abs(solid.distance(points)) <= KDTree(samples).query(points)[0] + 1e-9).all()


def test_outside_of_a_union_the_distance_is_exact() -> None:
    solid = Union((BALL, at(CUBE, 0.03, 0.01, 0.0)))
    points = np.random.default_rng(0).uniform(-0.1, 0.1, (300, 3))
    d = solid.distance(points)
    spacing = 0.001
    nearest = KDTree(solid.sample_surface(spacing).points).query(points)[0]
    assert (nearest[d > 0.0] < d[d > 0.0] + spacing).all()


@given(solid=combinations)
@bounded
def test_samples_lie_on_the_shell_with_normals_outward(solid: Any) -> None:
    spacing = 0.008
    points, normals, area = solid.sample_surface(spacing)
    assert len(points) == len(normals) == len(area)
    if not len(points):
        return
    assert np.abs(solid.distance(points)).max() < 1e-9
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)))
    step = 1e-6 * normals
    assert not inside(solid, points + step).any()
    assert inside(solid, points - step).all()
    assert area.sum() == pytest.approx(solid.area, rel=1e-9)
    assert area.min() > 0.0


@given(solid=combinations)
@bounded
def test_the_box_and_the_reach_hold_it(solid: Any) -> None:
    points = solid.sample_surface(0.008).points
    assert (np.abs(points) <= np.array(solid.extent) + 1e-9).all()
    assert (np.linalg.norm(points, axis=1) <= solid.bounding_radius + 1e-9).all()


@given(solid=combinations, pose=poses, seed=st.integers(0, 2**31))
@bounded
def test_a_placed_solid_is_the_solid_moved(solid: Any, pose: pc.Pose, seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-0.1, 0.1, (100, 3))
    moved = Placed(solid, pose)
    assert moved.distance(pose.points(points)) == pytest.approx(solid.distance(points), abs=1e-12)
    local, world = solid.sample_surface(0.01), moved.sample_surface(0.01)
    assert world.points == pytest.approx(pose.points(local.points), abs=1e-12)
    assert world.normals == pytest.approx(pose.directions(local.normals), abs=1e-12)
    assert np.array_equal(world.area, local.area)
    assert moved.area == solid.area
    each = Difference(Placed(solid, pose), (Placed(BALL, pose),))  # parts with the same pose
    whole = Placed(Difference(solid, (BALL,)), pose)
    assert whole.distance(points) == pytest.approx(each.distance(points), abs=1e-12)


# ------------------------------------------------------------------------------------ areas

CAP = 2.0 * math.pi * 0.03  # area of a ball's shell per height [m]


@pytest.mark.parametrize(
    ("solid", "area"),
    [
        (Union((at(BALL, -0.1, 0, 0), at(BALL, 0.1, 0, 0))), 2 * BALL.area),
        (Union((BALL, at(BALL, 0, 0, APART))), 2 * CAP * (0.03 + APART / 2)),
        (Intersection((BALL, at(BALL, 0, 0, APART))), 2 * CAP * (0.03 - APART / 2)),
        (Difference(BALL, (at(BALL, 0, 0, APART),)), BALL.area),
        (Difference(BALL, (pc.Sphere(0.02),)), BALL.area + pc.Sphere(0.02).area),
        # touching faces vanish, and faces in one plane merge
        (Union((at(CUBE, -0.02, 0, 0), at(CUBE, 0.02, 0, 0))), pc.Box((0.08, 0.04, 0.04)).area),
        (Union((at(CUBE, -0.01, 0, 0), at(CUBE, 0.01, 0, 0))), pc.Box((0.06, 0.04, 0.04)).area),
        (Union((CUBE, CUBE)), CUBE.area),
        # a hole that ends in the faces
        (
            Difference(CUBE, (pc.Box((0.02, 0.02, 0.04)),)),
            CUBE.area - 2 * 0.02**2 + 4 * 0.02 * 0.04,
        ),
        (Difference(CUBE, (at(CUBE, 0.04, 0, 0),)), CUBE.area),
    ],
)
def test_the_area_is_that_of_the_formula(solid: Any, area: float) -> None:
    assert solid.area == pytest.approx(area, rel=0.02)


def test_each_sample_keeps_about_the_area_that_it_had_on_its_part() -> None:
    solid = Union((BALL, at(BALL, 0, 0, APART)))
    for spacing in (0.006, 0.012):
        area = solid.sample_surface(spacing).area
        assert area == pytest.approx(
            np.full(len(area), BALL.sample_surface(spacing).area[0]), rel=0.15
        )


def test_no_part_of_a_shell_is_left_bare() -> None:
    solid = Difference(Union((BALL, at(CUBE, 0.02, 0.0, 0.0))), (at(pc.Sphere(0.02), 0, 0, 0.03),))
    coarse, fine = solid.sample_surface(0.006).points, solid.sample_surface(0.002).points
    assert KDTree(coarse).query(fine)[0].max() < 1.5 * 0.006


def test_a_remnant_smaller_than_the_spacing_has_samples() -> None:
    sliver = Difference(CUBE, (at(pc.Box((0.05, 0.05, 0.05)), 0.0055, 0.0, 0.0),))
    points, normals, area = sliver.sample_surface(0.1)
    assert len(points) >= 1
    assert np.abs(sliver.distance(points)).max() < 1e-9
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)))
    assert area.sum() == pytest.approx(sliver.area)


NOTHING = Difference(CUBE, (pc.Sphere(0.1),))


@pytest.mark.parametrize(
    "nothing",
    [
        NOTHING,
        Intersection((BALL, at(BALL, 0.1, 0, 0))),
        Union((NOTHING,)),
        Intersection((NOTHING, Placed(NOTHING, pc.Pose((0.1, 0.0, 0.0))))),
        Difference(NOTHING, (Union((NOTHING,)),)),
    ],
)
def test_what_has_nothing_left_has_no_samples(nothing: Any) -> None:
    points, normals, area = nothing.sample_surface(0.0085)
    assert points.shape == normals.shape == (0, 3)
    assert area.shape == (0,)
    assert nothing.area == 0.0
    assert (nothing.distance(np.zeros((1, 3))) > 0.0).all()


# ------------------------------------------------------------- meshes, functions, voxel grids


def test_every_solid_can_be_a_part() -> None:
    grid = np.zeros((7, 7, 7))
    grid[1:-1, 1:-1, 1:-1] = 1.0
    solid = Union(
        (
            BALL,
            at(mesh_of(trimesh.creation.box((0.04, 0.04, 0.04))), 0.1, 0, 0),
            at(pc.SDF(BALL.distance, BALL.extent), 0.2, 0, 0),
            at(Voxels(values=grid, pitch=0.01), 0.3, 0, 0),
        )
    )
    points, normals, area = solid.sample_surface(0.006)
    assert np.abs(solid.distance(points)).max() < 1e-8
    assert area.sum() == pytest.approx(sum(part.area for part in solid.parts), rel=0.01)
    assert (solid.distance(points + 1e-5 * normals) > 0.0).all()
    which = np.round(points[:, 0] / 0.1)
    assert set(which) == {0.0, 1.0, 2.0, 3.0}


def test_near_distances_are_exact_when_far_ones_need_not_be() -> None:
    box = mesh_of(trimesh.creation.box((0.06, 0.04, 0.02)))
    solid = Difference(at(BALL, 0.01, 0, 0), (Union((box, CUBE)),))
    points = np.random.default_rng(0).uniform(-0.1, 0.1, (500, 3))
    exact, rough = solid.distance(points), solid.distance(points, 0.01, 0.005)
    near = (exact < 0.01) & (exact > -0.005)
    assert near.any()
    assert rough[near] == pytest.approx(exact[near], abs=1e-12)
    assert (rough[exact >= 0.01] >= 0.01).all()
    assert (rough[exact <= -0.005] <= -0.005).all()


OPEN = pc.Mesh(vertices=((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)), faces=((0, 1, 2),))


def test_an_open_mesh_is_no_part_and_one_in_a_file_is_refused_when_it_is_read(
    tmp_path: Path,
) -> None:
    for make in (
        Placed,
        lambda shape: Union((BALL, shape)),
        lambda shape: Difference(shape, BALLS),
    ):
        with pytest.raises(pc.ArgumentError, match="no volume"):
            make(OPEN)
    path = tmp_path / "open.stl"
    trimesh.Trimesh(OPEN.vertices, OPEN.faces).export(path)
    solid = Union((BALL, Placed(pc.Mesh(file=str(path)))))
    for read in (lambda: solid.area, lambda: check_closed(solid)):
        with pytest.raises(pc.ArgumentError, match="no volume"):
            read()


# ------------------------------------------------------------------------------- scene files

MUG = Difference(
    Union(
        (
            pc.Capsule(0.03, 0.05),
            Placed(CUBE, pc.Pose((0.03, 0.0, 0.0)).rotate("z", math.radians(45.0))),
        )
    ),
    (at(pc.Capsule(0.025, 0.05), 0, 0, 0.01), Intersection((BALL, at(BALL, 0.0, 0.0, 0.05)))),
)


@pytest.mark.parametrize("form", [msgspec.json, msgspec.msgpack])
def test_combinations_are_the_same_after_a_journey(form: Any) -> None:
    assert form.decode(form.encode(MUG), type=SolidShape) == MUG


def nested(depth: int) -> str:
    before, after = '{"type": "union", "parts": [', "]}"
    return before * depth + '{"type": "sphere", "radius": 0.03}' + after * depth


def test_nesting_has_a_limit() -> None:
    solid = msgspec.json.decode(nested(MAX_DEPTH), type=SolidShape)
    assert solid.distance(np.zeros((1, 3))) == pytest.approx([-0.03])
    for wrap in (Placed, lambda part: Union((part,)), lambda part: Difference(part, (BALL,))):
        with pytest.raises(pc.ArgumentError, match="deep: keep to"):
            wrap(solid)


@pytest.mark.parametrize("depth", [MAX_DEPTH + 1, 200_000])
def test_files_nested_too_deep_are_refused(depth: int) -> None:
    with pytest.raises((msgspec.ValidationError, RecursionError)):
        msgspec.json.decode(nested(depth), type=SolidShape)


def test_the_number_of_parts_has_a_limit() -> None:
    assert Union([BALL] * MAX_SOLIDS).parts == (BALL,) * MAX_SOLIDS
    for make in (
        lambda: Union([BALL] * (MAX_SOLIDS + 1)),
        lambda: Union([Union([BALL] * 60), Union([BALL] * 60)]),
        lambda: Difference(BALL, [BALL] * MAX_SOLIDS),
    ):
        with pytest.raises(pc.ArgumentError, match="solids"):
            make()


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: Union(()), "parts"),
        (lambda: Union(BALL), "parts"),
        (lambda: Union((BALL, pc.Disc(0.1))), "parts[1]"),
        (lambda: Intersection((BALL, "ball")), "parts[1]"),
        (lambda: Difference(BALL, ()), "less"),
        (lambda: Difference(None, (BALL,)), "of"),
        (lambda: Difference(BALL, (pc.Rectangle(0.1, 0.1),)), "less[0]"),
        (lambda: Placed(pc.Disc(0.1)), "shape"),
        (lambda: Placed(BALL, (0, 0, 0)), "pose"),
    ],
)
def test_what_is_no_solid_is_refused_by_its_place(make: Any, argument: str) -> None:
    with pytest.raises(pc.ArgumentError) as caught:
        make()
    assert caught.value.argument == argument


def test_a_list_of_parts_will_do_and_cannot_be_changed() -> None:
    solid = Union([BALL, CUBE])
    assert solid == Union((BALL, CUBE))
    assert hash(solid) == hash(Union((BALL, CUBE)))
    with pytest.raises(AttributeError):
        solid.parts = ()
