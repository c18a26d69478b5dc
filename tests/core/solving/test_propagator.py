"""The propagator's caches give the same results as a new propagator, and count their savings."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.solving.factor import Factor
from pacinian.solving.propagator import gram_matrix

ARRAY = pc.lattice(0.05, 0.05)


def cold(points: np.ndarray) -> pc.Propagator:
    propagator = pc.Propagator(ARRAY, pc.Air())
    propagator.set_points(points)
    return propagator


@given(st.lists(st.lists(st.integers(0, 4), max_size=5), max_size=6), st.integers(0, 99))
def test_moves_leave_what_a_cold_start_gives(moves: list[list[int]], seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.05, 0.15, (5, 3))
    warm = cold(points)
    assert warm.gram is not None
    for moved in moves:
        points = points.copy()
        points[moved] = rng.uniform(0.05, 0.15, (len(moved), 3))
        warm.set_points(points)
        fresh = cold(points)
        np.testing.assert_array_equal(warm.B, fresh.B)
        np.testing.assert_allclose(warm.gram, fresh.gram, rtol=2e-6, atol=1e-6 * fresh.power)
        np.testing.assert_array_equal(warm.gram, warm.gram.conj().T)


def test_only_rows_whose_point_moved_are_rebuilt() -> None:
    points = np.random.default_rng(0).uniform(0.05, 0.15, (8, 3))
    propagator = cold(points)
    first = propagator.factor(1.0)
    assert (propagator.work.rows_built, propagator.work.rows_kept) == (8, 0)
    assert propagator.set_points(points.copy()) == 0
    assert propagator.factor(1.0) is first
    points = points.copy()
    points[3] += 0.001
    assert propagator.set_points(points) == 1
    assert (propagator.work.rows_built, propagator.work.rows_kept) == (9, 15)
    assert propagator.factor(1.0) is not first
    np.testing.assert_allclose(
        propagator.factor(1.0).solve(propagator.gram @ np.ones(8) + 1), np.ones(8)
    )
    assert propagator.work.factors_built == 2
    assert propagator.work.factors_kept == 2


def test_after_a_point_on_a_transducer_nothing_stale_is_left() -> None:
    points = np.random.default_rng(0).uniform(0.05, 0.15, (3, 3))
    propagator = cold(points)
    bad = points.copy()
    bad[1] = ARRAY.positions[7]
    with pytest.raises(pc.PointOnTransducer) as caught:
        propagator.set_points(bad)
    assert caught.value.indices in ((0,), (1,))
    assert propagator.set_points(points) == 3
    np.testing.assert_array_equal(propagator.B, cold(points).B)


@pytest.mark.parametrize("M", [1, 2, 3, 8, 17, 64])
@pytest.mark.parametrize("N", [1, 511, 512, 513, 1300])
def test_the_gram_kernel_equals_the_product(M: int, N: int) -> None:
    rng = np.random.default_rng(M * N)
    B = (rng.normal(size=(M, N)) + 1j * rng.normal(size=(M, N))).astype(np.complex64)
    wide = B.astype(np.complex128)
    exact = wide @ wide.conj().T
    for made in (gram_matrix(B), gram_matrix(wide)):
        np.testing.assert_allclose(made, exact, atol=1e-6 * np.abs(exact).max())
        np.testing.assert_array_equal(made, made.conj().T)


def test_a_factor_solves_and_knows_its_condition() -> None:
    rng = np.random.default_rng(0)
    A = rng.normal(size=(6, 6)) + 1j * rng.normal(size=(6, 6))
    G = A @ A.conj().T
    y = rng.normal(size=6) + 1j * rng.normal(size=6)
    factor = Factor.of(G, 0.1)
    np.testing.assert_allclose((G + 0.1 * np.eye(6)) @ factor.solve(y), y, atol=1e-10)
    exact = 1 / np.linalg.cond(G + 0.1 * np.eye(6), 1)
    assert exact / 3 < factor.reciprocal_condition < exact * 3
    assert Factor.of(-G, 0.0).reciprocal_condition == 0.0
