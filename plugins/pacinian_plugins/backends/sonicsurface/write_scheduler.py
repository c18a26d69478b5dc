"""What goes over a slow line next: the newest pattern, and never a second one behind it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian_plugins.backends.sonicsurface.protocol import BOARD, BYTE, OFF, SWAP, frame_message

if TYPE_CHECKING:
    from collections.abc import Sequence

AGAIN = 0.5  # [s] after which what stays is written again: there is no acknowledgement


class WriteScheduler:
    """The line's time, and both buffers of the boards: `front` is heard, `back` is the one before.

    boards: 1 or 2. select: the commands by which they are chosen.
    """

    def __init__(self, boards: int, select: Sequence[int]) -> None:
        self.quiet = bytes([OFF]) * BOARD * boards
        self.newest = self.front = self.back = b""  # empty: nothing to show, or not known
        self.urgent = False
        """The newest goes out whatever is under way."""
        self.free = -math.inf
        """[s] when the line is."""
        self._again = -math.inf
        self._select = select

    def off(self) -> None:
        """Silence: at once, and in full."""
        self.newest, self.urgent = self.quiet, True

    def forget(self) -> None:
        """Show nothing: it is not known what has arrived."""
        self.newest = self.front = self.back = b""
        self.urgent = False

    def next(self, now: float) -> bytes:
        """What to write now [s]; empty if there is nothing."""
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
        self._again = now + AGAIN
        return data

    @property
    def due(self) -> float:
        """When there is something to write, if nothing new comes [s]."""
        if not self.newest:
            return math.inf
        return self.free if self.newest != self.front else max(self.free, self._again)
