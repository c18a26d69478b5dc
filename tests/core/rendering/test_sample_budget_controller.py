from __future__ import annotations

import itertools
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.rendering.sample_budget_controller import (
    FAR_TOO_LONG,
    GROW_LOAD,
    MAX_WAIT_TICKS,
    MIN_BUDGET,
    MIN_LONG_TICKS,
    MIN_WAIT_TICKS,
    SHRINK_LOAD,
    SampleBudgetController,
)

bounded = settings(max_examples=60)
PERIOD = 1e-3  # [s]
SLOW, VERY, WELL, SHORT = (
    share * PERIOD for share in (1.1 * SHRINK_LOAD, 1.1 * FAR_TOO_LONG, 0.7, 0.5 * GROW_LOAD)
)
odd = st.sampled_from([-1.0, float("nan"), float("inf")])  # as from a clock that jumps
ticks = st.lists(
    st.tuples(st.floats(0.0, 0.02) | odd, st.integers(0, 400)), min_size=1, max_size=300
)


def told(
    controller: SampleBudgetController, seconds: float, count: int, samples: int | None = None
) -> list[int]:
    """Return what is allowed after each of `count` such ticks. By default, all allowed samples are used."""
    return [
        controller.adapt(seconds, controller.allowed if samples is None else samples)
        for _ in range(count)
    ]


@bounded
@given(st.integers(1, 300), ticks)
def test_what_is_allowed_is_never_more_than_the_budget_nor_less_than_the_floor(
    most: int, seen: Any
) -> None:
    controller, other = SampleBudgetController(PERIOD, most), SampleBudgetController(PERIOD, most)
    for seconds, samples in seen:
        before = controller.allowed
        allowed = controller.adapt(seconds, samples)
        assert min(MIN_BUDGET, most) <= allowed <= most
        assert (
            allowed == controller.allowed == other.adapt(seconds, samples)
        )  # depends on nothing else
        if seconds > GROW_LOAD * PERIOD:
            assert allowed <= before


def test_a_few_long_ticks_change_nothing() -> None:
    controller = SampleBudgetController(PERIOD, 256)
    for _ in range(20):
        told(controller, SLOW, MIN_LONG_TICKS - 1)
        assert told(controller, WELL, 1) == [256]
        assert told(controller, 5.0 * VERY, 1) == [256]
        assert told(controller, WELL, 1) == [256]


def test_long_ticks_in_a_row_leave_fewer_samples() -> None:
    allowed = told(SampleBudgetController(PERIOD, 256), SLOW, MIN_LONG_TICKS)
    assert allowed[:-1] == [256] * (MIN_LONG_TICKS - 1)
    assert allowed[-1] < 0.95 * 256


def test_ticks_that_take_several_periods_count_at_once() -> None:
    allowed = told(SampleBudgetController(PERIOD, 256), VERY, 2)
    assert allowed[0] == 256
    assert allowed[1] < 0.6 * 256


def test_the_longer_the_ticks_the_fewer_the_samples() -> None:
    left = [
        told(SampleBudgetController(PERIOD, 256), k * PERIOD, MIN_LONG_TICKS)[-1]
        for k in (0.9, 1.2, 2.0)
    ]
    assert left == sorted(left, reverse=True)
    assert len(set(left)) == 3


@pytest.mark.parametrize("seconds", [SLOW, VERY, 1.0])
def test_however_long_it_takes_some_samples_are_left(seconds: float) -> None:
    assert told(SampleBudgetController(PERIOD, 256), seconds, 500)[-1] == MIN_BUDGET


def test_where_it_is_not_the_samples_that_take_the_time_they_stay() -> None:
    controller = SampleBudgetController(PERIOD, 256)
    assert set(told(controller, VERY, 100, samples=MIN_BUDGET)) == {256}
    assert set(told(controller, SLOW, 100, samples=0)) == {256}


def test_in_time_it_stays_as_it_is_and_with_time_to_spare_it_grows_back() -> None:
    controller = SampleBudgetController(PERIOD, 256)
    small = told(controller, VERY, 10)[-1]
    assert set(told(controller, WELL, 2000)) == {small}
    grown = told(controller, SHORT, 3000)
    assert grown == sorted(grown)
    assert grown[-1] == 256
    assert max(b - a for a, b in itertools.pairwise(grown)) <= 1 + 256 // 8


def test_it_grows_slower_after_each_relapse() -> None:
    controller = SampleBudgetController(PERIOD, 256)
    waits = []
    for _ in range(8):
        while controller.allowed > MIN_BUDGET:
            told(controller, VERY, 1)
        small, wait = controller.allowed, 0
        while controller.allowed == small:
            told(controller, SHORT, 1)
            wait += 1
        waits.append(wait)
    assert waits == [min(MIN_WAIT_TICKS << k, MAX_WAIT_TICKS) for k in range(8)]


def test_after_a_while_without_relapse_it_is_as_if_there_had_been_none() -> None:
    controller = SampleBudgetController(PERIOD, 40)
    for _ in range(5):
        told(controller, VERY, 4)
        told(controller, SHORT, MAX_WAIT_TICKS)
        assert controller.allowed > MIN_BUDGET
    told(controller, SHORT, 40 * MAX_WAIT_TICKS)
    assert controller.allowed == 40
    told(controller, VERY, 4)
    small = controller.allowed
    assert told(controller, SHORT, 2 * MIN_WAIT_TICKS)[-1] > small


def test_one_long_spell_is_no_relapse_however_long() -> None:
    controller = SampleBudgetController(PERIOD, 256)
    told(controller, VERY, 1000)
    assert told(controller, SHORT, MIN_WAIT_TICKS) == [MIN_BUDGET] * (MIN_WAIT_TICKS - 1) + [
        MIN_BUDGET + 1 + MIN_BUDGET // 8
    ]


def test_one_tick_without_time_to_spare_begins_the_wait_anew() -> None:
    controller = SampleBudgetController(PERIOD, 256)
    small = told(controller, VERY, 10)[-1]
    for _ in range(50):
        told(controller, SHORT, MIN_WAIT_TICKS - 1)
        told(controller, WELL, 1)
    assert controller.allowed == small
