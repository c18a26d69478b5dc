"""Facing and occlusion on skin: against brute force, and properties that hold for any hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.propagation import KernelData
from pacinian.acoustics.skin_facing import MIN_WEIGHT, QUARTER, SkinFacing
from pacinian.scene.hands.capsules import make_capsules
from pacinian.scene.hands.hand import Hand
from pacinian.scene.hands.skin_cache import get_skin

ARRAY = pc.autd(2, 1, pc.Transducer(pressure=4.386))
seeds = st.integers(0, 10_000)


def directions(rng: np.random.Generator, count: int) -> np.ndarray:
    n = rng.normal(size=(count, 3))
    return n / np.linalg.norm(n, axis=1, keepdims=True)


def rods(rng: np.random.Generator, count: int) -> np.ndarray:
    """Capsules about the size of fingers, around the origin; some without length, some that taper."""
    a = rng.uniform(-0.06, 0.06, (count, 3))
    e = directions(rng, count) * rng.choice([0.0, 0.01, 0.04, 0.2], (count, 1))
    radii = rng.uniform(0.0, 0.02, (count, 2))
    return np.c_[a, a + e, np.where(rng.uniform(size=(count, 1)) < 0.5, radii, radii[:, :1])]


def on_skin(rng: np.random.Generator, hand: np.ndarray, count: int) -> tuple[np.ndarray, ...]:
    """Return points on capsules with their normals; some lie inside other capsules."""
    q, n = np.empty((count, 3)), directions(rng, count)
    for k, rod in enumerate(hand[rng.integers(len(hand), size=count)]):
        a, e, (first, last) = rod[:3], rod[3:6] - rod[:3], rod[6:]
        length = np.linalg.norm(e)
        if length <= abs(first - last):
            along = float(last > first)
        else:
            u, lean = e / length, (first - last) / length
            along = float(n[k] @ u > lean)  # only the part of the sphere that belongs to the hull
            if rng.uniform() < 0.7:  # on the mantle, where the normal has the same slope everywhere
                across = n[k] - n[k] @ u * u
                n[k] = lean * u + np.sqrt(1.0 - lean * lean) * across / np.linalg.norm(across)
                along = rng.uniform()
        q[k] = a + along * e + (first + along * (last - first)) * n[k]
    return q, n


def depth(q: np.ndarray, r: np.ndarray, rod: np.ndarray) -> float:
    """Return how deep the line from q to r goes into a capsule, as a union of spheres [m]."""
    s = np.linspace(0.0, 1.0, 20_001)
    middles = rod[:3] + s[:, None] * (rod[3:6] - rod[:3])
    way = r - q
    t = np.clip((middles - q) @ way / max(way @ way, 1e-30), 0.0, 1.0)
    away = np.linalg.norm(q + t[:, None] * way - middles, axis=1)
    return float((rod[6] + s * (rod[7] - rod[6]) - away).max())


def passing(q: np.ndarray, r: np.ndarray, hand: np.ndarray, edge: float) -> float:
    """Return the share of sound that passes the hand from r to q, by steps along each capsule's axis."""
    share = 1.0
    for rod in hand:
        deep = depth(q, r, rod) - max(0.0, depth(q, q, rod))
        x = np.clip(1.0 - deep / edge, 0.0, 1.0)
        share *= x * x * (3.0 - 2.0 * x)
    return share


@given(seeds)
@settings(max_examples=30)
def test_weights_are_those_of_a_walk_along_each_capsule(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hand, q = rods(rng, 3), rng.uniform(-0.08, 0.08, (2, 3))
    n, r = directions(rng, 2), rng.uniform(-0.3, 0.3, (4, 3))
    edge = rng.uniform(0.001, 0.01)
    w = SkinFacing(n, hand, edge).weights(q, r)
    exact = np.empty((2, 4))
    for m, k in np.ndindex(2, 4):
        cosine = (r[k] - q[m]) @ n[m] / np.linalg.norm(r[k] - q[m])
        exact[m, k] = max(0.0, cosine) * passing(q[m], r[k], hand, edge)
    size = np.linalg.norm(exact, axis=1)
    for m in np.flatnonzero(
        np.abs(size - MIN_WEIGHT) > 2e-4
    ):  # closer to the limit, the steps are too coarse
        np.testing.assert_allclose(w[m], exact[m] if size[m] > MIN_WEIGHT else 0.0, atol=1e-4)


@given(seeds)
def test_a_convex_body_hides_nothing_from_its_own_outward_side(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hand = rods(rng, 1)
    q, n = on_skin(rng, hand, 8)
    r = rng.uniform(-0.4, 0.4, (50, 3))
    bare = SkinFacing(n).weights(q, r)
    np.testing.assert_allclose(SkinFacing(n, hand).weights(q, r), bare, atol=1e-9)
    inside = q - hand[0, 6:].min() * rng.uniform(0.0, 0.9, (8, 1)) * n
    bare = SkinFacing(n).weights(inside, r)
    np.testing.assert_allclose(SkinFacing(n, hand).weights(inside, r), bare, atol=1e-9)


def test_what_is_behind_a_hand_or_beyond_the_transducers_does_not_count_or_matter() -> None:
    wall = [[-1.0, 0.0, 0.1, 1.0, 0.0, 0.1, 0.01, 0.01]]
    q, up, down = np.zeros((1, 3)), [[0.0, 0.0, 1.0]], [[0.0, 0.0, -1.0]]
    r = np.array([[0.0, 0.0, 0.2], [0.0, 0.0, 0.05], [0.0, 0.2, 0.2], [0.0, 0.0, -0.2]])
    np.testing.assert_allclose(SkinFacing(up, wall).weights(q, r), [[0, 1, np.sqrt(0.5), 0]])
    np.testing.assert_allclose(SkinFacing(down, wall).weights(q, r), [[0, 0, 0, 1]])
    np.testing.assert_allclose(SkinFacing([[0.0, 0.0, 0.0]], wall).weights(q, r), [[0, 1, 1, 1]])
    np.testing.assert_allclose(SkinFacing(up, wall).compute_arrival(q, r), [[0, 1, 1, 0]])


@given(seeds)
def test_weights_do_not_jump_as_a_capsule_moves(seed: int) -> None:
    """The smoothstep's slope is at most 1.5 / edge, and surface and line each move by at most the step."""
    rng = np.random.default_rng(seed)
    hand = rods(rng, 1)
    q, n = on_skin(rng, hand, 6)
    q += rng.normal(0.0, 0.003, q.shape)
    r = rng.uniform(-0.4, 0.4, (50, 3))
    step = rng.normal(0.0, 1e-4, 3)
    moved = hand + np.r_[step, step, 0.0, 0.0]
    change = np.abs(SkinFacing(n, hand).weights(q, r) - SkinFacing(n, moved).weights(q, r))
    assert change.max() <= 3.0 * np.linalg.norm(step) / QUARTER + 1e-9


@given(seeds)
@settings(max_examples=30)
def test_only_samples_said_to_have_moved_have_other_weights(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hand = rods(rng, 4)
    q, n = on_skin(rng, hand, 12)
    other, turned = hand.copy(), n.copy()
    other[rng.integers(4)] += 0.01 * rng.normal(size=8) ** 2
    turned[rng.integers(12)] *= -1.0
    before = SkinFacing(n, hand)
    for after in (
        SkinFacing(n, other), SkinFacing(turned, hand), SkinFacing(n, hand[:3]), SkinFacing(n),
        SkinFacing(n, hand, 0.01), SkinFacing(n, hand),
    ):  # fmt: skip
        r = ARRAY.positions[::9] + np.array([0.0, 0.0, 0.2])
        same = (before.weights(q, r) == after.weights(q, r)).all(axis=1)
        assert (same | after.find_changed(before, q)).all()
    assert not SkinFacing(n, hand).find_changed(before, q).any()


def in_single(array: pc.Array, facing: SkinFacing, q: np.ndarray) -> np.ndarray:
    """Return B as weighted by the kernel."""
    wave, out = KernelData.prepare(array, pc.Air()), np.empty((len(q), len(array)), np.complex64)
    wave.matrix(q, out)
    facing.weigh(q, wave, np.arange(len(q)), out)
    return out


def agree(array: pc.Array, facing: SkinFacing, q: np.ndarray) -> None:
    """Check that the kernel's B equals the reference within 1e-4 of its largest element."""
    B = pc.matrix(array, q, pc.Air())
    exact = facing.weights(q, array.positions) * B
    assert np.abs(in_single(array, facing, q) - exact).max() <= 1e-4 * np.abs(B).max()


@given(seeds, st.integers(0, 40))
@settings(max_examples=60)
def test_the_kernel_is_the_reference(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    hand = rods(rng, count)
    q, n = on_skin(rng, hand if count else rods(rng, 2), 6)
    n[rng.uniform(size=6) < 0.2] = 0.0
    axis = str(rng.choice(["x", "y", "z"]))
    pose = pc.Pose(rng.uniform(-0.3, 0.3, 3)).rotate(axis, math.radians(rng.uniform(-180, 180)))
    array = ARRAY.transform(pose)
    if np.linalg.norm(q[:, None] - array.positions, axis=2).min() > 0.03:
        agree(array, SkinFacing(n, hand), q)


@pytest.mark.parametrize(("turn", "away"), [(0.0, 0.0), (70.0, 1000.0), (180.0, 0.0)])
def test_the_kernel_is_the_reference_on_a_hand(turn: float, away: float) -> None:
    shift = pc.Pose((away, -2.0 * away, 0.0))
    array = pc.autd(2, 2) + pc.autd().transform(pc.Pose((0.0, 0.0, 0.4)).rotate("x", math.pi))
    hand = Hand.open(pose=pc.Pose((0.02, 0.0, 0.2)).rotate("y", math.radians(turn))).transform(
        shift
    )
    skin = get_skin(hand).place(hand)
    q, n = skin.points[:80], skin.normals[:80]
    facing = SkinFacing(n, make_capsules(hand))
    agree(array.transform(shift), facing, q)
    r = array.transform(shift).positions
    assert 0.5 < facing.weights(q, r).sum() / SkinFacing(n).weights(q, r).sum() < 0.999


def test_moving_and_turning_everything_changes_nothing() -> None:
    pose = pc.Pose((0.3, -0.2, 0.1)).rotate("x", math.radians(37.0))
    hand = Hand.open(pose=pc.Pose((0.0, 0.0, 0.2)))
    skin = get_skin(hand).place(hand)
    q, n = skin.points[:60], skin.normals[:60]
    w = SkinFacing(n, make_capsules(hand)).weights(q, ARRAY.positions)
    moved = SkinFacing(pose.directions(n), make_capsules(hand.transform(pose)))
    there = moved.weights(pose.points(q), pose.points(ARRAY.positions))
    np.testing.assert_allclose(there, w, atol=1e-9)


def test_a_sample_that_faces_nothing_has_a_row_of_zeros() -> None:
    array = pc.Array([[0.0, 0.0, 0.0]])
    n = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, -5e-4], [1.0, 0.0, -2e-3]])
    facing, q = SkinFacing(n), np.array([[0.0, 0.0, 0.2]] * 4)
    for B in (in_single(array, facing, q), facing.weights(q, array.positions)):
        np.testing.assert_array_equal(B[:, 0] != 0.0, [True, False, False, True])


def test_only_the_rows_named_are_weighed() -> None:
    rng = np.random.default_rng(0)
    q, n = rng.uniform((-0.05, -0.05, 0.15), (0.05, 0.05, 0.25), (4, 3)), directions(rng, 4)
    wave, facing = KernelData.prepare(ARRAY, pc.Air()), SkinFacing(n, rods(rng, 5) + 0.1)
    for dtype in (np.complex64, np.complex128):
        out = np.ones((4, len(ARRAY)), dtype)
        facing.weigh(q[[2, 0]], wave, np.array([2, 0]), out)
        w = facing.weights(q, ARRAY.positions)
        w[[1, 3]] = 1.0
        np.testing.assert_allclose(out, w, atol=1e-4)


@pytest.mark.parametrize(
    ("argument", "call"),
    [
        ("normals", {"normals": [[0.0, 0.0, 2.0]]}),
        ("normals", {"normals": [[0.0, 0.0, 1e-3]]}),
        ("normals", {"normals": [[0.0, np.nan, 1.0]]}),
        ("normals", {"normals": [0.0, 0.0, 1.0]}),
        ("capsules", {"capsules": [[0.0] * 7]}),
        ("capsules", {"capsules": [[0.0] * 7 + [-0.01]]}),
        ("capsules", {"capsules": [[0.0] * 6 + [20.0, 0.0]]}),
        ("capsules", {"capsules": [[0.0, 0.0, 0.0, 30.0, 0.0, 0.0, 8.0, 8.0]]}),
        ("capsules", {"capsules": [[np.inf] * 8]}),
        ("edge", {"edge": 0.0}),
        ("edge", {"edge": np.nan}),
    ],
)
def test_a_bad_argument_is_named(argument: str, call: dict[str, object]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
        SkinFacing(**({"normals": [[0.0, 0.0, 1.0]]} | call))  # type: ignore[arg-type]


def test_what_the_caller_does_later_changes_nothing() -> None:
    n, c = np.array([[0.0, 0.0, 1.0]]), np.ones((1, 8)) * 0.01
    facing = SkinFacing(n, c)
    n[:], c[:] = 9.0, 9.0
    np.testing.assert_array_equal(facing.normals, [[0.0, 0.0, 1.0]])
    assert facing.capsules.max() == 0.01
    with pytest.raises(ValueError, match="read-only"):
        facing.normals[:] = 0.0
    assert len(facing) == 1
    assert len(SkinFacing(np.empty((0, 3)))) == 0
