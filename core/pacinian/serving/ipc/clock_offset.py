"""Clock offset of a client. Pure: callers pass the time."""

from __future__ import annotations

import math

from pacinian.wire.protocol import MAX_TIME_TO_LIVE

# Time window [s]. The offset is the smallest difference in the last one to two windows.
WINDOW = 5.0
# Largest drift of two clocks [s/s].
MAX_DRIFT = 200e-6
# A client whose clock goes back by more than this has another clock [s], because no command lives so long.
MAX_CLOCK_STEP_BACK = MAX_TIME_TO_LIVE


class ClockOffsetEstimator:
    """Estimates the offset between a client's steady clock and the server's clock.

    A message cannot arrive before it is sent. Therefore the smallest recent difference between receipt and time stamp
    is the clock offset plus the shortest transit time. Ages are measured from that, so they are never negative. The
    window follows clock drift: 100 ppm makes at most 1 ms. The offset before a pause counts after it, with room for
    the drift in between.
    """

    def __init__(self) -> None:
        self._latest = -math.inf  # newest time stamp, by the client's clock [s]
        self._until = -math.inf  # end of the current window [s]
        # Smallest differences [s], in the current window and in the one before.
        self._now = self._before = math.inf

    @property
    def offset(self) -> float:
        """The server's clock minus the client's [s]; infinite before the first message."""
        return min(self._now, self._before)

    def compute_age(self, time: float, received: float) -> float:
        """Return the age [s] of a message sent at `time` [s] by the client's clock and received at `received` [s]."""
        if time < self._latest - MAX_CLOCK_STEP_BACK:
            self._until, self._now, self._before = -math.inf, math.inf, math.inf
        self._latest = time
        if received >= self._until:
            kept = self._now
            # the first message after a pause may have waited in it
            if received >= self._until + WINDOW:
                kept = self.offset + MAX_DRIFT * (received - self._until + WINDOW)
            self._before, self._now, self._until = kept, math.inf, received + WINDOW
        self._now = min(self._now, received - time)
        return received - time - self.offset
