"""Decide whether solves run in the ticks, or in the background, and when a solve in the background begins.

A solve in the background runs in a thread of its own, while the ticks go on.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from statistics import median

# Duration above which a tick counts as long, relative to the period. A tick begins up to 0.2 ms late.
LONG_SHARE = 0.65
TICKS_SEEN = 64  # number of recent ticks with a solve that are considered
# Number of long ticks among the last TICKS_SEEN that moves solves into the background.
MIN_LONG_TICKS = 8
# Two successive ticks of more than this duration, relative to the period, move solves into the background at once.
FAR_TOO_LONG = 2.0
# Duration of a background solve below which the solve would fit into a tick, relative to the period.
SHORT_SHARE = 0.5
# Number of short background solves after which solves return into the ticks. It begins at MIN_FITTING, and doubles with
# each return up to MAX_FITTING.
MIN_FITTING, MAX_FITTING = 256, 4096
# Number of short solves that one long solve cancels. It does not cancel all of them, because another program may have
# caused the long solve.
SHORT_SOLVES_PER_LONG = 8
# Duration of a background solve above which the sample budget is reduced [s]; one period, if that is longer.
GOOD_SOLVE_TIME = 0.004
# Longest expected duration of a background solve [s]; LEAST_MAX_TICKS, if those take longer.
MAX_SOLVE_TIME = 0.012
LEAST_MAX_TICKS = 3  # least value of `max_ticks`, which counts when ticks are long
# Shortest time from the beginning of a solve in the background to that of the next [s].
MIN_SOLVE_INTERVAL = 0.008
# Time after which a solve begins even if the scene has not changed [s].
MAX_SOLVE_INTERVAL = 0.012
MAX_SPREAD_TIME = 0.012  # longest time over which a change is spread [s]
# Time after which a solve begins although the scene is at rest [s]. A scene is at rest if the last solve has changed
# nothing, and nothing in the scene moves by itself.
REST_INTERVAL = 0.05
# Time in which the last solution fades out before silence [s]. Clients wait 20 ms for silence.
END_SPREAD = 0.006
MAX_LEAD = 0.02  # longest time ahead for which a solve is made [s]
# Number of recent solves whose median duration and interval predict those of the next solve.
SOLVES_SEEN = 5


@dataclass
class BackgroundSchedule:
    """Decides whether solves run in the background, and when.

    It counts ticks that were long, and solves in the background that would have fitted into a tick.

    period: period of the ticks [s]. in_background: whether solves run there. expected_ticks: expected duration of the
    next solve [ticks]. expected_interval: expected time from one solution to the next [ticks]. Both are medians of
    recent solves. rests: whether the last solve has changed nothing, and nothing in the scene moves by itself.
    """

    period: float
    in_background: bool = False
    expected_ticks: int = 1
    expected_interval: int = 1
    rests: bool = False
    _long: deque[bool] = field(default_factory=lambda: deque(maxlen=TICKS_SEEN), init=False)
    _seconds: deque[float] = field(default_factory=lambda: deque(maxlen=SOLVES_SEEN), init=False)
    _intervals: deque[int] = field(default_factory=lambda: deque(maxlen=SOLVES_SEEN), init=False)
    _since: int = field(init=False)  # ticks since the last background solve began
    _far: bool = field(default=False, init=False)  # whether the last tick was far too long
    _fits: int = field(default=0, init=False)
    _wait: int = field(default=MIN_FITTING, init=False)

    def __post_init__(self) -> None:
        self._since = self._count_ticks(MAX_SOLVE_INTERVAL)

    @property
    def max_ticks(self) -> int:
        """Largest number of ticks that a solve in the background is expected to take."""
        return max(LEAST_MAX_TICKS, self._count_ticks(MAX_SOLVE_TIME))

    @property
    def lead(self) -> float:
        """Time from the beginning of the next solve in the background until frames reach its result [s].

        The loop will probably take the result after `expected_ticks`. From then on, it interpolates frames, which
        reach the result after a further `expected_interval`, when the loop takes the next result.
        """
        return min((self.expected_ticks + self.expected_interval) * self.period, MAX_LEAD)

    def _count_ticks(self, seconds: float) -> int:
        """Return the number of ticks in a time [s], at least 1."""
        return max(1, round(seconds / self.period))

    def find_spread(self, ends: bool) -> int:
        """Return the number of ticks over which to spread a change. ends: whether silence follows."""
        return (
            min(self.expected_interval, self._count_ticks(END_SPREAD))
            if ends
            else self.expected_interval
        )

    def pass_ticks(self, count: int) -> None:
        """Count ticks, including those that the loop left out because it rested."""
        self._since += count

    def begin_solve(self, changed: bool, urgent: bool = False) -> bool:
        """Return whether a solve is to begin in the background now, and count it if so.

        changed: whether the scene has changed since the last solve began. urgent: whether the output must become silent
        soon.

        A new scene begins a solve at once if scenes come at intervals of at least MIN_SOLVE_INTERVAL, as from trackers
        and games. Between two scenes, objects and hands keep their velocities.
        """
        least = self._count_ticks(MIN_SOLVE_INTERVAL)
        unchanged = self._count_ticks(REST_INTERVAL if self.rests else MAX_SOLVE_INTERVAL)
        if self._since < (unchanged if not changed else 1 if urgent else least):
            return False
        self._intervals.append(min(self._since, self._count_ticks(MAX_SPREAD_TIME)))
        self.expected_interval, self._since = math.ceil(median(self._intervals)), 0
        return True

    def may_rest(self, seconds: float) -> bool:
        """Return whether a scene at rest need not be solved for yet, `seconds` [s] after the last solve in a tick."""
        return self.rests and seconds < REST_INTERVAL

    def note_tick(self, seconds: float) -> None:
        """Take account of a tick that took `seconds` [s] and has solved."""
        if self.in_background:
            return
        far = seconds > FAR_TOO_LONG * self.period
        self._long.append(seconds > LONG_SHARE * self.period)
        if sum(self._long) >= MIN_LONG_TICKS or (far and self._far):
            self._long.clear()
            self.in_background, far = True, False
        self._far = far

    def note_solve(self, seconds: float, whole: bool = True) -> None:
        """Take account of a background solve that took `seconds` [s]. whole: whether no sample was dropped."""
        fits = whole and seconds < SHORT_SHARE * self.period
        self._seconds.append(seconds)
        self.expected_ticks = min(
            max(1, math.ceil(median(self._seconds) / self.period)), self.max_ticks
        )
        self._fits = self._fits + 1 if fits else max(0, self._fits - SHORT_SOLVES_PER_LONG)
        if self._fits >= self._wait:
            self.in_background, self.expected_ticks, self.expected_interval = False, 1, 1
            self._seconds.clear()
            self._intervals.clear()
            self._fits, self._wait = 0, min(2 * self._wait, MAX_FITTING)
