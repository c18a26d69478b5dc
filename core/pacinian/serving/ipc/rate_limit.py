"""Rate limits. Pure: callers pass the time."""

from __future__ import annotations

import math


class TokenBucket:
    """A token bucket. rate: tokens per second. burst: capacity; the rate by default."""

    def __init__(self, rate: float, burst: float | None = None) -> None:
        self.rate = rate
        self.burst = rate if burst is None else burst
        self._left = self.burst
        self._seen = -math.inf

    def take(self, now: float) -> bool:
        """Take a token at `now` [s]; return whether there was one."""
        if now > self._seen:
            self._left = min(self.burst, self._left + (now - self._seen) * self.rate)
            self._seen = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
