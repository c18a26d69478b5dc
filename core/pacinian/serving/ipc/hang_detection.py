"""When a process without a heartbeat counts as one that hangs."""

from __future__ import annotations

# The hang limit of a guard is that of other processes divided by this, while there may be sound.
SOUNDING_HANG_DIVISOR = 8
MIN_HANG_LIMIT = 0.1  # smallest hang limit of a guard while there may be sound [s]
# Largest time counted from one check to the next [s]. A process that was late itself cannot tell whether another one is
# late.
MAX_CHECK_GAP = 0.05


def compute_hang_limit(hang_timeout: float, *, sound: bool) -> float:
    """Return the time without a heartbeat after which a process is killed [s]. sound: the guard's limit with sound."""
    return (
        min(hang_timeout, max(MIN_HANG_LIMIT, hang_timeout / SOUNDING_HANG_DIVISOR))
        if sound
        else hang_timeout
    )


class HangDetector:
    """Detects a guard that hangs. limit: time without a heartbeat while there may be sound [s], as in `Supervisor`."""

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._heartbeat = self._silent = 0.0  # the last heartbeat; time watched since then [s]
        self._last = -1.0  # time of the last check [s]

    def detect_hang(self, heartbeat: float, sound: bool, now: float) -> bool:
        """Check the last `heartbeat` [s] at `now` [s]; return whether the guard hangs.

        sound: whether there may be sound.
        """
        self._silent += min(now - self._last, MAX_CHECK_GAP)
        self._last = now
        if heartbeat != self._heartbeat or not sound:
            self._heartbeat, self._silent = heartbeat, 0.0
        return self._silent > self._limit
