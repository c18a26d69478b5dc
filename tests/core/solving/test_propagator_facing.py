"""The propagator on skin: its caches give the same results as a new one, and rebuild only what has changed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.skin_facing import SkinFacing

ARRAY = pc.lattice(0.05, 0.05) + pc.lattice(0.05, 0.05).transform(
    pc.Pose((0.0, 0.0, 0.2)).rotate("x", math.pi)
)
M = 5
HAND = np.array(
    [
        [-0.05, 0.02, 0.1, 0.05, 0.02, 0.1, 0.01, 0.012],
        [-0.05, 0.04, 0.1, 0.05, 0.04, 0.1, 0.01, 0.01],
        [0.0, 0.0, 0.05, 0.0, 0.0, 0.05, 0.006, 0.006],
    ]
)


def cold(points: np.ndarray, facing: SkinFacing | None) -> pc.Propagator:
    propagator = pc.Propagator(ARRAY, pc.Air())
    propagator.set_points(points, facing)
    return propagator


def scattered(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw points between the two halves of the array, and normals."""
    n = rng.normal(size=(count, 3))
    q = rng.uniform((-0.05, -0.05, 0.07), (0.05, 0.05, 0.13), (count, 3))
    return q, n / np.linalg.norm(n, axis=1, keepdims=True)


CHANGES = ["points", "normals", "capsule", "capsules", "off", "nothing", "edge"]


@given(st.lists(st.sampled_from(CHANGES), max_size=8), st.integers(0, 999))
@settings(max_examples=60)
def test_whatever_changes_the_rows_are_those_of_a_cold_start(changes: list[str], seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, n = scattered(rng, M)
    hand, edge = HAND.copy(), 0.002
    warm = cold(q, SkinFacing(n, hand))
    assert warm.gram is not None
    for change in changes:
        which = rng.integers(M, size=2)
        q, n, hand = q.copy(), n.copy(), hand.copy()
        if change == "points":
            q[which] += 0.002
        elif change == "normals":
            n[which] *= -1.0
        elif change == "capsule":
            hand[:1, :6] += 0.003
        elif change == "capsules":
            hand = HAND[: rng.integers(4)]
        elif change == "edge":
            edge *= 1.1
        facing = None if change == "off" else SkinFacing(n, hand, edge)
        warm.set_points(q, facing)
        fresh = cold(q, facing)
        np.testing.assert_array_equal(warm.B, fresh.B)
        np.testing.assert_allclose(warm.gram, fresh.gram, rtol=2e-6, atol=2e-6 * fresh.power)


def test_only_rows_for_which_other_sound_counts_are_rebuilt() -> None:
    q, n = scattered(np.random.default_rng(0), 8)
    n[:] = [0.0, 0.0, 1.0]
    q[:, 2] = 0.1
    hand = [[0.0, 0.0, z, 0.05, 0.0, z, 0.01, 0.01] for z in (0.05, 0.15)]
    propagator, facing = cold(q, SkinFacing(n, hand)), SkinFacing(n, hand)
    work = propagator.work
    assert propagator.facing is not None
    assert propagator.set_points(q, facing) == 0  # the same values in other arrays
    assert propagator.facing is facing
    n[3] = [0.0, 1.0, 0.0]
    assert propagator.set_points(q, SkinFacing(n, hand)) == 1
    hand[0][6] = 0.02  # below all tangent planes except one
    version = propagator.version
    assert propagator.set_points(q, SkinFacing(n, hand)) == 1
    assert propagator.version == version + 1
    hand[1][6] = 0.02  # above all tangent planes
    assert propagator.set_points(q, SkinFacing(n, hand)) == 8
    q[5] += 0.001
    assert propagator.set_points(q, SkinFacing(n, hand)) == 1
    assert (work.rows_built, work.rows_kept) == (19, 29)
    assert propagator.set_points(q) == 8  # without facing, all sound counts
    assert propagator.set_points(q, SkinFacing(n, hand)) == 8


@pytest.mark.parametrize("precision", ["single", "double"])
def test_all_that_follows_from_b_is_weighted(precision: pc.acoustics.propagation.Precision) -> None:
    rng = np.random.default_rng(0)
    q, n = scattered(rng, M)
    facing = SkinFacing(n, HAND)
    propagator = pc.Propagator(ARRAY, pc.Air(), precision)
    propagator.set_points(q, facing)
    B = pc.matrix(ARRAY, q, pc.Air()) * facing.weights(q, ARRAY.positions)
    off = 1e-4 if precision == "single" else 1e-12
    size = np.abs(B).max()
    assert np.abs(propagator.B - B).max() < off * size
    assert np.abs(propagator.gram - B @ B.conj().T).max() < off * size**2 * len(ARRAY)
    g = rng.normal(size=len(ARRAY)) + 1j * rng.normal(size=len(ARRAY))
    np.testing.assert_allclose(propagator.apply(g), B @ g, atol=off * size * len(ARRAY))
    y = rng.normal(size=M) + 1j * rng.normal(size=M)
    np.testing.assert_allclose(propagator.adjoint(y), B.conj().T @ y, atol=off * size * M)
    q[2] += 0.001
    assert propagator.set_points(q, facing) == 1
    B = pc.matrix(ARRAY, q, pc.Air()) * facing.weights(q, ARRAY.positions)
    assert np.abs(propagator.B - B).max() < off * size


def test_as_many_normals_as_points_are_needed() -> None:
    q, n = scattered(np.random.default_rng(0), M)
    facing = SkinFacing(n)
    propagator = cold(q, facing)
    for wrong in (q[:3], np.tile(q, (2, 1))):
        with pytest.raises(pc.ArgumentError, match="facing"):
            propagator.set_points(wrong, facing)
    assert propagator.set_points(q, facing) == 0
    q[0] = ARRAY.positions[0]
    with pytest.raises(pc.PointOnTransducer):
        propagator.set_points(q, facing)
    q[0] += 0.05
    assert propagator.set_points(q, facing) == M
    np.testing.assert_array_equal(propagator.B, cold(q, facing).B)
