"""How calls are timed, on a clock that stands still unless the call lets it go on."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacinian_lab.solvers import timing


class Clock:
    def __init__(self) -> None:
        self.now = 0.0
        self.calls = 0

    def perf_counter(self) -> float:
        return self.now

    def call(self, *seconds: float) -> int:
        self.now += seconds[min(self.calls, len(seconds) - 1)]
        self.calls += 1
        return self.calls


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(timing, "time", clock)
    return clock


def test_the_first_call_is_not_timed_and_the_rest_fill_the_seconds(clock: Clock) -> None:
    result, times = timing.measure(lambda: clock.call(0.75, 0.25, 0.125), 1.0)
    assert times == (0.125, 0.25, 7)
    assert result == clock.calls == 8


def test_it_is_timed_at_least_once(clock: Clock) -> None:
    _, times = timing.measure(lambda: clock.call(0.0625), 0.0)
    assert times == (0.0625, 0.0625, 1)
    assert clock.calls == 2


def test_a_long_call_is_made_once(clock: Clock) -> None:
    _, times = timing.measure(lambda: clock.call(5.0), 0.25)
    assert times == (5.0, 5.0, 1)
    assert clock.calls == 1


def test_there_is_a_most(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timing, "MAX_CALLS", 20)
    _, times = timing.measure(lambda: clock.call(1e-6), 1.0)
    assert times.samples == 20


@given(
    values=st.lists(st.floats(0.0, 1e3), min_size=1, max_size=300),
    share=st.sampled_from([0.01, 0.5, 0.99, 1.0]),
)
def test_quantiles_are_by_nearest_rank(values: list[float], share: float) -> None:
    found = timing.quantile(sorted(values), share)
    assert found == np.quantile(values, share, method="inverted_cdf")


def test_memory_is_what_a_call_holds_at_most() -> None:
    kept = bytearray(5_000_000)
    held = timing.measure_memory(lambda: len(bytearray(1_000_000)) + len(bytearray(2_000_000)))
    assert 2_000_000 <= held < 2_200_000
    assert timing.measure_memory(lambda: None) < 100_000
    assert len(kept) < timing.resident()
