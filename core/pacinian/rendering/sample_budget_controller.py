"""Adapt the sample budget to the available time."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

MAX_LOAD = 0.75  # duration of a tick, over the period, above which the budget shrinks
MIN_LOAD = 0.5  # duration of a tick, over the period, up to which the budget may grow
# Number of successive long ticks (above MAX_LOAD) after which the budget shrinks. A few may be due to the machine.
MAX_LONG_TICKS = 8
# Duration of a tick, over the period, above which the tick is far too late.
FAR_TOO_LATE_RATIO = 3.0
# Number of successive ticks that are far too late after which the budget shrinks.
MAX_FAR_TOO_LATE_TICKS = 2
# Number of short ticks after which the budget grows. It doubles each time that the budget must shrink again after it
# has grown.
MIN_WAIT = 50
# Largest number of short ticks after which the budget grows. After as many short ticks at full budget, the number is
# MIN_WAIT again.
MAX_WAIT = 800
MIN_BUDGET = 16  # smallest budget; fewer samples would hardly save time
AIM = 0.6  # duration of a tick to aim for when the budget shrinks, relative to the period


@dataclass
class SampleBudgetController:
    """Reduces the sample budget if ticks would be late, and raises it again when there is time.

    period: of a tick [s]. most: largest budget. allowed: present budget.
    """

    period: float
    most: int
    allowed: int = field(init=False)
    _last: deque[float] = field(default_factory=lambda: deque(maxlen=MAX_LONG_TICKS), init=False)
    _short: int = field(default=0, init=False)
    _wait: int = field(default=MIN_WAIT, init=False)
    _grown: bool = field(default=False, init=False)  # since the budget last shrank

    def __post_init__(self) -> None:
        self.allowed = self.most

    def adapt(self, seconds: float, samples: int, ticks: int = 1) -> int:
        """Take account of a tick that took `seconds` [s] for `samples` samples; return the new budget.

        ticks: number of ticks until the next solve. Assumes that the time of a solve grows with the square of the
        number of samples.
        """
        self._last.append(seconds)
        last = list(self._last)
        soon = min(last[-MAX_FAR_TOO_LATE_TICKS:])
        slow = len(last) == MAX_LONG_TICKS and min(last) > MAX_LOAD * self.period
        if samples > MIN_BUDGET and (
            slow
            or (len(last) >= MAX_FAR_TOO_LATE_TICKS and soon > FAR_TOO_LATE_RATIO * self.period)
        ):
            share = (AIM * self.period / (min(last) if slow else soon)) ** 0.5
            fewer = max(MIN_BUDGET, int(samples * min(share, 0.9)))
            self.allowed = min(self.allowed, fewer)
            self._last.clear()
            if self._grown:
                self._wait = min(2 * self._wait, MAX_WAIT)
            self._short, self._grown = 0, False
        elif seconds > MIN_LOAD * self.period:
            self._short = 0
        else:
            self._grow(ticks)
        return self.allowed

    def _grow(self, ticks: int) -> None:
        self._short += ticks
        if self.allowed < self.most and self._short >= self._wait:
            self.allowed = min(self.most, self.allowed + 1 + self.allowed // 8)
            self._short, self._grown = 0, True
        elif self.allowed == self.most and self._short >= MAX_WAIT:
            self._wait = MIN_WAIT
