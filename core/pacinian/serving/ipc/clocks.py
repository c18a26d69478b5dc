"""Clients' clocks against ours, and how much of something may be done a second. Pure: time is given."""

from __future__ import annotations

import math

from pacinian.wire.protocol import MAX_TIME_TO_LIVE

WINDOW = 5.0  # [s]; the offset is the least of the last one to two of them
BACK = MAX_TIME_TO_LIVE  # [s]; a clock that went back by more was set: no command lives so long


class ClockOffsetEstimator:
    """What a client's steady clock shows when ours shows something.

    A message cannot arrive before it is sent: the least difference seen lately between its receipt and the time it
    bears is the offset of the clocks plus the shortest way. Ages are counted from that, and so never negative.
    Drift of a clock is followed within the window: at 100 ppm it makes 1 ms.
    """

    def __init__(self) -> None:
        self._latest = -math.inf  # [s] the client's
        self._until = -math.inf  # [s] of this bucket
        self._now = self._before = (
            math.inf
        )  # least differences [s]: in this bucket, in the one before

    @property
    def offset(self) -> float:
        """Ours less the client's [s]; infinite before the first message."""
        return min(self._now, self._before)

    def age(self, time: float, received: float) -> float:
        """How long ago a message was sent at `time` [s] of the client's clock, that was received at `received` [s]."""
        if time < self._latest - BACK:
            self._until = -math.inf
        self._latest = time
        if received >= self._until:
            kept = self._now if received < self._until + WINDOW else math.inf
            self._before, self._now, self._until = kept, math.inf, received + WINDOW
        self._now = min(self._now, received - time)
        return received - time - self.offset


class TokenBucket:
    """So many a second, or as many at once: a bucket of tokens."""

    def __init__(self, rate: float, burst: float | None = None) -> None:
        self.rate = rate
        self.burst = rate if burst is None else burst
        self._left = self.burst
        self._seen = -math.inf

    def take(self, now: float) -> bool:
        """Whether there may be one more at `now` [s]."""
        if now > self._seen:
            self._left = min(self.burst, self._left + (now - self._seen) * self.rate)
            self._seen = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
