"""`lagrange` through the public API, under quiet zones, exact samples, power, and several together."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc

ARRAY = pc.lattice(0.09, 0.09)  # 100 ideal transducers


def points(count: int, seed: int = 0, z: float = 0.15) -> Any:
    rng = np.random.default_rng(seed)
    return np.c_[rng.uniform(-0.06, 0.06, (count, 2)), np.full(count, z)]


def reachable(q: Any, level: float, seed: int = 0) -> Any:
    t = np.random.default_rng(seed).uniform(0.3, 1.0, len(q))
    return t / np.linalg.norm(t) * level * np.abs(pc.matrix(ARRAY, q)).sum(axis=1).mean()


@given(
    seed=st.integers(0, 500),
    level=st.sampled_from([0.1, 0.5, 0.9, 1.3]),
    strict=st.sampled_from([0.0, 0.02, 0.3]),
    phases=st.sampled_from([None, 0.0]),
    scale=st.sampled_from(["exact", "max"]),
)
def test_quiet_points_are_quiet(
    seed: int, level: float, strict: float, phases: float | None, scale: str
) -> None:
    q, ears = points(5, seed), points(4, seed + 1, 0.2)
    t = reachable(q, level, seed)
    most = strict * t.mean()
    limits = pc.Limits(quiet=(ears, most))
    solution = pc.solve(ARRAY, q, t, phases, limits=limits, scale=scale)
    p = pc.matrix(ARRAY, ears) @ solution.gains
    assert np.abs(p).max() <= most + 1e-3 * t.mean()
    assert np.abs(solution.gains).max() <= 1.0
    assert not solution.violations


def test_a_quiet_zone_costs_no_more_than_it_must() -> None:
    """Against the same problem with the quiet points as samples of amplitude 0."""
    q, ears = points(4), points(3, 7, 0.2)
    t = reachable(q, 0.3)
    solution = pc.solve(ARRAY, q, t, limits=pc.Limits(quiet=(ears, 0.01 * t.mean())))
    assert solution.status is pc.Status.ok
    assert solution.error < 1e-3


def test_quiet_points_that_are_quiet_anyway_cost_nothing() -> None:
    q = points(4)
    t = reachable(q, 0.4)
    free = pc.solve(ARRAY, q, t)
    kept = pc.solve(ARRAY, q, t, limits=pc.Limits(quiet=(points(3, 7, 0.2), 1e3)))
    np.testing.assert_array_equal(free.gains, kept.gains)


@pytest.mark.parametrize("phases", [None, 0.0])
def test_exact_samples_are_exact_where_others_are_not(phases: float | None) -> None:
    q = points(6)
    t = reachable(q, 1.2)
    t[:2] *= 0.5
    solution = pc.solve(ARRAY, q, t, phases, limits=pc.Limits(exact=[0, 1]))
    assert solution.status is pc.Status.limited
    p = pc.matrix(ARRAY, q) @ solution.gains
    np.testing.assert_allclose(np.abs(p)[:2], t[:2], rtol=1e-3)
    assert np.abs(np.abs(p) - t)[2:].max() > 0.01 * t.max()
    if phases is not None:
        np.testing.assert_allclose(np.angle(p)[:2], 0.0, atol=1e-3)


def test_what_cannot_be_exact_is_said_with_by_how_much() -> None:
    q = points(4)
    t = reachable(q, 3.0)
    solution = pc.solve(ARRAY, q, t, 0.0, limits=pc.Limits(exact=[0, 1, 2, 3]))
    assert solution.status is pc.Status.infeasible
    assert set(solution.violations) == {"exact"}
    p = pc.matrix(ARRAY, q) @ solution.gains
    missed = np.linalg.norm(t - p) / np.linalg.norm(t)
    assert solution.violations["exact"] == pytest.approx(missed, rel=1e-3)
    near = pc.solve(ARRAY, q, t, 0.0, solver="lagrange")  # the best least squares
    assert missed <= 1.001 * near.error


def test_exact_and_quiet_that_contradict_are_infeasible() -> None:
    q = points(3)
    t = reachable(q, 0.3)
    limits = pc.Limits(exact=[0], quiet=(q[:1], 0.1 * t[0]))
    solution = pc.solve(ARRAY, q, t, limits=limits)
    assert solution.status is pc.Status.infeasible
    assert "exact" in solution.violations


def test_power_is_spent_better_than_by_scaling() -> None:
    q = points(5)
    t = reachable(q, 0.9)
    limits = pc.Limits(power=15.0)
    ours = pc.solve(ARRAY, q, t, 0.0, solver="lagrange", limits=limits)
    scaled = pc.solve(ARRAY, q, t, 0.0, solver="pseudo-inverse", limits=limits)
    for solution in (ours, scaled):
        assert np.linalg.norm(solution.gains) ** 2 <= 15.0 * (1 + 1e-5)
    assert ours.error < scaled.error
    assert ours.status is pc.Status.limited


@pytest.mark.parametrize("count", [6, 150])
def test_all_limits_together(count: int) -> None:
    q, ears = points(count), points(5, 9, 0.22)
    t = reachable(q, 0.8)
    t[3] *= 0.3
    limits = pc.Limits(gain=0.8, power=30.0, quiet=(ears, 0.1 * t.mean()), exact=[3])
    solution = pc.solve(ARRAY, q, t, limits=limits)
    assert np.abs(solution.gains).max() <= 0.8
    assert np.linalg.norm(solution.gains) ** 2 <= 30.0 * (1 + 1e-5)
    assert np.abs(pc.matrix(ARRAY, ears) @ solution.gains).max() <= 0.101 * t.mean()
    assert abs(solution.sound_pressure[3]) == pytest.approx(t[3], rel=1e-3)
    assert solution.bound <= solution.objective * (1 + 1e-6)


@pytest.mark.parametrize(
    "limit",
    [
        {"quiet": 3.0},
        {"quiet": ([[0, 0]], 1.0)},
        {"quiet": ([[0, 0, np.nan]], 1.0)},
        {"quiet": ([[0, 0, 0.1]], -1.0)},
        {"quiet": ([[0, 0, 0.1]], [1.0, 2.0])},
        {"quiet": ([[0, 0, 100.0]], 1.0)},
        {"exact": [5]},
        {"exact": [0.5]},
        {"exact": "all"},
    ],
)
def test_a_bad_limit_is_named(limit: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"limits.{next(iter(limit))}"):
        pc.solve(ARRAY, points(2), [1.0, 1.0], limits=pc.Limits(**limit))


@pytest.mark.parametrize("limit", [{"quiet": (np.empty((0, 3)), 1.0)}, {"exact": []}])
def test_an_empty_limit_is_none(limit: dict[str, Any]) -> None:
    assert pc.solve(ARRAY, points(2), [9.0, 9.0], limits=pc.Limits(**limit)).status is pc.Status.ok


def test_quiet_points_that_move_are_followed() -> None:
    session = pc.Session(ARRAY)
    q = points(4)
    t = reachable(q, 0.5)
    for step in range(3):
        ears = points(2, 5, 0.2) + np.array([0.01 * step, 0.0, 0.0])
        solution = session.solve(q, t, limits=pc.Limits(quiet=(ears, 0.05 * t.mean())))
        assert np.abs(pc.matrix(ARRAY, ears) @ solution.gains).max() <= 0.051 * t.mean()
    assert session.propagator.work.rows_built == 4
    assert session.solve(q, t).gains.any()  # and without them again


def test_as_strong_as_possible_with_given_phases_meets_its_bound() -> None:
    """Against CVXPY: the largest s with B g = s t."""
    import warnings

    import cvxpy as cp

    q = points(5)
    t = np.array([1.0, 2.0, 3.0, 1.0, 2.0])
    solution = pc.solve(ARRAY, q, t, 0.0, solver="lagrange", scale="max", precision="double")
    g, s = cp.Variable(100, complex=True), cp.Variable()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem = cp.Problem(cp.Maximize(s), [pc.matrix(ARRAY, q) @ g == s * t, cp.abs(g) <= 1.0])
        problem.solve(solver=cp.CLARABEL)
    made = np.abs(solution.sound_pressure) / t
    np.testing.assert_allclose(made, made.mean(), rtol=1e-3)
    assert made.mean() == pytest.approx(float(s.value), rel=1e-3)
