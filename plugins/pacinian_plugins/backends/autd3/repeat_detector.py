"""Rows that come again and again: found, and written to the device meanwhile, which then plays them by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

MAX_ROWS = 256  # rows of a cycle


class RepeatDetector:
    """Follows rows by their digests; a row's index is when it is due, counted in rows. Some may be left out."""

    def __init__(self, most: int = MAX_ROWS) -> None:
        self._periods = np.arange(1, most + 1)
        self._recent = np.zeros(most, np.int64)  # digests, the newest first
        self._known = np.zeros(most, np.bool_)  # those that were not left out
        self._runs = np.zeros(most, np.int64)  # how often each period has held, since it did not
        self._next = 0
        self.stop()

    def stop(self) -> None:
        """Leave the cycle: nothing of it is on the device any more."""
        self.period = self._offset = 0
        self.playing = False
        """Whether the device plays it by itself."""

    def see(self, index: int, digest: int) -> None:
        """The next row."""
        out = index - self._next
        if 0 < out < len(self._recent):
            self._shift(out)
        elif out:
            self._runs[:], self._known[:] = 0, False
        same = self._recent == digest
        self._runs[self._known & same] += 1
        self._runs[self._known & ~same] = 0
        self._shift(1)
        self._recent[0], self._known[0] = digest, True
        self._next = index + 1

    def found(self) -> int:
        """The shortest period, of rows that differ, that has just been seen twice; 0 if there is none."""
        held = np.flatnonzero((self._runs >= self._periods) & (self._runs[0] < self._periods))
        return int(held[0]) + 1 if len(held) else 0

    def begin(self, period: int, offset: int) -> None:
        """Write a cycle: the row of index i is the device's row (i + offset) modulo `period`."""
        self.period, self._offset = period, offset
        self._digests = np.zeros(period, np.int64)
        self._written = np.zeros(period, np.bool_)

    def fits(self, index: int, digest: int) -> bool:
        """Whether this row is as the cycle has it, as far as that is written."""
        place = self._place(index)
        return not self._written[place] or bool(self._digests[place] == digest)

    def wants(self, indices: Sequence[int]) -> int | None:
        """Which of these is to be written next; None if all of them are."""
        missing = (i for i in indices if not self._written[self._place(i)])
        return next(missing, None)

    def wrote(self, index: int, digest: int) -> int:
        """This row is written: return which of the device's rows it is."""
        place = self._place(index)
        self._written[place], self._digests[place] = True, digest
        return place

    @property
    def complete(self) -> bool:
        """Whether all of it is written."""
        return bool(self._written.all())

    def _place(self, index: int) -> int:
        return (index + self._offset) % self.period

    def _shift(self, rows: int) -> None:
        """Make room for so many rows, left out unless told."""
        for history in (self._recent, self._known):
            history[rows:] = history[:-rows]
        self._known[:rows] = False
