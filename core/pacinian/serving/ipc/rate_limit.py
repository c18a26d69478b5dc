"""Rate limits. Pure: callers pass the time.

The highest rate of messages is `ClientLimits.max_rate` in settings.py.
"""

from __future__ import annotations

import math

# Highest rate of errors to a client that it did not ask for, or that it causes while it sends too much [1/s].
ERROR_RATE = 10.0


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


class PeerRateLimiter:
    """Limits the message rate of each connection, and the rate of errors sent to it.

    rate: of messages [1/s]. most: number of connections remembered; the one that was silent for the longest time is
    forgotten first.
    """

    def __init__(self, rate: float, most: int) -> None:
        self._rate, self._most = rate, most
        self._peers: dict[bytes, tuple[TokenBucket, TokenBucket]] = {}

    def __len__(self) -> int:
        return len(self._peers)

    def allows(self, peer: bytes, now: float) -> bool:
        """Return whether a connection may send another message at `now` [s]."""
        return self._find(peer)[0].take(now)

    def should_report(self, peer: bytes, now: float) -> bool:
        """Return whether to send an error to a connection that has no session or sends too much."""
        return self._find(peer)[1].take(now)

    def _find(self, peer: bytes) -> tuple[TokenBucket, TokenBucket]:
        known = self._peers.pop(peer, None)
        if known is None:
            if len(self._peers) >= self._most:
                del self._peers[next(iter(self._peers))]
            known = TokenBucket(self._rate), TokenBucket(ERROR_RATE)
        self._peers[peer] = known  # last in the order
        return known
