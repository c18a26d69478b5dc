"""The bound over phases, against exact arithmetic, CVXPY, and many attempts to get below it."""

from typing import Any

import cvxpy as cp
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.solving.error_lower_bound import least_error, prove_bound

from ...plugins.problems import optimum

ARRAY = pc.lattice(0.05, 0.05)  # 36 ideal transducers


def problem(count: int, level: float, seed: int, array: pc.Array = ARRAY) -> tuple[Any, Any, Any]:
    """Return points, B, and targets whose 2-norm is `level` times that of the strongest focus."""
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.05, 0.05, (count, 2)), np.full(count, 0.1)]
    B = pc.matrix(array, q, pc.Air())
    t = rng.uniform(0.3, 1.0, count)
    return q, B, t * level * np.abs(B).sum(axis=1).mean() / np.linalg.norm(t)


@given(
    count=st.integers(1, 4),
    columns=st.integers(1, 6),
    seed=st.integers(0, 9999),
    spread=st.floats(0.0, 6.0),
)
@settings(max_examples=10)
def test_what_multipliers_prove_is_true_in_exact_arithmetic(
    count: int, columns: int, seed: int, spread: float
) -> None:
    """Whatever they are: z^H K z >= bound - (sum a - sum b) for all |u_m| = 1, as a matrix of 40 digits is >= 0."""
    rng = np.random.default_rng(seed)
    B = rng.normal(size=(count, columns, 2)) @ [1, 1j]
    t = rng.uniform(0.0, 1.0, count)
    t /= np.linalg.norm(t)
    a, b = rng.normal(size=count), 10.0 ** rng.uniform(-spread, 1.0, columns)
    bound = prove_bound(B, t, a, b)
    with mpmath.workdps(40):
        exact = mpmath.matrix(count + columns)
        wide = mpmath.matrix(B.tolist())
        D = mpmath.diag(t.tolist())
        short = (mpmath.fsum(a.tolist()) - mpmath.fsum(b.tolist()) - mpmath.mpf(bound)) / count
        exact[:count, :count] = D * D - mpmath.diag(a.tolist()) + short * mpmath.eye(count)
        exact[:count, count:] = -D * wide
        exact[count:, :count] = -wide.H * D
        exact[count:, count:] = wide.H * wide + mpmath.diag(b.tolist())
        assert min(mpmath.eigh(exact, eigvals_only=True)) >= -(mpmath.mpf(10) ** -30)


@given(
    count=st.integers(1, 4), level=st.sampled_from([0.5, 1.2, 2.0, 1e3]), seed=st.integers(0, 99)
)
@settings(max_examples=6)
def test_no_gains_are_below_it(count: int, level: float, seed: int) -> None:
    """Neither the best of many starts nor random gains are below it."""
    q, B, t = problem(count, level, seed)
    bound = least_error(B, t)
    best = pc.solve(ARRAY, q, t, solver=pc.solver("lagrange", starts=40)).error
    rng = np.random.default_rng(seed)
    for _ in range(40):
        u = np.exp(2j * np.pi * rng.uniform(size=count))
        x = B.conj().T @ (t * u)
        p = B @ (x / np.abs(x)) * rng.choice([1.0, rng.uniform()])
        best = min(best, float(np.linalg.norm(t - np.abs(p)) / np.linalg.norm(t)))
    assert 0.0 <= bound <= best * (1.0 + 1e-6) + 1e-6
    assert level < 1e3 or bound >= 0.9 * best


def test_one_point_beyond_reach_misses_exactly_what_full_drive_lacks() -> None:
    _, B, t = problem(1, 1.5, 0)
    assert least_error(B, t) == pytest.approx(1.0 - np.abs(B).sum() / t[0], rel=1e-2)


def test_what_nothing_reaches_is_missed_altogether() -> None:
    assert least_error(np.zeros((2, 3), np.complex128), np.ones(2)) == 1.0


def test_it_is_the_relaxation_s_optimum() -> None:
    """The reference is CVXPY with Clarabel, on the matrix of all unknowns."""
    _, B, t = problem(3, 1.4, 2, pc.lattice(0.02, 0.02))  # 9 transducers
    size = float(np.linalg.norm(t))
    D, A = np.diag(t / size), B / size
    C = np.block([[D @ D, -D @ A], [-A.conj().T @ D, A.conj().T @ A]])
    Z = cp.Variable(C.shape, hermitian=True)
    own = cp.real(cp.diag(Z))
    cost = cp.real(cp.trace(C @ Z))
    best = optimum(cost, [Z >> 0, own[:3] == 1, own[3:] <= 1])
    assert best > 1e-3
    assert least_error(B, t) == pytest.approx(np.sqrt(best), rel=2e-2)


def test_a_session_tells_it_where_it_is_asked() -> None:
    q, B, t = problem(4, 1.5, 1)
    session = pc.Session(ARRAY, solver="lagrange")
    solved = session.solve(q, t, limits=pc.Limits(gain=0.5))
    assert np.isnan(solved.least_error)
    assert np.isnan(session.certify(solved.gains).least_error)
    told = session.certify(solved.gains, over_phases=True)
    assert told.least_error == least_error(0.5 * B, t)
    assert 0.3 * told.error < told.least_error <= told.error
    session.solve(q, t, scale="max")
    with pytest.raises(pc.ArgumentError, match="over_phases"):
        session.certify(solved.gains, over_phases=True)
    many = np.tile(q, (5, 1)) + np.arange(20)[:, None] * 1e-4
    session.solve(many, np.ones(20))
    with pytest.raises(pc.ArgumentError, match="over_phases"):
        session.certify(solved.gains, over_phases=True)
