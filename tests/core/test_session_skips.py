"""Work that the session does not repeat, its counts, and the certificate of gains as emitted."""

import tracemalloc
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc

from ..plugins.problems import ARRAY, points, reachable


@pytest.mark.parametrize("solver", ["auto", "lagrange", "pseudo-inverse", "gs-pat"])
@given(factors=st.lists(st.sampled_from([0.0, 0.01, 0.5, 1.0, 1.2, 6.0, 1e-30]), max_size=6))
def test_a_change_of_strength_alone_is_as_good_as_a_new_solve(
    solver: str, factors: list[float]
) -> None:
    q = points(5)
    t = reachable(q, 0.15)
    session = pc.Session(ARRAY, solver=solver)
    session.solve(q, t)
    for factor in factors:
        warm = session.solve(q, factor * t)
        cold = pc.solve(ARRAY, q, factor * t, solver=solver)
        met = cold.status in (pc.Status.ok, pc.Status.silent)
        assert warm.status is cold.status or solver == "gs-pat"
        # at the limit, other initial phases may lead to another solution
        assert warm.error <= cold.error + (2e-3 if met else 0.05)
        p = pc.matrix(ARRAY, q, pc.Air()) @ warm.gains.astype(complex)
        np.testing.assert_allclose(warm.sound_pressure, p, atol=1e-4 * factor * t.max() + 1e-30)
        assert warm.bound <= warm.objective * (1 + 1e-3) or not np.isfinite(warm.bound)


def test_each_skip_is_counted() -> None:
    q = points(8)
    t = reachable(q, 0.2)
    session = pc.Session(ARRAY, solver="lagrange")
    work = session.propagator.work

    def counts() -> tuple[int, int, int, int, int]:
        return (
            work.rows_built, work.grams_built, work.solved, work.solutions_scaled,
            work.solutions_kept,
        )  # fmt: skip

    first = session.solve(q, t)
    assert counts() == (8, 1, 1, 0, 0)
    again = session.solve(q, t)
    assert counts() == (8, 1, 1, 0, 1)
    np.testing.assert_array_equal(first.gains, again.gains)
    half = session.solve(q, 0.5 * t)
    assert counts() == (8, 1, 1, 1, 1)
    np.testing.assert_allclose(half.gains, 0.5 * first.gains, rtol=1e-6)
    assert half.objective == pytest.approx(0.25 * first.objective)
    q[3] += 0.001  # one sample of eight has moved: only its row is computed
    session.solve(q, t)
    assert counts() == (9, 2, 2, 1, 1)
    session.solve(q, t, limits=pc.Limits(gain=0.5))  # another limit: solved again
    assert counts() == (9, 2, 3, 1, 1)
    session.solver = "pseudo-inverse"
    session.solve(q, t)
    assert counts()[2] == 4


def test_what_reaches_a_limit_is_not_scaled() -> None:
    q = points(4)
    t = reachable(q, 0.2)
    session = pc.Session(ARRAY, solver="lagrange")
    session.solve(q, t)
    loud = session.solve(q, 20.0 * t)
    assert session.propagator.work.solutions_scaled == 0
    assert loud.status is pc.Status.limited
    soft = session.solve(q, t)
    assert soft.status is pc.Status.ok
    assert session.propagator.work.solved == 3


def test_what_the_caller_does_with_the_gains_changes_nothing() -> None:
    q = points(4)
    t = reachable(q, 0.2)
    session, out = pc.Session(ARRAY), np.empty(100, np.complex64)
    first = session.solve(q, t, out=out).gains.copy()
    out[:] = np.nan
    np.testing.assert_array_equal(session.solve(q, t, out=out).gains, first)


def test_a_session_that_forgets_solves_anew() -> None:
    q = points(4)
    t = reachable(q, 0.5)
    session = pc.Session(ARRAY)
    first = session.solve(q, t)
    session.forget()
    assert session.last is None
    np.testing.assert_array_equal(session.solve(q, t).gains, first.gains)
    assert session.propagator.work.rows_built == 8


@pytest.mark.parametrize("phases", [None, 0.0])
@pytest.mark.parametrize("level", [0.3, 0.8, 1.4])
def test_a_certificate_is_that_of_the_gains_as_emitted(level: float, phases: float | None) -> None:
    q = points(6)
    t = reachable(q, level)
    session = pc.Session(ARRAY, solver="lagrange")
    solved = session.solve(q, t, phases)
    same = session.certify(solved.gains)
    assert same.error == pytest.approx(solved.error, abs=1e-4)
    # bound and objective are of the size of mu ||g||^2, which rounding of the residual can exceed
    near = 1e-7 * float(t @ t)
    assert same.objective == pytest.approx(solved.objective, rel=1e-2, abs=near)
    assert same.bound <= same.objective + near
    g = solved.gains
    levels = (
        np.round(np.abs(g) * 255)
        / 255
        * np.exp(2j * np.pi * np.round(np.angle(g) * 256 / 2 / np.pi) / 256)
    )
    emitted = session.certify(levels)
    p = pc.matrix(ARRAY, q, pc.Air()) @ levels
    np.testing.assert_allclose(emitted.sound_pressure, p)
    assert emitted.error >= solved.error
    assert emitted.objective > solved.objective
    assert emitted.bound <= emitted.objective
    rest = emitted.asked - p
    mu = emitted.mu
    exact = 0.5 * np.vdot(rest, rest).real + mu / 2 * np.vdot(levels, levels).real
    assert emitted.objective == pytest.approx(exact)


def test_a_certificate_needs_a_solution_and_numbers() -> None:
    session = pc.Session(ARRAY)
    with pytest.raises(pc.ArgumentError, match="solved"):
        session.certify(np.zeros(100))
    session.solve(points(2), [1.0, 1.0])
    for bad in (np.zeros(99), np.full(100, np.nan), "loud"):
        with pytest.raises(pc.ArgumentError, match="gains"):
            session.certify(bad)


@pytest.mark.parametrize("level", [0.3, 0.7])
def test_steady_state_allocates_nothing_that_grows_with_the_array(level: float) -> None:
    """With `out` and moving points, a solve allocates only a few small objects, nothing of N, N M or M^2 elements."""
    peaks = []
    for array in (pc.autd(), pc.autd(3, 3)):
        q = points(48)
        t = np.random.default_rng(0).uniform(0.3, 1.0, 48)
        t *= level * np.abs(pc.matrix(array, q, pc.Air())).sum(axis=1).mean() / np.linalg.norm(t)
        session, out = pc.Session(array, solver="lagrange"), np.empty(len(array), np.complex64)
        moves = [q + 1e-4 * k for k in range(8)]
        for move in moves:
            session.solve(move, t, out=out)
        tracemalloc.start()
        session.solve(moves[0], t, out=out)
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        for move in moves[1:]:
            session.solve(move, t, out=out)
        peaks.append(tracemalloc.get_traced_memory()[1] - before)
        tracemalloc.stop()
    assert max(peaks) < 48 * 48 * 16 / 2  # less than half a Gram matrix
    assert peaks[1] < peaks[0] + 3000


def test_where_few_points_come_or_go_a_solver_starts_from_the_sound_that_is_there() -> None:
    class Notes(pc.Solver):
        name = "notes"
        warm: Any = None

        def solve(
            self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
        ) -> pc.Result:
            Notes.warm = warm
            out[:] = np.exp(1j * np.arange(len(out)))
            return pc.Result()

    array = pc.autd()
    points = np.random.default_rng(3).uniform([-0.05, -0.05, 0.15], [0.05, 0.05, 0.2], (9, 3))
    session = pc.Session(array, solver=Notes())
    session.solve(points[:8], np.full(8, 100.0))
    for kept in (points, points[:7]):
        last = session.last
        assert last is not None
        session.solve(kept, np.full(len(kept), 100.0))
        there = pc.matrix(array, kept, pc.Air()) @ last.gains
        np.testing.assert_allclose(Notes.warm.sound_pressure, there, rtol=1e-3, atol=0.1)
    session.solve(points[:2], np.full(2, 100.0))
    assert Notes.warm is None  # a new scene does not start warm


LIMITS = (
    {"gain": 0.5},
    {"power": 3.0},
    {"zones": (pc.Zone((0.0, 0.0, 0.5), pressure=2.0),)},
    {"zones": (pc.Zone((0.0, 0.0, 0.5), pressure=3.0),)},
    {"quiet": ([[0.0, 0.0, 0.3]], 5.0)},
    {"quiet": ([[0.0, 0.0, 0.3]], 6.0)},
    {"exact": [1]},
    {"exact": [True]},
)


def test_limits_are_equal_if_their_values_are() -> None:
    for i, values in enumerate(LIMITS):
        limits = pc.Limits(**values)
        assert limits == pc.Limits(**values)
        assert hash(limits) == hash(pc.Limits(**values))
        assert limits != pc.Limits()
        assert limits != "limits"
        for other in LIMITS[:i]:
            assert limits != pc.Limits(**other)


def test_equal_limits_keep_the_last_solution() -> None:
    session = pc.Session(pc.autd())
    first = session.solve([[0.0, 0.0, 0.2]], 500.0, limits=pc.Limits(gain=0.5))
    second = session.solve([[0.0, 0.0, 0.2]], 500.0, limits=pc.Limits(gain=0.5))
    assert session.propagator.work.solutions_kept == 1
    assert np.array_equal(first.gains, second.gains)
