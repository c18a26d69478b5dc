"""Deadlines of solves: the usual one, and a longer one while most solves run out of time."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest

from pacinian.rendering.solve_deadline import DEADLINE_SHARE, SLOW_FACTOR, SolveDeadline
from pacinian.solving.limits import Limits

if TYPE_CHECKING:
    from pacinian.rendering.solution_sequence import SolveResult

PERIOD, TICKS = 1e-3, 12
USUAL = DEADLINE_SHARE * TICKS * PERIOD  # [s]


def solved(seconds: float, *, late: bool = False) -> SolveResult:
    """A result with one new solution, for new samples."""
    fresh = SimpleNamespace(ran_out_of_time=late, solution=SimpleNamespace(seconds=seconds))
    solutions = SimpleNamespace(samples=object(), limits=Limits())
    made: Any = SimpleNamespace(fresh=(fresh,), solutions=solutions)
    return cast("SolveResult", made)


def run(
    deadline: SolveDeadline, results: list[SolveResult], *, in_background: bool = True
) -> float:
    """Return the deadline after these results."""

    def choose() -> float:
        if in_background:
            return deadline.choose_background_deadline(TICKS, unhurried=False)
        return deadline.choose_tick_deadline()

    for result in results:
        choose()
        deadline.adapt(result, solved(0.0))
    return choose()


def test_while_most_solves_run_out_of_time_the_next_ones_have_more() -> None:
    deadline = SolveDeadline(PERIOD, adaptive=True)
    assert run(deadline, [solved(USUAL, late=True)] * 4) == pytest.approx(USUAL)  # a busy moment
    assert run(deadline, [solved(USUAL, late=True)] * 16) == pytest.approx(SLOW_FACTOR * USUAL)
    # they end in time now, but would not have before
    assert run(deadline, [solved(1.5 * USUAL)] * 50) == pytest.approx(SLOW_FACTOR * USUAL)
    assert run(deadline, [solved(0.5 * USUAL)] * 50) == pytest.approx(USUAL)


def test_a_few_late_solves_change_nothing() -> None:
    deadline = SolveDeadline(PERIOD, adaptive=True)
    mixed = [solved(USUAL, late=True), solved(0.5 * USUAL), solved(0.5 * USUAL)] * 30
    assert run(deadline, mixed) == pytest.approx(USUAL)


def test_solves_in_the_ticks_keep_their_deadline() -> None:
    deadline = SolveDeadline(PERIOD, adaptive=True)
    late = [solved(USUAL, late=True)] * 50
    assert run(deadline, late, in_background=False) == pytest.approx(DEADLINE_SHARE * PERIOD)


def test_without_adaptation_there_is_none() -> None:
    assert run(SolveDeadline(PERIOD, adaptive=False), [solved(1.0)] * 50) == math.inf
