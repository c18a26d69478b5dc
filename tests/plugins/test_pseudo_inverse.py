"""The pseudo-inverse against NumPy's least squares by singular values, on B as the solver has it."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from threadpoolctl import threadpool_limits

import pacinian as pc
from pacinian_lab.paper import experiment

ARRAY = pc.lattice(0.09, 0.09)  # 100 ideal transducers
FREE = pc.Limits(gain=None)


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    """Several BLAS threads that share their cores with others wait for each other for seconds."""
    with threadpool_limits(1):
        yield


def points(count: int, width: float = 0.3, height: float = 0.15) -> Any:
    rng = np.random.default_rng(count)
    return np.c_[rng.uniform(-width / 2, width / 2, (count, 2)), np.full(count, height)]


def solved(
    array: pc.Array, q: Any, t: Any, phases: Any, precision: Any, rcond: float | None = None
) -> tuple[Any, Any, Any, pc.Solution]:
    """B in double precision, the gains as they came, those of NumPy, the solution."""
    session = pc.Session(
        array, experiment.MEDIUM, pc.solver("pseudo-inverse", rcond=rcond), precision=precision
    )
    solution = session.solve(q, t, phases, limits=FREE)
    B = session.propagator.B
    if rcond is None:
        rcond = float(max(B.shape) * np.finfo(B.dtype).eps)
    B = B.astype(np.complex128)
    best = np.linalg.lstsq(B, solution.asked, rcond=rcond)[0]
    return B, solution.gains.astype(np.complex128), best, solution


@pytest.mark.parametrize(
    ("case", "precision"), [*((case, "double") for case in experiment.CASES), ("1a", "single")]
)
def test_the_papers_cases(case: str, precision: Any) -> None:
    near, lost = (1e-6, 1e-9) if precision == "double" else (1e-3, 1e-4)
    place, t = experiment.case(case), experiment.pattern("square").ravel()
    B, g, best, solution = solved(place.array, place.points, t, 0.0, precision)
    assert np.linalg.norm(g - best) <= near * np.linalg.norm(best)
    assert np.linalg.norm(t - B @ g) == pytest.approx(np.linalg.norm(t - B @ best), rel=lost)
    assert solution.note.startswith("Cholesky")
    if precision == "double":
        assert solution.note == f"Cholesky: rank {861 if case[0] == '1' else 451} of 861"


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("count", [80, 300, 700])
@pytest.mark.parametrize("size", [0.09, 0.19])  # 100 and 400 transducers
def test_many_points(precision: Any, count: int, size: float) -> None:
    q = points(count, width=0.6)
    rng = np.random.default_rng(0)
    t, phases = rng.uniform(0.0, 1.0, count), rng.uniform(-np.pi, np.pi, count)
    B, g, best, _ = solved(pc.lattice(size, size), q, t, phases, precision)
    p = t * np.exp(1j * phases)
    s = np.linalg.svd(B, compute_uv=False)
    length, lost = np.linalg.norm(best), np.linalg.norm(p - B @ best)
    rounding = 1e-13 if g.dtype != np.complex64 and precision == "double" else 2e-6
    assert np.linalg.norm(p - B @ g) <= lost * (1.0 + 1e-9) + rounding * s[0] * length
    condition = s[0] / s[-1]
    if precision == "double" and condition < 1e10:
        sensitivity = 1e-14 * condition * (1.0 + condition * lost / (s[0] * length))
        assert np.linalg.norm(g - best) <= max(1e-6, sensitivity) * length


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("count", [5, 60, 150])
def test_coincident_points_share_the_mean_of_their_targets(count: int, precision: Any) -> None:
    q = points(count)
    q[1] = q[0]
    t = np.r_[1.0, 3.0, np.full(count - 2, 2.0)]
    B, g, best, solution = solved(ARRAY, q, t, 0.0, precision)
    tolerance = 1e-6 if precision == "double" else 2e-2
    assert np.linalg.norm(g - best) <= tolerance * np.linalg.norm(best)
    if count <= 60:
        np.testing.assert_allclose((B @ g)[:2], 2.0, atol=10 * tolerance)
        assert f"rank {count - 1} of {count}" in solution.note


@pytest.mark.parametrize("rcond", [1e-3, 0.1])
@pytest.mark.parametrize("count", [40, 160])
def test_small_singular_values_count_as_zero(count: int, rcond: float) -> None:
    q = points(count, width=0.1)
    B, g, best, solution = solved(ARRAY, q, np.ones(count), 0.0, "double", rcond)
    assert np.linalg.norm(g - best) <= 1e-6 * np.linalg.norm(best)
    s = np.linalg.svd(B, compute_uv=False)
    assert f"rank {(s > rcond * s[0]).sum()} of {min(B.shape)}" in solution.note


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    count=st.sampled_from([1, 7, 101, 120, 300]),
    size=st.integers(-30, 30),
    single=st.booleans(),
    fixed=st.booleans(),
    apart=st.sampled_from([0.0, 1e-9, 1e-5]),
)
def test_gains_are_finite_and_in_proportion_to_targets(
    count: int, size: int, single: bool, fixed: bool, apart: float
) -> None:
    q = points(count)
    q[count // 2 :] = q[: count - count // 2] + apart
    t = np.random.default_rng(count).uniform(0.0, 1.0, count) * 10.0**size
    solution = pc.solve(
        ARRAY, q, t, 0.0 if fixed else None, solver="pseudo-inverse", limits=FREE,
        precision="single" if single else "double",
    )  # fmt: skip
    assert np.isfinite(solution.gains).all()
    assert np.isfinite(solution.sound_pressure).all()
    worst = 1.0 + (1e-3 if single else 1e-6)
    assert np.linalg.norm(solution.residual) <= worst * np.linalg.norm(t)


@pytest.mark.parametrize(("width", "count"), [(0.002, 90), (0.002, 150)])
def test_an_answer_without_time_is_near_and_says_so(width: float, count: int) -> None:
    """Points nearer than the array resolves need singular values, which the deadline does not allow."""
    q, t = points(count, width), np.full(count, 10.0)
    made = pc.solve(ARRAY, q, t, 0.0, solver="pseudo-inverse", deadline=1e-9)
    assert made.note.endswith("no time")
    assert made.error < 0.05
    assert "rank" in pc.solve(ARRAY, q, t, 0.0, solver="pseudo-inverse").note
