"""The sample budget that the time allows."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

HIGH, LOW = 0.75, 0.5  # share of a tick above which the budget shrinks, below which it may grow
RUN = 8  # ticks in a row that must be too long: a few may be the machine's doing
FAR, SOON = 3.0, 2  # ticks that take so many times as long as they may need be only so many
WAIT = 50  # ticks in a row that must be short before it grows
MAX_WAIT = (
    800  # of them, twice as many after each relapse; so many at its most, and all is forgotten
)
MIN_BUDGET = 16  # samples: with fewer, it is not they that take the time
AIM = 0.6  # share of a tick that the next ones are to take


@dataclass
class BudgetController:
    """Lets a tick that would be late have fewer samples, and more again when there is time.

    period: of a tick [s]. most: samples at most. allowed: samples now.
    """

    period: float
    most: int
    allowed: int = field(init=False)
    _last: deque[float] = field(default_factory=lambda: deque(maxlen=RUN), init=False)
    _short: int = field(default=0, init=False)
    _wait: int = field(default=WAIT, init=False)
    _grown: bool = field(default=False, init=False)  # since it last shrank

    def __post_init__(self) -> None:
        self.allowed = self.most

    def tick(self, seconds: float, samples: int) -> int:
        """Look at a tick that took `seconds` [s] for `samples` samples; return how many are allowed next.

        The time of a solve grows with the square of the samples, at least.
        """
        self._last.append(seconds)
        last = list(self._last)
        soon = min(last[-SOON:])
        slow = len(last) == RUN and min(last) > HIGH * self.period
        if samples > MIN_BUDGET and (slow or (len(last) >= SOON and soon > FAR * self.period)):
            share = (AIM * self.period / (min(last) if slow else soon)) ** 0.5
            fewer = max(MIN_BUDGET, int(samples * min(share, 0.9)))
            self.allowed = min(self.allowed, fewer)
            self._last.clear()
            if self._grown:
                self._wait = min(2 * self._wait, MAX_WAIT)
            self._short, self._grown = 0, False
        elif seconds > LOW * self.period:
            self._short = 0
        else:
            self._grow()
        return self.allowed

    def _grow(self) -> None:
        self._short += 1
        if self.allowed < self.most and self._short >= self._wait:
            self.allowed = min(self.most, self.allowed + 1 + self.allowed // 8)
            self._short, self._grown = 0, True
        elif self.allowed == self.most and self._short >= MAX_WAIT:
            self._wait = WAIT
