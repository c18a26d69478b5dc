"""Round trips, and how the server's clock lies to ours: pure, with times given."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

MAX_TRIPS = 1000  # round trips
MARKS = 64  # looks at the server's clock


class Trips(NamedTuple):
    """Round trips of the last blocking calls [s]: median, 99 % and the longest; 0 before the first."""

    median: float = 0.0
    p99: float = 0.0
    longest: float = 0.0


class Timing:
    """The last round trips and looks at the server's clock."""

    def __init__(self) -> None:
        self._trips = deque[float](maxlen=MAX_TRIPS)
        self._marks = deque[tuple[float, float]](maxlen=MARKS)

    def answered(self, sent: float, received: float) -> None:
        """A call was sent, and its answer received, at these times of our clock [s]."""
        self._trips.append(received - sent)

    def clocked(self, sent: float, received: float, server: float) -> None:
        """The server's clock was at `server` [s] some time between."""
        self._marks.append((received - sent, server - (sent + received) / 2.0))

    @property
    def offset(self) -> float:
        """Server's clock less ours [s], from the shortest round trip of late: off by at most half of it."""
        return min(self._marks)[1] if self._marks else 0.0

    def age(self, time: float, now: float) -> float:
        """How long ago, at `now` of our clock [s], the server's clock was at `time` [s]."""
        return now + self.offset - time

    @property
    def trips(self) -> Trips:
        """Of the last 1000 blocking calls."""
        if not self._trips:
            return Trips()
        ordered = sorted(self._trips)
        last = len(ordered) - 1
        return Trips(ordered[last // 2], ordered[round(0.99 * last)], ordered[last])
