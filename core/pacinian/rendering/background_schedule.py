"""Decide whether solves run in the ticks, or in a thread beside them, and when such a solve begins."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from statistics import median

LONG_SHARE = (
    0.65  # duration above which a tick is long, relative to the period; it begins up to 0.2 ms late
)
TICKS_SEEN = 64  # last ticks with a solve that count
MIN_LONG_TICKS = 8  # long ones among them from which solves run beside the ticks
FAR_TOO_LONG = 2.0  # two successive ticks of this duration, relative to the period, suffice
# Duration within which a solve must fit to run in a tick again, relative to the period.
SHORT_SHARE = 0.5
# successive short solves before solving returns into the ticks: at first, and at most; doubled after each return
MIN_FITTING, MAX_FITTING = 256, 4096
PENALTY = 8  # short solves that a long one cancels; the machine may have caused it, so it does not cancel all
SOLVE_TICKS = 4  # ticks that a solve beside them may take before the scene loses samples
MAX_TICKS = 3 * SOLVE_TICKS  # most ticks that a solve beside them is expected to take
# shortest time from the beginning of a solve beside the ticks to that of the next [s]
MIN_INTERVAL = 0.008
MAX_INTERVAL = 0.012  # after which a solve begins although the scene is the same; longest spread of a change [s]
# the same, if the last solve has changed nothing and the passing of time moves nothing [s]
REST_INTERVAL = 0.05
# time in which the last solution fades out [s]; clients wait 20 ms for silence
END_SPREAD = 0.006
SOLVES_SEEN = 5  # last solves whose medians are expected of the next


@dataclass
class BackgroundSchedule:
    """Decides whether solves run beside the ticks, and when. Counts long ticks, and solves that would fit.

    period: of a tick [s]. beside: whether solves run beside the ticks. ticks: number of ticks that the next solve will
    take, by the last ones. interval: number of ticks from one solution to the next, likewise. rests: whether the last
    solve has changed nothing, and the passing of time moves nothing.
    """

    period: float
    beside: bool = False
    ticks: int = 1
    interval: int = 1
    rests: bool = False
    _long: deque[bool] = field(default_factory=lambda: deque(maxlen=TICKS_SEEN), init=False)
    _seconds: deque[float] = field(default_factory=lambda: deque(maxlen=SOLVES_SEEN), init=False)
    _intervals: deque[int] = field(default_factory=lambda: deque(maxlen=SOLVES_SEEN), init=False)
    _since: int = field(init=False)  # ticks since the last solve beside them began
    _far: bool = field(default=False, init=False)  # whether the last tick was far too long
    _fits: int = field(default=0, init=False)
    _wait: int = field(default=MIN_FITTING, init=False)

    def __post_init__(self) -> None:
        self._since = self._count_ticks(MAX_INTERVAL)

    def _count_ticks(self, seconds: float) -> int:
        """Return the number of ticks in a time [s], at least 1."""
        return max(1, round(seconds / self.period))

    def find_spread(self, ends: bool) -> int:
        """Return the number of ticks over which to spread a change. ends: whether there will be silence."""
        return min(self.interval, self._count_ticks(END_SPREAD)) if ends else self.interval

    def pass_ticks(self, count: int) -> None:
        """Count ticks, including those that did not take place."""
        self._since += count

    def begin_solve(self, changed: bool, urgent: bool = False) -> bool:
        """Return whether a solve is to begin beside this tick, and count it if so.

        changed: whether the scene has. urgent: whether there must be silence soon.

        A new scene begins a solve at once if scenes come at intervals of at least MIN_INTERVAL, as from trackers and
        games. Between them, objects and hands move on as they moved.
        """
        least, most = self._count_ticks(MIN_INTERVAL), self._count_ticks(MAX_INTERVAL)
        unchanged = self._count_ticks(REST_INTERVAL) if self.rests else most
        if self._since < (unchanged if not changed else 1 if urgent else least):
            return False
        self._intervals.append(min(self._since, most))
        self.interval, self._since = math.ceil(median(self._intervals)), 0
        return True

    def note_tick(self, seconds: float) -> None:
        """Take account of a tick that took `seconds` [s] and has solved."""
        if self.beside:
            return
        far = seconds > FAR_TOO_LONG * self.period
        self._long.append(seconds > LONG_SHARE * self.period)
        if sum(self._long) >= MIN_LONG_TICKS or (far and self._far):
            self._long.clear()
            self.beside, far = True, False
        self._far = far

    def note_solve(self, seconds: float, whole: bool = True) -> None:
        """Take account of a solve beside the ticks that took `seconds` [s]. whole: whether no sample was dropped."""
        fits = whole and seconds < SHORT_SHARE * self.period
        self._seconds.append(seconds)
        self.ticks = min(max(1, math.ceil(median(self._seconds) / self.period)), MAX_TICKS)
        self._fits = self._fits + 1 if fits else max(0, self._fits - PENALTY)
        if self._fits >= self._wait:
            self.beside, self.ticks, self.interval = False, 1, 1
            self._seconds.clear()
            self._intervals.clear()
            self._fits, self._wait = 0, min(2 * self._wait, MAX_FITTING)
