"""Sampling and solving by turns, where both in one tick would be late."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

LONG_SHARE = 0.8  # share of a tick from which it is long
SEEN, MANY = 64, 12  # of so many ticks that solved so many may be long before turns are taken
SHORT = 0.75  # share of a tick within which both must fit to go back
WAIT, LONGEST = 256, 4096  # pairs that must; twice as many after each relapse
BACK = 8  # pairs that one which does not fit takes away: a few may be the machine's doing


@dataclass
class TickAlternation:
    """Lets one tick look at the scene and the next solve: each then has time, and all still send.

    period: of a tick [s]. taking: whether turns are taken. samples, solves: what the next tick does.
    """

    period: float
    taking: bool = False
    samples: bool = True
    solves: bool = True
    _long: deque[bool] = field(default_factory=lambda: deque(maxlen=SEEN), init=False)
    _before: float = field(default=0.0, init=False)  # [s], what the tick that sampled took
    _fits: int = field(default=0, init=False)
    _wait: int = field(default=WAIT, init=False)

    def tick(self, seconds: float, solved: bool) -> bool:
        """Look at a tick that took `seconds` [s], and whether it solved; return whether turns begin."""
        if not self.taking:
            if solved:
                self._long.append(seconds > LONG_SHARE * self.period)
            if sum(self._long) < MANY:
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
            self._fits, self._wait = 0, min(2 * self._wait, LONGEST)
        return False
