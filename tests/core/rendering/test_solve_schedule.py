from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.gallery import SCENES
from pacinian.rendering.tick_alternation import (
    LONG_SHARE,
    MAX_FITTING,
    MIN_FITTING,
    MIN_LONG_TICKS,
    SHORT,
    TICKS_SEEN,
    TickAlternation,
)
from pacinian.testing import ManualClock

PERIOD = 1e-3  # [s]
bounded = settings(max_examples=60)
ticks = st.lists(st.tuples(st.floats(0.0, 0.01), st.booleans()), max_size=400)


def taking() -> TickAlternation:
    turns = TickAlternation(PERIOD)
    for _ in range(MIN_LONG_TICKS):
        turns.tick(1.1 * LONG_SHARE * PERIOD, True)
    assert turns.taking
    return turns


def pairs(turns: TickAlternation, seconds: float, count: int) -> int:
    """Such ticks by turns until both are done in one again; how many pairs that took."""
    for k in range(count):
        for _ in range(2):
            turns.tick(seconds, turns.solves)
        if not turns.taking:
            return k + 1
    return count + 1


def test_turns_are_taken_where_many_ticks_are_long_and_not_for_a_few() -> None:
    turns = TickAlternation(PERIOD)
    for k in range(10 * TICKS_SEEN):
        assert not turns.tick(
            (1.1 if k % TICKS_SEEN < MIN_LONG_TICKS - 1 else 0.5) * LONG_SHARE * PERIOD, True
        )
    for _ in range(TICKS_SEEN):
        turns.tick(0.5 * LONG_SHARE * PERIOD, True)
    began = [turns.tick(1.1 * LONG_SHARE * PERIOD, True) for _ in range(MIN_LONG_TICKS)]
    assert began == [False] * (MIN_LONG_TICKS - 1) + [True]


def test_ticks_that_solve_nothing_do_not_count() -> None:
    turns = TickAlternation(PERIOD)
    for _ in range(1000):
        turns.tick(10.0 * PERIOD, False)
    assert not turns.taking


@bounded
@given(ticks)
def test_every_tick_does_one_or_both_and_both_come_in_turn(seen: Any) -> None:
    turns, other = TickAlternation(PERIOD), TickAlternation(PERIOD)
    before = None
    for tick in seen:
        assert turns.samples or turns.solves
        assert turns.taking != (turns.samples and turns.solves)
        if before is not None and turns.taking and before[2]:
            assert (turns.samples, turns.solves) == (before[1], before[0])
        before = turns.samples, turns.solves, turns.taking
        assert turns.tick(*tick) == other.tick(*tick)  # by what it is told alone
    assert turns == other


def test_with_time_for_both_it_goes_back_later_after_each_relapse() -> None:
    turns = taking()
    waits = []
    for _ in range(6):
        waits.append(pairs(turns, 0.4 * SHORT * PERIOD, 2 * MAX_FITTING))
        for _ in range(MIN_LONG_TICKS):
            turns.tick(1.1 * LONG_SHARE * PERIOD, True)
    assert waits == [min(MIN_FITTING << k, MAX_FITTING) for k in range(6)]
    assert pairs(taking(), 0.6 * SHORT * PERIOD, 5000) > 5000  # each fits, but not both


class Busy(ManualClock):
    """Each look at it takes time: ticks that solve are long."""

    def now(self) -> float:
        self.time += 2e-4
        return self.time


def test_a_renderer_that_would_be_late_samples_and_solves_by_turns_and_sends_every_tick() -> None:
    clock = Busy()
    renderer = pc.Renderer(pc.autd(), SCENES["mesh"], clock=clock)
    with renderer:
        for k in range(200):
            renderer.tick(1.0 + k * PERIOD)
        report = renderer.report
        assert not report.faults
        assert renderer.turns.taking
        assert report.frames_sent == report.ticks == 200
        turns = report.skipped["solve, in turn with sampling"]
        assert 0.3 * 200 < turns < 0.5 * 200
        assert report.solves <= 200 - turns


def test_a_focus_that_runs_is_not_held_up_by_turns() -> None:
    renderer = pc.Renderer(pc.autd(), SCENES["stm-circle"], clock=ManualClock())
    with renderer:
        for k in range(50):
            renderer.turns.taking, renderer.turns.samples = True, k % 2 == 0
            renderer.turns.solves = not renderer.turns.samples
            renderer.tick(k * PERIOD)
        gains = renderer.player.solved[0].samples.positions
        technique = SCENES["stm-circle"](0.0).objects[0].technique
        assert technique.step(49 * PERIOD) is not None
        circle = np.hypot(*gains[0, :2])
        assert abs(circle - 0.015) < 1e-6
