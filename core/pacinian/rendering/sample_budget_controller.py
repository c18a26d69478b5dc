"""Adapt the sample budget to the available time."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

SHRINK_LOAD = 0.75  # duration of a tick, over the period, above which the budget shrinks
GROW_LOAD = 0.5  # duration of a tick, over the period, up to which the budget may grow; such a tick is short
# Number of successive long ticks (above SHRINK_LOAD) from which the budget shrinks. A few may be due to the machine.
MIN_LONG_TICKS = 8
FAR_TOO_LONG = 3.0  # duration of a tick, over the period, above which the tick is far too long
# Number of such ticks in succession from which the budget shrinks.
MIN_FAR_TOO_LONG_TICKS = 2
# Number of short ticks after which the budget grows. It doubles each time that the budget must shrink again after it
# has grown.
MIN_WAIT_TICKS = 50
# Largest number of short ticks after which the budget grows. After as many short ticks at full budget, the number is
# MIN_WAIT_TICKS again.
MAX_WAIT_TICKS = 800
MIN_BUDGET = 16  # smallest budget; fewer samples would hardly save time
AIM = 0.6  # duration of a tick to aim for when the budget shrinks, relative to the period
MAX_SHRINK_FACTOR = 0.9  # the budget shrinks at least by a tenth
GROWTH_DIVISOR = 8  # the budget grows by an eighth and one sample


@dataclass
class SampleBudgetController:
    """Reduces the sample budget if ticks would be late, and raises it again when there is time.

    period: of a tick [s]. most: largest budget. allowed: present budget.
    """

    period: float
    most: int
    allowed: int = field(init=False)
    _last: deque[float] = field(default_factory=lambda: deque(maxlen=MIN_LONG_TICKS), init=False)
    _short: int = field(default=0, init=False)
    _wait: int = field(default=MIN_WAIT_TICKS, init=False)
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
        shortest_of_last = min(last[-MIN_FAR_TOO_LONG_TICKS:])
        slow = len(last) == MIN_LONG_TICKS and min(last) > SHRINK_LOAD * self.period
        if samples > MIN_BUDGET and (
            slow
            or (
                len(last) >= MIN_FAR_TOO_LONG_TICKS
                and shortest_of_last > FAR_TOO_LONG * self.period
            )
        ):
            share = (AIM * self.period / (min(last) if slow else shortest_of_last)) ** 0.5
            fewer = max(MIN_BUDGET, int(samples * min(share, MAX_SHRINK_FACTOR)))
            self.allowed = min(self.allowed, fewer)
            self._last.clear()
            if self._grown:
                self._wait = min(2 * self._wait, MAX_WAIT_TICKS)
            self._short, self._grown = 0, False
        elif seconds > GROW_LOAD * self.period:
            self._short = 0
        else:
            self._grow(ticks)
        return self.allowed

    def _grow(self, ticks: int) -> None:
        self._short += ticks
        if self.allowed < self.most and self._short >= self._wait:
            self.allowed = min(self.most, self.allowed + 1 + self.allowed // GROWTH_DIVISOR)
            self._short, self._grown = 0, True
        elif self.allowed == self.most and self._short >= MAX_WAIT_TICKS:
            self._wait = MIN_WAIT_TICKS
