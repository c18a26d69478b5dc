"""`lagrange` through the public API, under quiet zones, exact samples, power, and several together."""

from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import pacinian as pc

from ..problems import ARRAY, optimum, points, reachable


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
    q, ears = points(5, seed), points(4, seed + 1, height=0.2)
    t = reachable(q, level, seed)
    most = strict * t.mean()
    limits = pc.Limits(quiet=(ears, most))
    solution = pc.solve(ARRAY, q, t, phases, limits=limits, scale=scale)
    p = pc.matrix(ARRAY, ears, pc.Air()) @ solution.gains
    assert np.abs(p).max() <= most + 1e-3 * t.mean()
    assert np.abs(solution.gains).max() <= 1.0
    assert not solution.violations


def test_quiet_points_that_are_quiet_anyway_cost_nothing() -> None:
    q = points(4)
    t = reachable(q, 0.4)
    free = pc.solve(ARRAY, q, t)
    kept = pc.solve(ARRAY, q, t, limits=pc.Limits(quiet=(points(3, 7, height=0.2), 1e3)))
    np.testing.assert_array_equal(free.gains, kept.gains)


@pytest.mark.parametrize("phases", [None, 0.0])
def test_exact_samples_are_exact_where_others_are_not(phases: float | None) -> None:
    q = points(6)
    t = reachable(q, 1.2)
    t[:2] *= 0.5
    solution = pc.solve(ARRAY, q, t, phases, limits=pc.Limits(exact=[0, 1]))
    assert solution.status is pc.Status.limited
    p = pc.matrix(ARRAY, q, pc.Air()) @ solution.gains
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
    p = pc.matrix(ARRAY, q, pc.Air()) @ solution.gains
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
    q, ears = points(count), points(5, 9, height=0.22)
    t = reachable(q, 0.8)
    t[3] *= 0.3
    limits = pc.Limits(gain=0.8, power=30.0, quiet=(ears, 0.1 * t.mean()), exact=[3])
    solution = pc.solve(ARRAY, q, t, limits=limits)
    assert np.abs(solution.gains).max() <= 0.8
    assert np.linalg.norm(solution.gains) ** 2 <= 30.0 * (1 + 1e-5)
    assert np.abs(pc.matrix(ARRAY, ears, pc.Air()) @ solution.gains).max() <= 0.101 * t.mean()
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
        ears = points(2, 5, height=0.2) + np.array([0.01 * step, 0.0, 0.0])
        solution = session.solve(q, t, limits=pc.Limits(quiet=(ears, 0.05 * t.mean())))
        assert np.abs(pc.matrix(ARRAY, ears, pc.Air()) @ solution.gains).max() <= 0.051 * t.mean()
    assert session.propagator.work.rows_built == 4
    assert session.solve(q, t).gains.any()  # and without them again


def test_as_strong_as_possible_with_given_phases_meets_its_bound() -> None:
    """Against CVXPY: the largest s with B g = s t."""
    q = points(5)
    t = np.array([1.0, 2.0, 3.0, 1.0, 2.0])
    solution = pc.solve(ARRAY, q, t, 0.0, solver="lagrange", scale="max", precision="double")
    g, s = cp.Variable(100, complex=True), cp.Variable()
    most = -optimum(-s, [pc.matrix(ARRAY, q, pc.Air()) @ g == s * t, cp.abs(g) <= 1.0])
    made = np.abs(solution.sound_pressure) / t
    np.testing.assert_allclose(made, made.mean(), rtol=1e-3)
    assert made.mean() == pytest.approx(most, rel=1e-3)


def scaled(
    count: int, seed: int, level: float, fixed: bool, limited: str, more: dict[str, Any],
    strength: float, drive: float,
) -> pc.Solution:  # fmt: skip
    """A problem solved for transducers `strength` times as strong, and a limit `drive` times as high."""
    transducer = pc.Transducer(pressure=strength)
    q = points(count, seed)
    t = reachable(q, level, seed, pc.lattice(0.04, 0.04)) * strength * drive
    limits: dict[str, Any] = {"gain": drive}
    if "power" in limited:
        limits["power"] = 6.0 * drive**2
    if "quiet" in limited:
        limits["quiet"] = (points(2, seed + 1, height=0.2), 0.05 * t.mean())
    if "exact" in limited:
        limits["exact"] = [0]
    array = pc.lattice(0.04, 0.04, transducer=transducer)  # 25
    phases = 0.0 if fixed else None
    return pc.solve(array, q, t, phases, solver="lagrange", limits=pc.Limits(**limits), **more)


@settings(max_examples=20)
@given(
    count=st.integers(1, 30),
    seed=st.integers(0, 500),
    level=st.sampled_from([0.3, 0.9, 1.5]),
    fixed=st.booleans(),
    limited=st.sampled_from(["", "power", "quiet", "exact, quiet, power"]),
    most=st.booleans(),
    precision=st.sampled_from(["single", "double"]),
    strength=st.integers(-18, 18),
    drive=st.integers(-6, 6),
)
@example(4, 0, 1.5, False, "", False, "single", -18, 0)  # the nearest pressures
@example(30, 0, 0.9, False, "", False, "single", 0, -3)  # more samples than transducers
@example(6, 0, 0.3, True, "power", False, "single", -18, 5)  # by power alone
@example(6, 0, 0.9, False, "", True, "single", -18, 0)  # as strong as possible
def test_the_unit_of_sound_pressure_and_that_of_gain_do_not_matter(
    count: int, seed: int, level: float, fixed: bool, limited: str, most: bool, precision: str,
    strength: int, drive: int,
) -> None:  # fmt: skip
    """All in other units, by powers of two, in which nothing is rounded differently."""
    if most:  # where points are quiet, the strongest is not found the same to the last bit
        limited = "power" if "power" in limited else ""
    more = {"scale": "max" if most else "exact", "precision": precision}
    one = scaled(count, seed, level, fixed, limited, more, 1.0, 1.0)
    unit = 2.0**drive
    other = scaled(count, seed, level, fixed, limited, more, 2.0**strength, unit)
    assert other.status is one.status
    np.testing.assert_allclose(other.gains / unit, one.gains, atol=1e-6)
    square = (2.0**strength * unit) ** 2
    assert other.objective / square == pytest.approx(one.objective, rel=1e-5, nan_ok=True)
    assert other.bound / square == pytest.approx(
        one.bound, rel=1e-5, abs=1e-6 * one.targets.norm**2, nan_ok=True
    )


@pytest.mark.parametrize("rounds", [1, 20])
@pytest.mark.parametrize(
    ("count", "limited"), [(6, "power"), (6, "quiet"), (6, "exact"), (60, ""), (60, "exact")]
)
def test_objective_and_bound_are_those_of_the_phases_found(
    rounds: int, count: int, limited: str
) -> None:
    """The objective from the gains alone, and the bound against CVXPY; free phases move in rounds."""
    array = pc.lattice(0.06, 0.06)  # 49
    q = points(count, 1)
    t = reachable(q, 1.2 if count < 10 else 0.4, 1, array)
    t[0] *= 0.3
    top: dict[str, Any] = {
        "power": {"power": 4.0},
        "quiet": {"quiet": (points(3, 9, height=0.2), 0.02 * t.mean())},
        "exact": {"exact": [0]},
    }.get(limited, {})
    solver = pc.solver("lagrange", rounds=rounds)
    solution = pc.solve(array, q, t, solver=solver, limits=pc.Limits(gain=0.5, **top))
    B, p, mu = pc.matrix(array, q, pc.Air()), solution.asked, solution.mu
    near = np.arange(count) >= (1 if limited == "exact" else 0)
    cost = 0.5 * np.linalg.norm((p - B @ solution.gains)[near]) ** 2
    cost += mu / 2 * np.linalg.norm(solution.gains) ** 2
    size = float(np.linalg.norm(t))
    assert solution.objective == pytest.approx(cost, rel=1e-5, abs=2e-7 * size**2)
    g = cp.Variable(49, complex=True)
    kept: list[Any] = [cp.abs(g) <= 0.5]
    if limited == "power":
        kept.append(cp.norm(g) <= 2.0)
    if limited == "quiet":
        kept.append(cp.abs(pc.matrix(array, top["quiet"][0], pc.Air()) @ g) <= top["quiet"][1])
    if limited == "exact":
        kept.append(B[:1] @ g == p[:1])
    # divided by what makes CVXPY's numbers near 1
    rest = cp.sum_squares((B[near] @ g - p[near]) / size) / 2 + mu / size**2 / 2 * cp.sum_squares(g)
    best = size**2 * optimum(rest, kept)
    assert solution.bound <= best * (1 + 1e-5)
    assert best <= solution.objective * (1 + 1e-5)


@given(count=st.integers(1, 8), seed=st.integers(0, 99), level=st.sampled_from([0.2, 0.4, 0.5]))
@settings(max_examples=40)
def test_double_precision_is_the_optimum_to_many_digits(
    count: int, seed: int, level: float
) -> None:
    """By the conditions of the optimum, in NumPy: g = h(B^H y), and what is missing is y."""
    q = points(count, seed, width=0.2)
    t = reachable(q, level, seed)
    solver = pc.solver("lagrange", mu=1e-4)
    solution = pc.solve(ARRAY, q, t, 0.0, solver=solver, precision="double")
    assert solution.multipliers is not None
    x = pc.matrix(ARRAY, q, pc.Air()).conj().T @ solution.multipliers
    np.testing.assert_allclose(solution.gains, x / np.maximum(np.abs(x), solution.mu), atol=1e-10)
    rest = solution.residual - solution.multipliers
    assert np.linalg.norm(rest) <= 1e-10 * np.linalg.norm(t)
    assert solution.gap <= 1e-9 * solution.objective


@given(
    count=st.integers(1, 8),
    seed=st.integers(0, 500),
    power=st.sampled_from([1.0, 30.0, 60.0, 1e3]),
)
@settings(max_examples=20)
@example(4, 11, 1e3)
@example(2, 2, 1e3)
@example(3, 46, 1e3)  # more than full drive needs
def test_a_power_limit_leaves_it_no_weaker_than_scaling_down_would(
    count: int, seed: int, power: float
) -> None:
    q = points(count, seed, width=0.2)
    t = np.random.default_rng(seed).uniform(0.3, 1.0, count)
    plain = pc.solve(ARRAY, q, t, solver="lagrange", scale="max")
    limits = pc.Limits(power=power)
    kept = pc.solve(ARRAY, q, t, solver="lagrange", scale="max", limits=limits)
    spent = float(np.linalg.norm(plain.gains)) ** 2
    shorter = min(1.0, (power / spent) ** 0.5)
    made = np.linalg.norm(kept.sound_pressure)
    assert made >= (1 - 1e-4) * shorter * np.linalg.norm(plain.sound_pressure)
    assert np.linalg.norm(kept.gains) ** 2 <= power * (1 + 1e-5)


@pytest.mark.parametrize("deadline", [None, 0.0])
@pytest.mark.parametrize(
    ("count", "seed", "width"), [(4, 0, 0.12), (10, 0, 0.06), (20, 1, 0.12), (30, 2, 0.12)]
)
def test_as_strong_as_possible_with_free_phases_keeps_proportions(
    count: int, seed: int, width: float, deadline: float | None
) -> None:
    """Where full drive does not, also late; in time it is the strongest for its phases, by CVXPY."""
    q = points(count, seed, width=width)
    t = np.random.default_rng(seed).uniform(0.3, 1.0, count)
    solution = pc.solve(ARRAY, q, t, solver="lagrange", scale="max", deadline=deadline)
    assert solution.shape_error < 1e-3
    if deadline is not None:
        return
    g, s = cp.Variable(100, complex=True), cp.Variable()
    asked = t * np.exp(1j * solution.phases)
    most = -optimum(-s, [pc.matrix(ARRAY, q, pc.Air()) @ g == s * asked, cp.abs(g) <= 1.0])
    assert np.linalg.norm(solution.sound_pressure) >= 0.99 * most * np.linalg.norm(t)
