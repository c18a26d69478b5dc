"""Least squares of least norm, against NumPy's by singular values, for any shape, rank and scale."""

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pacinian.solving.budget import Budget
from pacinian.solving.column_groups import ColumnGroups
from pacinian.solving.least_squares import (
    MIN_RECIPROCAL_CONDITION,
    LeastSquares,
    Normal,
    Reduced,
    refine,
)

CUT = 1e-11
SIZES = st.integers(1, 20)
SEEDS = st.integers(0, 10_000)


def normal(rng: np.random.Generator, *shape: int) -> Any:
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


def norm(x: Any) -> float:
    return float(np.linalg.norm(x))


def matrix(M: int, N: int, seed: int, rank: int = 99, decades: float = 1.0) -> Any:
    """Return a matrix with `rank` singular values from 1 to 10^-decades."""
    rng = np.random.default_rng(seed)
    r = min(rank, M, N)
    U, V = np.linalg.qr(normal(rng, M, r))[0], np.linalg.qr(normal(rng, N, r))[0]
    return (U * np.logspace(0, -decades, r)) @ V.conj().T


def spoiled(B: Any, seed: int, equal: int, zeros: int) -> Any:
    """Return the matrix with some equal rows and columns, and some zero."""
    rng = np.random.default_rng(seed)
    for _ in range(2):
        B = B.T.copy()
        M = len(B)
        B[rng.integers(0, M, equal)] = B[rng.integers(0, M)]
        B[rng.integers(0, M, zeros)] = 0.0
    return B


def targets(M: int, seed: int) -> Any:
    return normal(np.random.default_rng(seed + 1), M)


def residual(B: Any, g: Any, p: Any) -> float:
    return norm(p - B.astype(np.complex128) @ g)


@given(
    M=SIZES,
    N=SIZES,
    rank=SIZES,
    decades=st.sampled_from([0.0, 2.0, 4.0, 7.0, 9.0]),
    equal=st.sampled_from([0, 0, 1, 5]),
    zeros=st.sampled_from([0, 0, 1, 4]),
    scale=st.integers(-30, 30),
    size=st.integers(-30, 30),
    seed=SEEDS,
)
def test_it_is_what_singular_values_give(
    M: int, N: int, rank: int, decades: float, equal: int, zeros: int, scale: int, size: int, seed: int
) -> None:  # fmt: skip
    B = spoiled(matrix(M, N, seed, rank, decades), seed, equal, zeros)
    s = np.linalg.svd(B, compute_uv=False)
    kept = s[s > CUT * s[0]]
    condition = float(s[0] / kept[-1]) if len(kept) and kept[-1] else 1.0
    B, p = B * 10.0**scale, targets(M, seed) * 10.0**size
    g, note = LeastSquares.of(B, CUT).solve(p)
    best = np.linalg.lstsq(B, p, rcond=CUT)[0]
    assert g.shape == (N,)
    assert g.dtype == np.complex128
    rounding = 1e-13 * norm(B) * norm(best)
    assert residual(B, g, p) <= residual(B, best, p) * (1.0 + 1e-9) + rounding
    assert norm(g) <= norm(best) * (1.0 + 1e-15 * condition**2 + 1e-9)
    if condition < 1e4:
        np.testing.assert_allclose(g, best, rtol=0, atol=1e-6 * norm(best))
        assert f"rank {len(kept) if s[0] else 0} of {min(M, N)}" in note


@given(M=SIZES, N=SIZES, rank=SIZES, scale=st.integers(-20, 20), seed=SEEDS)
def test_single_precision_is_that_of_its_rounding(
    M: int, N: int, rank: int, scale: int, seed: int
) -> None:
    B = (matrix(M, N, seed, rank) * 10.0**scale).astype(np.complex64)
    p = targets(M, seed)
    g, _ = LeastSquares.of(B).solve(p)
    best = np.linalg.lstsq(B.astype(np.complex128), p, rcond=1e-5)[0]
    assert g.dtype == np.complex128
    np.testing.assert_allclose(g, best, rtol=0, atol=1e-4 * norm(best))
    assert residual(B, g, p) <= residual(B, best, p) + 1e-5 * norm(p)


@given(
    shape=st.tuples(SIZES, SIZES),
    sizes=st.lists(st.sampled_from([0.0, 1e-300, 1e-30, 1e-9, 1.0, 1e9, 1e30]), min_size=1),
    asked=st.sampled_from([0.0, 1e-30, 1.0, 1e30]),
    single=st.booleans(),
    rcond=st.sampled_from([None, 0.0, 1e-10, 0.1, 1.0]),
    seed=SEEDS,
)
def test_anything_goes_without_nan(
    shape: tuple[int, int], sizes: list[float], asked: float, single: bool, rcond: Any, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    B = rng.choice(sizes, shape) * np.exp(1j * rng.integers(0, 4, shape))
    B = B.astype(np.complex64 if single else np.complex128)
    assume(not 0.0 < np.abs(B).max() < 1e-150)
    p: Any = asked * rng.choice([0.0, 1e-9, 1.0, -1j], shape[0])
    g, _ = LeastSquares.of(B, rcond).solve(p)
    assert np.isfinite(g).all()
    if not p.any():
        assert not g.any()


@pytest.mark.parametrize(("decades", "due"), [(8.0, 10.0), (12.0, 10.0), (1.0, 1.0)])
def test_no_step_starts_that_would_end_after_the_deadline(decades: float, due: float) -> None:
    """The clock advances at each call. Singular values take 16 times as long as the first factorisation."""
    squares = LeastSquares.of(matrix(40, 20, 0, decades=decades).astype(np.complex64))
    late = squares.solve_within(targets(40, 0), Budget(due, itertools.count().__next__))
    done = squares.solve_within(targets(40, 0), Budget(1e3, itertools.count().__next__))
    assert (late is None) == (decades > 1.0)
    assert done is not None
    np.testing.assert_array_equal(done[0], squares.solve(targets(40, 0))[0])


@pytest.mark.parametrize("shape", [(0, 0), (0, 3), (3, 0), (2, 3)])
def test_nothing_is_silence(shape: tuple[int, int]) -> None:
    for dtype in MIN_RECIPROCAL_CONDITION:
        g, _ = LeastSquares.of(np.zeros(shape, dtype)).solve(np.ones(shape[0], dtype))
        np.testing.assert_array_equal(g, np.zeros(shape[1]))


@pytest.mark.parametrize("shape", [(40, 20), (20, 40), (30, 30)])
@pytest.mark.parametrize("decades", [1.0, 4.5, 8.0])
def test_prepared_once_it_solves_for_many(shape: tuple[int, int], decades: float) -> None:
    B = matrix(*shape, 0, decades=decades)
    kept = LeastSquares.of(B)
    for seed in range(3):
        p = B @ targets(shape[1], seed)
        g, how = kept.solve(p)
        assert how.startswith("Cholesky" if decades < 5.0 else "singular values")
        np.testing.assert_array_equal(g, LeastSquares.of(B).solve(p)[0])
        best = np.linalg.pinv(B) @ p
        error = norm(g - best) / norm(best)
        assert error < 1e-14 * 10.0**decades


@pytest.mark.parametrize("dtype", MIN_RECIPROCAL_CONDITION)
@given(M=SIZES, N=st.integers(2, 20), seed=SEEDS, offset=st.sampled_from([0.0, 10.0]))
def test_a_singular_gram_matrix_is_not_trusted(
    dtype: Any, M: int, N: int, seed: int, offset: float
) -> None:
    B = matrix(M + N, N, seed) + offset
    B[:, 0] = B[:, 1:].mean(axis=1)
    for A in (B, B.T.copy()):
        factor = Normal.of(A.astype(dtype))
        assert factor.reciprocal_condition < MIN_RECIPROCAL_CONDITION[np.dtype(dtype)]


@pytest.mark.parametrize("shape", [(40, 20), (20, 40)])
def test_a_factor_that_will_not_do_is_found_out(shape: tuple[int, int]) -> None:
    B, p = matrix(*shape, 0), targets(shape[0], 0)
    factor = Normal.of(B)
    best = np.linalg.pinv(B) @ p
    near = refine(B, Normal(factor.upper * 1.01, 1.0), p)
    assert near is not None
    np.testing.assert_allclose(near, best, rtol=0, atol=1e-13 * norm(best))
    assert refine(B, Normal(factor.upper * 1.1, 1.0), p) is None
    assert refine(B, Normal(factor.upper * 0.1, 1.0), p) is None


@given(M=SIZES, N=SIZES, kinds=st.integers(1, 12), seed=SEEDS)
def test_equal_columns_share(M: int, N: int, kinds: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    kind = rng.integers(-1, kinds, N)
    B = np.c_[normal(rng, M, kinds), np.zeros(M)][:, kind] * (1.0 + 1e-15 * rng.random(N))
    r = len(np.unique(kind[kind >= 0]))
    shares = ColumnGroups.of(B, 1e-13)
    S = shares.spread(np.eye(r, dtype=complex)).T
    np.testing.assert_allclose(S.conj().T @ S, np.eye(r), atol=1e-14)
    np.testing.assert_allclose(B @ S @ S.conj().T, B, atol=1e-13)
    np.testing.assert_allclose(shares.merge(B), B @ S, atol=1e-13)
    np.testing.assert_allclose(shares.merge(B.T, axis=0), (B @ S).T, atol=1e-13)
    g = normal(rng, N)
    np.testing.assert_allclose(shares.gather(g), S.conj().T @ g, atol=1e-13)


def test_columns_in_a_chain_are_not_all_equal() -> None:
    B = np.ones((3, 1000)) * (1.0 + 1e-3 * np.arange(1000.0))
    shares = ColumnGroups.of(B.astype(complex), 2e-3)
    S = shares.spread(np.eye(len(shares.kept), dtype=complex)).T
    assert np.abs(B @ S @ S.T - B).max() < 2e-2


@given(
    M=SIZES,
    N=SIZES,
    rank=SIZES,
    decades=st.sampled_from([0.0, 3.0, 5.5, 9.0, 16.0]),
    equal=st.sampled_from([0, 1, 5]),
    single=st.booleans(),
    seed=SEEDS,
)
def test_reduced_the_distance_differs_by_a_constant(
    M: int, N: int, rank: int, decades: float, equal: int, single: bool, seed: int
) -> None:
    B = spoiled(matrix(M, N, seed, rank, decades), seed, equal, 0)
    B = B.astype(np.complex64) if single else B
    p, rng = targets(M, seed), np.random.default_rng(seed)
    reduced = Reduced.of(B)
    q = reduced.down(p)
    assert reduced.R.shape == (len(q), N)
    assert len(q) <= min(M, N)
    lost = norm(p) ** 2 - norm(q) ** 2
    assert lost >= -1e-12 * norm(p) ** 2
    for size in (0.0, 1.0, 1e3):
        g = size * normal(rng, N)
        whole = residual(B, g, p) ** 2
        assert norm(reduced.R @ g - q) ** 2 + lost == pytest.approx(whole, rel=1e-10)


def test_reduced_by_cholesky_where_that_is_safe() -> None:
    for decades, safe in ((3.0, True), (5.5, True), (7.0, False)):
        assert (Reduced.of(matrix(40, 20, 0, decades=decades)).upper is not None) == safe
