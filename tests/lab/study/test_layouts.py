"""Layouts: counts, spacing, symmetry, and what bends them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

import pacinian as pc
from pacinian_lab.study import arrangements, layouts
from pacinian_lab.study.layouts import Autd, Device, Hexagonal, Lattice, Rings, Scattered, Sunflower

lengths = st.floats(0.02, 0.3)


def made(layout: layouts.Layout, seed: int = 0) -> pc.Array:
    return layout.make(pc.T4010A1, np.random.default_rng(seed))


def test_lattice_and_autd_are_those_of_the_core() -> None:
    np.testing.assert_allclose(
        made(Lattice(width=0.2, height=0.4)).positions, pc.lattice(0.2, 0.4).positions
    )
    np.testing.assert_allclose(made(Autd(columns=2)).positions, pc.autd(2).positions)
    assert len(made(Lattice(width=0.1))) == 121  # as high as it is wide


@given(width=lengths, height=lengths, pitch=st.floats(0.005, 0.03))
def test_a_hexagonal_one_is_symmetric_within_its_box_at_its_pitch(
    width: float, height: float, pitch: float
) -> None:
    xy = arrangements.hexagonal(width, height, pitch)
    assert (np.abs(xy) <= np.array([width, height]) / 2.0 + 1e-9).all()
    for mirrored in (xy * (-1.0, 1.0), xy * (1.0, -1.0)):
        assert np.allclose(np.unique(mirrored.round(9), axis=0), np.unique(xy.round(9), axis=0))
    if len(xy) > 1:
        assert pdist(xy).min() >= pitch * (1.0 - 1e-9)


def test_all_but_the_outer_ones_of_a_hexagonal_one_have_six_neighbours() -> None:
    xy = arrangements.hexagonal(0.2, 0.2, 0.01)
    inner = xy[np.abs(xy).max(axis=1) < 0.085]
    distances = np.linalg.norm(inner[:, None] - xy, axis=2)
    assert (np.isclose(distances, 0.01, rtol=1e-9).sum(axis=1) == 6).all()


def test_a_sunflower_of_one_is_the_origin() -> None:
    assert np.array_equal(arrangements.sunflower(1, 0.1), [[0.0, 0.0]])


@given(count=st.integers(1, 400), diameter=lengths)
def test_a_sunflower_has_as_many_inside_any_circle_as_its_area_has_room(
    count: int, diameter: float
) -> None:
    r = np.hypot(*arrangements.sunflower(count, diameter).T)
    assert len(r) == count
    assert r.max() < diameter / 2.0
    inside = (r < diameter / 4.0).sum()
    assert abs(inside - count / 4.0) <= 1.0


@given(diameter=lengths, pitch=st.floats(0.005, 0.03))
def test_rings_keep_their_pitch(diameter: float, pitch: float) -> None:
    xy = arrangements.rings(diameter, pitch)
    assert np.hypot(*xy.T).max() <= diameter / 2.0 + 1e-9
    if len(xy) > 1:
        assert pdist(xy).min() >= pitch * (1.0 - 1e-9)


def test_random_ones_keep_apart_and_follow_from_their_generator() -> None:
    layout = Scattered(width=0.1, height=0.05, count=40, apart=0.008)
    a, b, c = made(layout).positions, made(layout).positions, made(layout, 1).positions
    assert np.array_equal(a, b)
    assert not np.array_equal(a, c)
    assert pdist(a).min() >= 0.008
    assert (np.abs(a) <= (0.05, 0.025, 0.0)).all()


def test_darts_land_where_thrown_one_by_one_they_would() -> None:
    half, rng, slow = 0.05, np.random.default_rng(3), np.empty((0, 2))
    while len(slow) < 60:
        dart = rng.uniform([-half, -half], [half, half])
        if not len(slow) or np.sqrt(((slow - dart) ** 2).sum(axis=1)).min() >= 0.009:
            slow = np.concatenate([slow, dart[None]])
    found = arrangements.scatter_points(0.1, 0.1, 60, 0.009, np.random.default_rng(3))
    np.testing.assert_array_equal(found, slow)


def test_what_does_not_fit_says_so() -> None:
    with pytest.raises(pc.ArgumentError, match="leaves room for"):
        made(Scattered(width=0.02, count=30, apart=0.01))


@given(radius=st.floats(0.1, 2.0))
def test_a_bowl_lies_on_its_sphere_points_to_its_centre_and_keeps_ways_from_the_middle(
    radius: float,
) -> None:
    flat = made(Lattice(width=0.1))
    bowl = made(Lattice(width=0.1, bowl=radius))
    centre = np.array([0.0, 0.0, radius])
    d = centre - bowl.positions
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), radius)
    np.testing.assert_allclose(bowl.normals, d / radius, atol=1e-12)
    along = radius * np.arccos(np.clip(1.0 - bowl.positions[:, 2] / radius, -1.0, 1.0))
    np.testing.assert_allclose(along, np.linalg.norm(flat.positions, axis=1), atol=1e-6)


def test_a_fold_is_that_of_the_core_and_comes_after_the_plan() -> None:
    folded = made(Lattice(width=0.2, height=0.4, fold=math.pi / 4.0))
    np.testing.assert_allclose(
        folded.positions, pc.lattice(0.2, 0.4).fold("x", math.radians(45.0)).positions
    )


def test_a_facing_one_is_doubled_and_looks_back() -> None:
    array = made(Lattice(width=0.1, facing=0.4))
    below, above = array.positions[:121], array.positions[121:]
    np.testing.assert_allclose(above[:, 2], 0.4)
    np.testing.assert_allclose(array.normals[121:], np.tile([0.0, 0.0, -1.0], (121, 1)), atol=1e-12)
    assert np.allclose(
        np.unique(above[:, :2].round(9), axis=0), np.unique(below[:, :2].round(9), axis=0)
    )


def test_a_pose_moves_it_all() -> None:
    pose = pc.Pose((0.1, 0.2, 0.3)).rotate("y", math.pi / 2.0)
    array = made(Lattice(width=0.1, bowl=0.3, pose=pose))
    plain = made(Lattice(width=0.1, bowl=0.3)).transform(pose)
    np.testing.assert_allclose(array.positions, plain.positions)


def test_a_device_keeps_its_own_kind_and_responses() -> None:
    described = pc.DeviceDescription(boards=(pc.Board(gain=0.5, dead=(0,)),))
    array = made(Device(device=described))
    assert len(array) == 248
    np.testing.assert_allclose(np.abs(array.responses), 0.5)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Lattice(width=0.0), "width"),
        (lambda: Lattice(width=(0.1, float("nan"))), r"width\[1\]"),
        (lambda: Lattice(width=()), "swept over nothing"),
        (lambda: Lattice(width=(0.1, 0.1)), "twice"),
        (lambda: Lattice(width=0.1, pitch=11.0), "metres"),
        (lambda: Lattice(width=0.1, hinge="z"), '"x" or "y"'),
        (lambda: Lattice(width=0.1, fold=1.6), "fold"),
        (lambda: Sunflower(count=0, diameter=0.1), "count"),
        (lambda: Rings(diameter=-1.0), "diameter"),
        (lambda: Hexagonal(width=0.1, bowl=-0.1), "bowl"),
        (Device, "file"),
        (lambda: made(Lattice(width=0.4, bowl=0.1)), "smaller than the array"),
        (lambda: made(Lattice(width=2.0, pitch=0.005)), "transducers: more than"),
        (lambda: made(Lattice(width=(0.1, 0.2))), "sweep"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(make: object, says: str) -> None:
    with pytest.raises(pc.ArgumentError, match=says):
        make()  # type: ignore[operator]
