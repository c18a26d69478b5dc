"""Selects what is written to a slow line next: always the newest pattern, and nothing queued behind it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian_plugins.backends.sonicsurface.protocol import BOARD, BYTE, OFF, SWAP, frame_message

if TYPE_CHECKING:
    from collections.abc import Sequence

REPEAT_INTERVAL = 0.5  # interval at which an unchanged pattern is repeated [s], because there is no acknowledgement


class WriteScheduler:
    """Tracks when the line is free, and both buffers of the boards: `front` is playing, `back` is the previous one.

    boards: 1 or 2. select: the commands that select them.
    """

    def __init__(self, boards: int, select: Sequence[int]) -> None:
        self.quiet = bytes([OFF]) * BOARD * boards
        self.newest = self.front = self.back = b""  # empty: none, or unknown
        self.urgent = False
        """Whether the newest pattern interrupts the message under way."""
        self.free = -math.inf
        """Time when the line is free [s]."""
        self._again = -math.inf
        self._select = select

    def off(self) -> None:
        """Make silence the newest pattern, and send it at once and in full."""
        self.newest, self.urgent = self.quiet, True

    def forget(self) -> None:
        """Send nothing, and forget the buffers, because it is unknown what has arrived."""
        self.newest = self.front = self.back = b""
        self.urgent = False

    def next(self, now: float) -> bytes:
        """Return the bytes to write at time `now` [s]; empty if there are none."""
        newest = self.newest
        if not newest or not (self.urgent or now >= self.due):
            return b""
        if newest == self.back != self.front and not self.urgent:
            data = bytes([SWAP])
            self.back = self.front
        else:
            data = frame_message(newest, self._select)
            self.back = b"" if self.urgent else self.front
        self.front, self.urgent = newest, False
        self.free = max(self.free, now) + len(data) * BYTE
        self._again = now + REPEAT_INTERVAL
        return data

    @property
    def due(self) -> float:
        """Time of the next write if no new pattern arrives [s]."""
        if not self.newest:
            return math.inf
        return self.free if self.newest != self.front else max(self.free, self._again)
