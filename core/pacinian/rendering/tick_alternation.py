"""Let sampling and solving alternate between ticks, if a tick that does both would be late."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

LONG_SHARE = 0.8  # duration above which a tick is long, relative to the period
TICKS_SEEN, MIN_LONG_TICKS = (
    64,
    12,
)  # alternation begins once 12 of the last 64 ticks with a solve were long
SHORT = 0.75  # duration within which both must fit to end alternation, relative to the period
MIN_FITTING, MAX_FITTING = (
    256,
    4096,
)  # pairs of ticks that must fit; doubled after each relapse, up to LONGEST
BACK = 8  # pairs deducted for one that does not fit; a few may be due to the machine


@dataclass
class TickAlternation:
    """Lets one tick sample the scene and the next solve, so that each has enough time. Every tick still sends.

    period: of a tick [s]. taking: whether ticks alternate. samples, solves: whether the next tick samples, and solves.
    """

    period: float
    taking: bool = False
    samples: bool = True
    solves: bool = True
    _long: deque[bool] = field(default_factory=lambda: deque(maxlen=TICKS_SEEN), init=False)
    _before: float = field(default=0.0, init=False)  # duration of the tick that sampled [s]
    _fits: int = field(default=0, init=False)
    _wait: int = field(default=MIN_FITTING, init=False)

    def tick(self, seconds: float, solved: bool) -> bool:
        """Take account of a tick that took `seconds` [s]; return whether alternation begins.

        solved: whether the tick solved.
        """
        if not self.taking:
            if solved:
                self._long.append(seconds > LONG_SHARE * self.period)
            if sum(self._long) < MIN_LONG_TICKS:
                return False
            self._long.clear()
            self.taking, self.samples, self.solves = True, True, False
            return True
        if self.samples:
            self._before = seconds
        elif solved:
            fits = self._before + seconds < SHORT * self.period
            self._fits = self._fits + 1 if fits else max(0, self._fits - BACK)
        self.samples, self.solves = self.solves, self.samples
        if self._fits >= self._wait:
            self.taking, self.samples, self.solves = False, True, True
            self._fits, self._wait = 0, min(2 * self._wait, MAX_FITTING)
        return False
