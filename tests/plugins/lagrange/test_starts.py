"""Where targets cannot be met, or are to be as strong as possible: several starts, and none in a loop."""

import math
from dataclasses import replace
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian_plugins.solvers.lagrange import constrained
from pacinian_plugins.solvers.lagrange.convex import maximise_scale

from ..problems import optimum, points, reachable

ARRAY = pc.lattice(0.06, 0.06)  # 49 ideal transducers


def apart(count: int, distance: float, seed: int) -> tuple[Any, Any]:
    """Points at random, most of them about `distance` [m] apart or more, and proportions."""
    rng = np.random.default_rng(seed)
    width = 2.0 * distance * math.sqrt(count)
    q = np.c_[rng.uniform(-width / 2, width / 2, (count, 2)), np.full(count, 0.1)]
    return q, rng.uniform(0.3, 1.0, count)


def missed(q: Any, t: Any, seed: int) -> float:
    """The error from phases at random: the last solution as the solver is given it, with others."""
    session = pc.Session(ARRAY, solver="lagrange")
    session.solve(q, 0.9 * t)
    assert session.last is not None
    turns = np.random.default_rng(seed).uniform(size=len(t))
    p = t * np.exp(2j * np.pi * turns)
    session.last = replace(session.last, sound_pressure=p, multipliers=None)
    return session.solve(q, t).error


@given(
    count=st.sampled_from([8, 12, 16]),
    seed=st.integers(0, 99),
    level=st.sampled_from([1.0, 1.2, 1.5]),
)
@settings(max_examples=2)
def test_beyond_reach_it_is_the_best_of_many_starts(count: int, seed: int, level: float) -> None:
    """To half a point of error, which one start misses by more in every third problem."""
    q = points(count, seed, height=0.1)
    t = reachable(q, level, seed, ARRAY)
    best = min(missed(q, t, k) for k in range(10))
    assert pc.solve(ARRAY, q, t, solver="lagrange").error <= best + 0.005


def test_what_the_first_start_solves_takes_no_other() -> None:
    q = points(8)
    t = reachable(q, 0.5)
    many, none = (
        pc.solve(pc.lattice(0.09, 0.09), q, t, solver=pc.solver("lagrange", starts=starts))
        for starts in (1000, 0)
    )
    assert many.iterations == none.iterations
    np.testing.assert_array_equal(many.gains, none.gains)


@pytest.mark.parametrize("seed", range(2))
def test_a_loop_goes_on_from_its_phases_with_no_other_start(seed: int) -> None:
    q = points(10, seed, height=0.1)
    t = reachable(q, 1.3, seed, ARRAY)
    sessions = [pc.Session(ARRAY, solver=pc.solver("lagrange", starts=n)) for n in (16, 0)]
    best, one = (session.solve(q, t) for session in sessions)
    assert best.iterations > 2 * one.iterations
    for step in range(1, 11):
        moved = q + np.array([2e-5 * step, 0.0, 0.0])
        last, best = best, sessions[0].solve(moved, t)
        turned = np.exp(1j * (best.phases - last.phases))
        turned *= np.conj(turned.sum()) / abs(turned.sum())
        assert np.abs(np.angle(turned)).max() < 0.2
        assert best.iterations < 2 * one.iterations + 50


def test_other_starts_are_extra_where_the_time_is_up() -> None:
    """The first start's answer in time is not late, whatever else was to be tried; it is never worse for it."""
    q = points(12, 1, height=0.1)
    t = reachable(q, 1.3, 1, ARRAY)
    one = pc.solve(ARRAY, q, t, solver=pc.solver("lagrange", starts=0))
    late = 0
    for due in (50.0, 100.0, 200.0, 400.0, 1e9):
        reads = iter(range(1_000_000_000))
        session = pc.Session(ARRAY, solver="lagrange", clock=lambda reads=reads: 1e-9 * next(reads))
        solution = session.solve(q, t, deadline=due * 1e-9)
        late += solution.status is pc.Status.deadline
        assert solution.late or solution.error <= one.error * (1.0 + 1e-3)
    assert late < 5


@given(
    count=st.sampled_from([2, 4, 8]),
    distance=st.sampled_from([0.003, 0.005, 0.02]),
    seed=st.integers(0, 99),
)
@settings(max_examples=6)
def test_the_strongest_keeps_proportions_and_is_stronger_than_from_other_phases(
    count: int, distance: float, seed: int
) -> None:
    """Than what is the strongest in the phases of `weighted-gs`, by CVXPY."""
    q, t = apart(count, distance, seed)
    ours = pc.solve(ARRAY, q, t, solver="lagrange", scale="max")
    theirs = pc.solve(ARRAY, q, t, solver="weighted-gs", scale="max")
    assert ours.status is pc.Status.ok
    assert math.isnan(ours.bound)
    assert math.isnan(ours.objective)
    B = pc.matrix(ARRAY, q, pc.Air())
    g, s = cp.Variable(len(ARRAY), complex=True), cp.Variable()
    c = t * np.exp(1j * theirs.phases) / np.linalg.norm(t)
    size = np.abs(B).sum(axis=1).mean()
    most = -optimum(-s, [B / size @ g == s * c, cp.abs(g) <= 1.0]) * size
    assert np.linalg.norm(ours.sound_pressure) >= 0.97 * most


@given(
    count=st.sampled_from([2, 5, 8]),
    distance=st.sampled_from([0.003, 0.005, 0.02]),
    seed=st.integers(0, 999),
)
@settings(max_examples=6)
def test_the_strongest_in_given_phases_is_cvxpy_s(count: int, distance: float, seed: int) -> None:
    q, t = apart(count, distance, seed)
    phases = np.random.default_rng(seed).uniform(0.0, 6.0, count)
    ours = pc.solve(ARRAY, q, t, phases, solver="lagrange", scale="max")
    B = pc.matrix(ARRAY, q, pc.Air())
    g, s = cp.Variable(len(ARRAY), complex=True), cp.Variable()
    size = np.abs(B).sum(axis=1).mean()
    c = t * np.exp(1j * phases) / np.linalg.norm(t)
    most = -optimum(-s, [B / size @ g == s * c, cp.abs(g) <= 1.0]) * size
    close = np.linalg.norm(ours.sound_pressure) == pytest.approx(most, rel=0.01)
    assert close or ours.status is pc.Status.approximate


def test_where_the_strongest_is_not_proven_it_is_not_called_ok(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    q, t = apart(8, 0.005, 3)

    def hasty(*given: Any, **named: Any) -> Any:
        return maximise_scale(*given, **{**named, "steps": 1})

    monkeypatch.setattr(constrained, "maximise_scale", hasty)
    solution = pc.solve(ARRAY, q, t, 0.0, solver="lagrange", scale="max")
    assert solution.status is pc.Status.approximate


@pytest.mark.parametrize("scale", ["exact", "max"])
@pytest.mark.parametrize("phases", [None, 0.0])
def test_a_step_that_would_be_late_is_not_begun(scale: str, phases: float | None) -> None:
    """A clock that stands still: only what is known of a step's length can end it."""
    array = pc.lattice(0.15, 0.15)
    q = np.random.default_rng(0).uniform(-0.03, 0.03, (160, 3)) + np.array([0.0, 0.0, 0.2])
    session = pc.Session(array, solver="lagrange", clock=lambda: 0.0)
    solution = session.solve(q, reachable(q, 1.2, 0, array), phases, scale=scale, deadline=1e-4)
    assert solution.late
    assert solution.gains.any()


LINES = np.random.default_rng(11)
CLOSE = [
    (int(LINES.integers(5, 13)), LINES.uniform(0.003, 0.005), LINES.uniform([-0.04, -0.04, 0.12], [0.04, 0.04, 0.22]))
    for _ in range(60)
]  # fmt: skip


@pytest.mark.parametrize("k", [4, 8, 32, 52])  # full drive in other phases made 0.003 to 0.5 of it
def test_the_strongest_of_close_points_is_no_weaker_than_targets_that_can_be_met(k: int) -> None:
    count, step, centre = CLOSE[k]
    q = centre + np.column_stack([(np.arange(count) - count / 2) * step, np.zeros((count, 2))])
    found = pc.solve(ARRAY, q, 200.0, scale="max")
    assert found.status is pc.Status.ok
    weakest = float(np.abs(found.sound_pressure).min())
    for factor in (1.2, 1.5, 2.0, 4.0):
        assert pc.solve(ARRAY, q, factor * weakest).error > 1e-3


@pytest.mark.parametrize(
    "limits", [{}, {"power": 10.0}, {"gain": None, "power": 10.0}, {"gain": 0.1}]
)
def test_a_point_without_sound_costs_the_strongest_no_warning(limits: dict[str, Any]) -> None:
    q = [[0.0, 0.0, 0.2], [0.01, 0.0, -0.2]]  # the second one is behind the array
    found = pc.solve(pc.autd(), q, 200.0, scale="max", limits=pc.Limits(**limits))
    assert np.isfinite(found.gains).all()
    assert found.status is pc.Status.unreachable


@pytest.mark.parametrize("phases", [None, 0.0])
def test_the_bound_holds_with_a_point_that_no_sound_reaches(phases: float | None) -> None:
    q, session = [[0.02, 0.0, 0.2], [0.0, 0.0, -0.2]], pc.Session(pc.autd())
    found = session.solve(q, [300.0, 300.0], phases)
    assert found.status is pc.Status.unreachable
    missing = 300.0**2 / 2.0
    for seen in (found, session.certify(found.gains)):
        assert missing <= seen.bound <= seen.objective
        assert seen.objective == pytest.approx(missing, rel=1e-5)
