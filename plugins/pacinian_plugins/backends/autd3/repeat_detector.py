"""Detects periodic rows. They are written to the device, which then plays the cycle by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

MAX_ROWS = 256  # maximum number of rows in a cycle


class RepeatDetector:
    """Follows rows by their digests. The index of a row is its due time, counted in rows. Rows may be missing."""

    def __init__(self, most: int = MAX_ROWS) -> None:
        self._periods = np.arange(1, most + 1)
        self._recent = np.zeros(most, np.int64)  # digests, newest first
        self._known = np.zeros(most, np.bool_)  # rows that are not missing
        self._runs = np.zeros(most, np.int64)  # consecutive matches of each period
        self._next = 0
        self.stop()

    def stop(self) -> None:
        """Leave the cycle, and treat nothing of it as written."""
        self.period = self._offset = 0
        self.playing = False
        """Whether the device plays the cycle by itself."""

    def see(self, index: int, digest: int) -> None:
        """Record the next row."""
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
        """Return the shortest period that has just been seen twice and is not one constant row; 0 if there is none."""
        held = np.flatnonzero((self._runs >= self._periods) & (self._runs[0] < self._periods))
        return int(held[0]) + 1 if len(held) else 0

    def begin(self, period: int, offset: int) -> None:
        """Begin to write a cycle: the row of index i is the device's row (i + offset) modulo `period`."""
        self.period, self._offset = period, offset
        self._digests = np.zeros(period, np.int64)
        self._written = np.zeros(period, np.bool_)

    def fits(self, index: int, digest: int) -> bool:
        """Return whether this row matches the cycle, as far as it is written."""
        place = self._place(index)
        return not self._written[place] or bool(self._digests[place] == digest)

    def wants(self, indices: Sequence[int]) -> int | None:
        """Return which of these rows to write next; None if all are written."""
        missing = (i for i in indices if not self._written[self._place(i)])
        return next(missing, None)

    def wrote(self, index: int, digest: int) -> int:
        """Mark this row as written, and return its row on the device."""
        place = self._place(index)
        self._written[place], self._digests[place] = True, digest
        return place

    @property
    def complete(self) -> bool:
        """Whether the whole cycle is written."""
        return bool(self._written.all())

    def _place(self, index: int) -> int:
        return (index + self._offset) % self.period

    def _shift(self, rows: int) -> None:
        """Shift the history by `rows` rows, which count as missing."""
        for history in (self._recent, self._known):
            history[rows:] = history[:-rows]
        self._known[:rows] = False
