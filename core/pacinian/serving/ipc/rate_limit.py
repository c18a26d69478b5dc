"""Rate limits. Pure: callers pass the time."""

from __future__ import annotations

import math


class TokenBucket:
    """A token bucket, which holds as many tokens as come in a second. rate: tokens per second."""

    def __init__(self, rate: float) -> None:
        self._rate = self._left = rate
        self._seen = -math.inf

    def take(self, now: float) -> bool:
        """Take a token at `now` [s]; return whether there was one."""
        if now > self._seen:
            self._left = min(self._rate, self._left + (now - self._seen) * self._rate)
            self._seen = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
