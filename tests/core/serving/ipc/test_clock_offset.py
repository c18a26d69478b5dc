from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.serving.ipc.clock_offset import (
    MAX_CLOCK_STEP_BACK,
    MAX_DRIFT,
    WINDOW,
    ClockOffsetEstimator,
)
from pacinian.serving.ipc.rate_limit import TokenBucket
from pacinian.wire.protocol import MAX_TIME_TO_LIVE

bounded = settings(max_examples=100)
seconds = st.floats(-1e6, 1e6)
ways = st.lists(st.tuples(st.floats(0.0, 0.2), st.floats(0.0, 0.1)), min_size=1, max_size=200)


def sent(gaps: list[tuple[float, float]], start: float) -> list[tuple[float, float, float]]:
    """Draw messages: times sent [s], times received in the same order [s], and delays [s]."""
    t, last, messages = start, start, []
    for gap, way in gaps:
        t += gap
        last = max(last, t + way)
        messages.append((t, last, last - t))
    return messages


@bounded
@given(ways, seconds)
def test_an_age_is_the_way_beyond_the_shortest_whatever_the_clocks_show(
    gaps: list[tuple[float, float]], offset: float
) -> None:
    clock = ClockOffsetEstimator()
    shortest = 10.0
    begin = 0.0
    for t, received, way in sent(gaps, 0.0):
        shortest = min(shortest, way)
        begin = begin or received
        age = clock.compute_age(t + offset, received)
        assert age >= 0.0
        assert age <= way + 1e-9
        if received < begin + WINDOW:
            assert age == pytest.approx(way - shortest, abs=1e-8)


@bounded
@given(st.floats(-500e-6, 500e-6))
def test_a_clock_that_drifts_is_followed_within_the_window(drift: float) -> None:
    clock = ClockOffsetEstimator()
    ages = [clock.compute_age(0.01 * i * (1.0 + drift), 0.01 * i) for i in range(10_000)]
    assert max(ages) <= 2.0 * WINDOW * abs(drift) + 1e-9


def test_a_clock_set_forward_is_believed_at_once() -> None:
    clock = ClockOffsetEstimator()
    clock.compute_age(0.0, 100.0)
    assert clock.compute_age(1000.01, 100.01) == 0.0
    assert clock.compute_age(1000.02, 100.03) == pytest.approx(0.01)


def test_a_clock_set_back_begins_anew() -> None:
    clock = ClockOffsetEstimator()
    clock.compute_age(1000.0, 100.0)
    assert clock.compute_age(3.0, 100.01) == 0.0
    assert clock.compute_age(3.01, 100.03) == pytest.approx(0.01)


def test_a_clock_set_back_a_little_is_late_until_the_window_has_passed() -> None:
    clock = ClockOffsetEstimator()
    back = 0.9 * MAX_CLOCK_STEP_BACK
    clock.compute_age(10.0, 10.0)
    assert clock.compute_age(11.0 - back, 11.0) == pytest.approx(back)
    times = [12.0 + 0.1 * i for i in range(150)]
    ages = [clock.compute_age(t - back, t) for t in times]
    assert ages[-1] == pytest.approx(0.0, abs=1e-9)
    assert all(a < 1e-9 for t, a in zip(times, ages, strict=True) if t > 10.0 + 2.0 * WINDOW)


@pytest.mark.parametrize("pause", [2.0, 6.0, 8.0, 9.5, 30.0, 500.0])
def test_what_has_waited_in_a_pause_is_as_old_as_it_is(pause: float) -> None:
    """Such a message must not define the offset, or renewals of a stopped game would keep its output armed."""
    clock = ClockOffsetEstimator()
    for i in range(200):
        clock.compute_age(7.0 + 0.05 * i, 0.05 * i)
    end = 10.0 + pause
    for sent in (10.0, 10.1):
        age = end - sent
        assert (
            age - 2.0 * MAX_DRIFT * (age + WINDOW)
            <= clock.compute_age(7.0 + sent, end)
            <= age + 1e-9
        )
    assert clock.compute_age(7.0 + end, end) <= 1e-9


@pytest.mark.parametrize("drift", [-MAX_DRIFT, MAX_DRIFT])
def test_a_clock_that_drifted_in_a_pause_makes_nothing_old(drift: float) -> None:
    clock = ClockOffsetEstimator()
    clock.compute_age(0.0, 0.0)
    assert clock.compute_age((1.0 + drift) * 600.0, 600.0) <= 1e-9


@bounded
@given(
    st.lists(st.floats(0.0, 0.5), min_size=1, max_size=300),
    st.floats(1.0, 100.0),
)
def test_an_allowance_is_never_exceeded_and_never_withheld(gaps: list[float], rate: float) -> None:
    allowance, now, taken = TokenBucket(rate), 0.0, []
    for gap in gaps:
        now += gap
        if allowance.take(now):
            taken.append(now)
        else:  # a second later, one is allowed again
            assert len(taken) >= int(rate)
    for i, begin in enumerate(taken):
        for j in range(i, len(taken)):
            assert j - i + 1 <= rate + rate * (taken[j] - begin) + 1e-6


def test_an_allowance_comes_back_with_time_and_not_when_time_goes_back() -> None:
    allowance = TokenBucket(2.0)
    assert [allowance.take(1.0) for _ in range(3)] == [True, True, False]
    assert not allowance.take(0.0)
    assert not allowance.take(1.25)
    assert allowance.take(1.501)


def test_what_is_old_is_never_young() -> None:
    clock = ClockOffsetEstimator()
    for i in range(100):
        assert clock.compute_age(0.1 * i, 0.1 * i) == pytest.approx(0.0)
    assert clock.compute_age(0.0, 11.5) == pytest.approx(11.5)  # 10 s old, and 1.5 s in transit
    assert clock.compute_age(11.5, 11.6) == pytest.approx(0.1)
    assert MAX_CLOCK_STEP_BACK >= MAX_TIME_TO_LIVE
