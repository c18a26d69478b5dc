from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.rendering.background_schedule import (
    END_SPREAD,
    FAR_TOO_LONG,
    LEAST_MAX_TICKS,
    LONG_SHARE,
    MAX_FITTING,
    MAX_SOLVE_INTERVAL,
    MAX_SOLVE_TIME,
    MAX_SPREAD_TIME,
    MIN_FITTING,
    MIN_LONG_TICKS,
    MIN_SOLVE_INTERVAL,
    REST_INTERVAL,
    SHORT_SHARE,
    SOLVES_SEEN,
    TICKS_SEEN,
    BackgroundSchedule,
)

PERIOD = 1e-3  # [s]
# ticks from one solve to the next
LEAST, MOST = round(MIN_SOLVE_INTERVAL / PERIOD), round(MAX_SOLVE_INTERVAL / PERIOD)
LONGEST_SPREAD = round(MAX_SPREAD_TIME / PERIOD)
bounded = settings(max_examples=60)


def beside() -> BackgroundSchedule:
    """Return a schedule whose solves run in the background, after enough long ticks."""
    schedule = BackgroundSchedule(PERIOD)
    for _ in range(MIN_LONG_TICKS):
        schedule.note_tick(1.1 * LONG_SHARE * PERIOD)
    assert schedule.in_background
    return schedule


def count_solves(schedule: BackgroundSchedule, seconds: float, most: int) -> int:
    """Return the number of such solves until ticks solve again; more than `most` if they do not."""
    for k in range(most):
        schedule.note_solve(seconds)
        if not schedule.in_background:
            return k + 1
    return most + 1


def test_solves_leave_the_ticks_where_many_are_long_and_not_for_a_few() -> None:
    schedule = BackgroundSchedule(PERIOD)
    for k in range(10 * TICKS_SEEN):
        long = k % TICKS_SEEN < MIN_LONG_TICKS - 1
        schedule.note_tick((1.1 if long else 0.5) * LONG_SHARE * PERIOD)
    for _ in range(TICKS_SEEN):
        schedule.note_tick(0.5 * LONG_SHARE * PERIOD)
    for _ in range(MIN_LONG_TICKS):
        assert not schedule.in_background
        schedule.note_tick(1.1 * LONG_SHARE * PERIOD)
    assert schedule.in_background


def test_two_successive_ticks_that_are_far_too_long_suffice() -> None:
    schedule = BackgroundSchedule(PERIOD)
    for seconds in (1.1, 0.1, 1.1):
        schedule.note_tick(seconds * FAR_TOO_LONG * PERIOD)
        assert not schedule.in_background
    schedule.note_tick(1.1 * FAR_TOO_LONG * PERIOD)
    assert schedule.in_background


def test_solves_that_fit_go_back_into_the_ticks_later_after_each_relapse() -> None:
    schedule = beside()
    waits = []
    for _ in range(6):
        waits.append(count_solves(schedule, 0.9 * SHORT_SHARE * PERIOD, 2 * MAX_FITTING))
        for _ in range(MIN_LONG_TICKS):
            schedule.note_tick(1.1 * LONG_SHARE * PERIOD)
    assert waits == [min(MIN_FITTING << k, MAX_FITTING) for k in range(6)]
    assert count_solves(beside(), 1.1 * SHORT_SHARE * PERIOD, 5000) > 5000


def test_solves_of_fewer_samples_than_were_asked_for_do_not_fit() -> None:
    schedule = beside()
    for _ in range(2 * MAX_FITTING):
        schedule.note_solve(0.1 * SHORT_SHARE * PERIOD, whole=False)
    assert schedule.in_background


@bounded
@given(st.lists(st.floats(0.0, 0.02), min_size=1, max_size=50))
def test_a_solve_is_expected_to_take_as_many_ticks_as_the_last_ones(seconds: Any) -> None:
    """The median of the last solves counts, so that a single delay does not; it is limited to `max_ticks`."""
    schedule = beside()
    for n, each in enumerate(seconds, 1):
        schedule.note_solve(each)
        expected = math.ceil(float(np.median(seconds[max(0, n - SOLVES_SEEN) : n])) / PERIOD)
        assert schedule.expected_ticks == min(max(1, expected), schedule.max_ticks)


@bounded
@given(st.floats(1.0, 10_000.0))
def test_a_solve_may_take_the_same_time_at_every_rate_unless_ticks_are_long(rate: float) -> None:
    """Otherwise a loop of fewer ticks, which is to save work, would solve for longer."""
    longest = BackgroundSchedule(1.0 / rate).max_ticks / rate
    assert longest == pytest.approx(max(MAX_SOLVE_TIME, LEAST_MAX_TICKS / rate), abs=0.5 / rate)


def list_solves(every: int, ticks: int, taken: int = 1) -> tuple[BackgroundSchedule, list[int]]:
    """Return a schedule and the ticks in which solves began. Scenes change every `every` ticks; solves take `taken`."""
    schedule, began, changed = beside(), list[int](), False
    for k in range(ticks):
        changed = changed or k % every == 0
        schedule.pass_ticks(1)
        if (not began or k >= began[-1] + taken) and schedule.begin_solve(changed):
            began.append(k)
            changed = False
    return schedule, began


@bounded
@given(st.integers(LEAST, MOST), st.integers(1, LEAST))
def test_a_new_scene_begins_a_solve_at_once_at_the_rate_of_a_tracker(
    every: int, taken: int
) -> None:
    schedule, began = list_solves(every, 200, taken)
    assert began == list(range(0, 200, every))
    assert schedule.expected_interval == every


def test_while_nothing_moves_solves_are_rare_until_the_scene_changes() -> None:
    schedule = beside()
    assert schedule.begin_solve(changed=True)
    schedule.rests = True
    for _ in range(round(REST_INTERVAL / PERIOD) - 1):
        schedule.pass_ticks(1)
        assert not schedule.begin_solve(changed=False)
    schedule.pass_ticks(1)
    assert schedule.begin_solve(changed=False)
    assert schedule.expected_interval <= LONGEST_SPREAD, "a change is spread over no longer time"
    schedule.pass_ticks(LEAST)
    assert schedule.begin_solve(changed=True)


@bounded
@given(st.integers(1, 300), st.integers(1, 40))
def test_solves_are_never_more_frequent_than_needed_nor_rarer_than_motion_allows(
    every: int, taken: int
) -> None:
    schedule, began = list_solves(every, 1000, taken)
    gaps = np.diff(began)
    assert gaps.min() >= max(LEAST, taken)
    assert gaps.max() <= max(MOST, taken)
    assert schedule.expected_interval == min(
        math.ceil(np.median(gaps[-SOLVES_SEEN:])), LONGEST_SPREAD
    )


@pytest.mark.parametrize(("rate", "ticks"), [(20.0, 1), (100.0, 1), (250.0, 3), (4000.0, 48)])
def test_the_intervals_are_times_whatever_the_rate(rate: float, ticks: int) -> None:
    schedule = BackgroundSchedule(1.0 / rate, in_background=True)
    assert schedule.begin_solve(False)
    began = 0
    while True:
        schedule.pass_ticks(1)
        began += 1
        if schedule.begin_solve(False):
            break
    assert began == ticks
    assert schedule.find_spread(ends=True) <= max(1, round(END_SPREAD * rate))


def test_ticks_that_solve_while_solves_run_beside_them_do_not_count() -> None:
    """This happens after new limits. Later, one long tick must not suffice."""
    schedule = beside()
    for _ in range(MIN_LONG_TICKS):
        schedule.note_tick(9.0 * PERIOD)
    count_solves(schedule, 0.1 * SHORT_SHARE * PERIOD, 2 * MAX_FITTING)
    schedule.note_tick(9.0 * PERIOD)
    assert not schedule.in_background
