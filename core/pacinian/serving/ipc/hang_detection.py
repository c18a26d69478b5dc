"""For how long a process may send no heartbeat, and how the time without one is counted.

The limit itself: `Safety.hang_timeout` in settings.py.
"""

from __future__ import annotations

# While there may be sound, the guard's hang limit is `hang_timeout` divided by this.
SOUNDING_HANG_DIVISOR = 8
MIN_HANG_LIMIT = 0.1  # smallest hang limit of a guard while there may be sound [s]
# Largest time counted from one check to the next [s]. A process that was late itself cannot tell whether another one is
# late.
MAX_CHECK_GAP = 0.05


def compute_sounding_hang_limit(hang_timeout: float) -> float:
    """Return the time without a heartbeat after which a guard is killed while there may be sound [s]."""
    return min(hang_timeout, max(MIN_HANG_LIMIT, hang_timeout / SOUNDING_HANG_DIVISOR))


class WatchedTime:
    """The time spent watching. If the watcher is late, only `MAX_CHECK_GAP` counts. seconds: so far [s]."""

    def __init__(self, now: float) -> None:
        self.seconds = 0.0
        self._last = now  # time of the last check [s]

    def advance(self, now: float) -> None:
        """Count the time since the last check, at `now` [s]."""
        self.seconds += min(now - self._last, MAX_CHECK_GAP)
        self._last = now
