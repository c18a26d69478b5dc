"""Round trips, and the offset of the server's clock. Pure: callers pass the times."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

MAX_ROUND_TRIPS = 1000  # number of round trips kept
MARKS = 64  # number of clock samples kept


class RoundTrips(NamedTuple):
    """Round trips of the last blocking calls [s]: median, 99th percentile and maximum; 0 before the first."""

    median: float = 0.0
    p99: float = 0.0
    longest: float = 0.0


class ServerClock:
    """Keeps the last round trips and samples of the server's clock."""

    def __init__(self) -> None:
        self._round_trips = deque[float](maxlen=MAX_ROUND_TRIPS)
        self._marks = deque[tuple[float, float]](maxlen=MARKS)

    def add_round_trip(self, sent: float, received: float) -> None:
        """Note a blocking call: sent, and its reply received, at these times by the client's clock [s]."""
        self._round_trips.append(received - sent)

    def add_mark(self, sent: float, received: float, server: float) -> None:
        """Note that the server's clock showed `server` [s] at some time between these."""
        self._marks.append((received - sent, server - (sent + received) / 2.0))

    @property
    def offset(self) -> float:
        """The server's clock minus the client's [s], from the shortest recent round trip.

        Its error is at most half of that trip.
        """
        return min(self._marks)[1] if self._marks else 0.0

    def age(self, time: float, now: float) -> float:
        """Return the time since the server's clock showed `time` [s]; now: by the client's clock [s]."""
        return now + self.offset - time

    @property
    def round_trips(self) -> RoundTrips:
        """Round trips of the last 1000 blocking calls."""
        if not self._round_trips:
            return RoundTrips()
        ordered = sorted(self._round_trips)
        last = len(ordered) - 1
        return RoundTrips(ordered[last // 2], ordered[round(0.99 * last)], ordered[last])
