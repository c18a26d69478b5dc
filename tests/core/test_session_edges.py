"""Deadlines, changing limits, strength under several limits, and state that must not leak between solves."""

import itertools
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.skin_facing import SkinFacing

from ..plugins import problems

ARRAY = pc.autd()


def points(count: int, seed: int = 0) -> Any:
    return problems.points(count, seed, 0.1, 0.2)


def strength(solution: pc.Solution) -> float:
    return float(np.linalg.norm(solution.sound_pressure))


def test_what_ran_out_of_time_is_said_and_not_kept() -> None:
    q, session = points(4), pc.Session(ARRAY, clock=itertools.count().__next__)
    limits = pc.Limits(quiet=(q[:1] + np.array([0.03, 0.0, 0.0]), 1.0))
    t = np.full(4, 300.0)
    late = session.solve(q, t, limits=limits, deadline=0.0)
    assert late.status is pc.Status.deadline
    assert session.solve(q, t, limits=limits).status is pc.Status.ok
    assert session.propagator.work.solutions_kept == 0


@pytest.mark.parametrize("phases", [None, 0.0])
def test_the_strongest_found_in_no_time_is_marked(phases: float | None) -> None:
    solution = pc.solve(ARRAY, points(32), np.ones(32), phases, scale="max", deadline=0.0)
    assert solution.status is pc.Status.deadline


def test_one_solve_leaves_nothing_to_the_next() -> None:
    q = points(4)
    alike, t = (
        np.repeat(q[:1], 4, axis=0),
        [1.0, 2.0, 3.0, 4.0],
    )  # proportions that no gains can make
    first = pc.solve(ARRAY, alike, t, scale="max")
    gains = first.gains.copy()
    palm = SkinFacing(
        np.tile([0.0, 0.0, -1.0], (4, 1)), [[0.0, 0.0, 0.22, 0.1, 0.0, 0.22, 0.01, 0.01]]
    )
    others: list[dict[str, Any]] = [
        {"amplitudes": np.ones(4)},
        {"amplitudes": np.full(4, 1e4), "limits": pc.Limits(gain=0.3)},
        {"amplitudes": t, "points": alike, "facing": palm},
        {"amplitudes": np.ones(4), "scale": "most"},  # rejected
    ]
    for other in others:
        with suppress(pc.ArgumentError):
            pc.solve(**{"array": ARRAY, "points": q} | other)
        again = pc.solve(ARRAY, alike, t, scale="max")
        assert again.gains is not first.gains
        assert (again.status, again.note) == (first.status, first.note)
        np.testing.assert_array_equal(again.gains, gains)


@pytest.mark.parametrize("unit", [1.0, 1e3, 1e4])
def test_the_strongest_with_a_silent_sample(unit: float) -> None:
    q = points(4)
    t = np.array([0.0, 1.0, 1.0, 1.0]) * unit
    with_zero = pc.solve(ARRAY, q, t, scale="max")
    assert with_zero.status is pc.Status.ok
    assert abs(with_zero.sound_pressure[0]) < 1e-2 * strength(with_zero)
    scaled = pc.solve(ARRAY, q, t, scale="max", solver="pseudo-inverse")
    assert strength(with_zero) > 1.02 * strength(scaled)


@pytest.mark.parametrize(
    "limits", [{"power": 5.0}, {"power": 50.0}, {"power": 120.0}, {"gain": None, "power": 10.0}]
)
def test_the_strongest_under_a_power_limit_is_no_weaker_than_by_scaling(limits: Any) -> None:
    q = points(4)
    ours, scaled = (
        pc.solve(ARRAY, q, np.ones(4), scale="max", solver=name, limits=pc.Limits(**limits))
        for name in ("lagrange", "pseudo-inverse")
    )
    assert strength(ours) >= 0.999 * strength(scaled)
    assert np.linalg.norm(ours.gains) ** 2 <= limits["power"] * (1 + 1e-5)


def test_a_certificate_is_refused_after_a_solve_that_failed() -> None:
    q, session = points(4), pc.Session(ARRAY)
    gains = session.solve(q, np.full(4, 100.0)).gains
    for bad in ({"limits": pc.Limits(quiet=([[99.0, 0.0, 0.0]], 1.0))}, {}):
        moved = q + 0.01
        if not bad:
            moved[0] = ARRAY.positions[0]
        with pytest.raises(pc.ArgumentError):
            session.solve(moved, np.full(4, 100.0), **bad)
        with pytest.raises(pc.ArgumentError, match="solved"):
            session.certify(gains)


def test_a_certificate_tells_broken_limits() -> None:
    q, session = points(4), pc.Session(ARRAY)
    solution = session.solve(q, np.ones(4), scale="max", limits=pc.Limits(power=100.0))
    loud = session.certify(3.0 * solution.gains)
    assert set(loud.violations) == {"gain", "power"}
    assert loud.status is pc.Status.infeasible
    assert not session.certify(solution.gains).violations


def test_limits_are_copied_when_they_are_made() -> None:
    q, chosen = points(4), [0]
    limits = pc.Limits(exact=chosen)
    chosen[:] = [99]
    assert pc.solve(ARRAY, q, np.full(4, 50.0), limits=limits).status is pc.Status.ok
    for bad in ([[0], [1, 2]], "first", 3.5, [0.5]):
        with pytest.raises(pc.ArgumentError, match=r"limits\.exact"):
            pc.Limits(exact=bad)


def test_nothing_again_and_again_is_silence() -> None:
    session = pc.Session(ARRAY)
    for _ in range(3):
        assert session.solve(np.empty((0, 3)), []).status is pc.Status.silent


class Constant(pc.Solver):
    """A solver that is not linear: it always returns the same gains."""

    name: ClassVar[str] = "constant"

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        out[:] = 0.3
        return pc.Result()


def test_a_solver_that_is_not_linear_is_asked_again() -> None:
    q, session = points(2), pc.Session(ARRAY, solver=Constant())
    session.solve(q, [1.0, 1.0])
    assert np.abs(session.solve(q, [2.0, 2.0]).gains).max() == pytest.approx(0.3)


def test_power_is_kept_to_the_last_digit() -> None:
    class Over(Constant):
        name: ClassVar[str] = "over"

        def solve(self, *arguments: Any) -> pc.Result:
            arguments[-1][:] = np.sqrt(5.0 / 249 * (1 + 1.9e-5))
            return pc.Result()

    solution = pc.solve(ARRAY, points(2), [1.0, 1.0], solver=Over(), limits=pc.Limits(power=5.0))
    assert (np.abs(solution.gains.astype(np.complex128)) ** 2).sum() <= 5.0


def test_one_shot_solves_from_several_threads_are_those_of_one() -> None:
    problems = [(points(4 + k % 5, k), np.full(4 + k % 5, 150.0 + k)) for k in range(12)]
    expected = [pc.solve(ARRAY, q, t).gains for q, t in problems]
    wrong: list[int] = []

    def work() -> None:
        for k, (q, t) in enumerate(problems):
            if not np.array_equal(pc.solve(ARRAY, q, t).gains, expected[k]):
                wrong.append(k)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_saturation_is_the_share_at_the_limit() -> None:
    q = points(5)
    limits = pc.Limits(gain=0.5)
    for level, low, high in ((10.0, 0.0, 0.0), (800.0, 0.01, 0.99), (1e5, 0.99, 1.0)):
        solution = pc.solve(ARRAY, q, np.full(5, level), limits=limits)
        assert low <= solution.saturation <= high
    assert pc.solve(ARRAY, q, np.ones(5), limits=pc.Limits(gain=None)).saturation == 0.0


@pytest.mark.parametrize("limits", [{}, {"power": 30.0}, {"exact": [0]}])
@pytest.mark.parametrize("level", [100.0, 2000.0])
def test_the_objective_is_that_of_the_gains_as_returned(limits: Any, level: float) -> None:
    q = points(5)
    solution = pc.solve(ARRAY, q, np.full(5, level), solver="lagrange", limits=pc.Limits(**limits))
    assert solution.bound <= solution.objective * (1 + 1e-6)
    if not limits:
        g = solution.gains.astype(np.complex128)
        rest = solution.residual
        exact = (np.vdot(rest, rest).real + solution.mu * np.vdot(g, g).real) / 2
        assert solution.objective == pytest.approx(exact, rel=1e-6)


def test_a_solve_in_another_thread_meanwhile_is_refused_and_harms_nothing() -> None:
    """Both solves would write to the same memory."""
    enter, leave = threading.Event(), threading.Event()

    class Waits(pc.Solver):
        name = "waits"

        def solve(self, propagator: Any, targets: Any, *rest: Any) -> pc.Result:
            enter.set()
            assert leave.wait(60.0)
            rest[-1][:] = 0.1
            return pc.Result()

    session = pc.Session(pc.autd(), solver=Waits())
    with ThreadPoolExecutor() as pool:
        first = pool.submit(session.solve, [0.0, 0.0, 0.2], 100.0)
        assert enter.wait(60.0)
        with pytest.raises(RuntimeError, match="make a Session for each thread"):
            session.solve([0.0, 0.0, 0.2], 100.0)
        leave.set()
        assert first.result().gains[0] == np.float32(0.1)
    assert session.solve([0.0, 0.0, 0.2], 100.0).gains[0] == np.float32(0.1)


class Spoiling(pc.Solver):
    """Spoils the array that it writes its gains to, in one of several ways. It keeps it."""

    name = "spoiling"
    keeps = frozenset[str]()

    def __init__(self, how: str) -> None:
        self.how, self.kept = how, np.empty(0)

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        self.kept = out
        if self.how == "flags":
            out.setflags(write=False)
        elif self.how == "shape":
            out.shape = (1, len(out))
        elif self.how == "dtype":
            out.dtype = np.int64
        return pc.Result()


@pytest.mark.parametrize("how", ["flags", "shape", "dtype", "kept"])
def test_a_solver_that_spoils_its_array_spoils_no_other_solver(how: str) -> None:
    session, point = pc.Session(pc.autd()), [0.0, 0.0, 0.15]
    before = session.solve(point, 500.0).gains.copy()
    session.forget()
    spoiling = Spoiling(how)
    session.solver = spoiling
    with suppress(pc.PluginError):
        session.solve(point, 500.0)
    session.solver = "auto"
    with suppress(ValueError):
        spoiling.kept[...] = np.nan if how == "kept" else 1
    for factor in 1.0, 2.0, 3.0:
        made = session.solve(point, 500.0 * factor)
        assert made.status is pc.Status.ok
        with suppress(ValueError):
            spoiling.kept[...] = np.nan if how == "kept" else 1
    session.forget()
    np.testing.assert_array_equal(session.solve(point, 500.0).gains, before)


@pytest.mark.parametrize("how", ["shape", "dtype"])
def test_a_solver_that_changes_the_shape_of_its_array_is_named(how: str) -> None:
    with pytest.raises(pc.PluginError, match=r"spoiling.*shape or type"):
        pc.Session(pc.autd(), solver=Spoiling(how)).solve([0.0, 0.0, 0.15], 500.0)


@pytest.mark.parametrize(
    "solver", ["lagrange", "gs", "gs-pat", "lbfgs", "greedy", "pseudo-inverse"]
)
def test_a_solve_that_is_cancelled_ends_with_what_it_has(solver: str) -> None:
    session = pc.Session(ARRAY, solver=solver)
    session.is_cancelled = lambda: True
    q = points(24)
    made = session.solve(q, 500.0, regions=np.zeros(24, np.intp))
    assert np.isfinite(made.gains).all()
    assert np.abs(made.gains).max() <= 1.0
    whole = pc.solve(ARRAY, q, 500.0, regions=np.zeros(24, np.intp), solver=solver)
    assert made.iterations <= whole.iterations
    session.is_cancelled = lambda: False
    again = session.solve(q, 500.0, regions=np.zeros(24, np.intp))
    assert again.error <= 1.05 * whole.error + 1e-3, "it goes on from there"
