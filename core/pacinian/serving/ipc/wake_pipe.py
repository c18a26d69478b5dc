"""A wait that another process can end: a named pipe in the folder of the shared memory.

A process that has nothing to do waits here, and does not look at the shared memory again and again. Whoever writes a
value for it then writes a byte to its pipe. A byte that was written before the wait ends the wait at once, so none is
missed. Bytes stay in the pipe until the next wait; a full pipe wakes like a single byte. Without named pipes, `wait`
polls `news`.
"""

from __future__ import annotations

import contextlib
import math
import os
import select
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

POLL_INTERVAL = 5e-3  # interval between two checks for news where there are no named pipes [s]
MAX_SELECTABLE = 1024  # `select` accepts only file descriptors below this
READ_BYTES = 1 << 16  # number of bytes read at once: as many as a pipe holds


class WakePipe:
    """The pipe of one process, at `path`. Made if it is missing; any process may make it, and any may write to it."""

    def __init__(self, path: Path) -> None:
        self._file = -1
        if sys.platform != "win32":
            try:
                with contextlib.suppress(FileExistsError):
                    os.mkfifo(path, 0o600)
                self._file = os.open(path, os.O_RDWR | os.O_NONBLOCK)
            except OSError:  # the folder's file system has none
                return
            self._poll = select.poll()
            self._poll.register(self._file, select.POLLIN)

    @property
    def works(self) -> bool:
        """Whether the folder has named pipes."""
        return self._file >= 0

    def fileno(self) -> int:
        """Return the file descriptor, to wait for it among others; -1 if there are no named pipes."""
        return self._file

    def wake(self) -> None:
        """End the wait of the process, or its next wait."""
        if self.works:
            with contextlib.suppress(BlockingIOError):  # full
                os.write(self._file, b"!")

    def wait(self, seconds: float, news: Callable[[], bool]) -> None:
        """Wait until another process calls `wake`, at most `seconds`.

        news: whether a value has come for which another process would wake this one. Without named pipes, it is polled.
        """
        if self.works:
            if self._file < MAX_SELECTABLE:
                woken = bool(select.select([self._file], [], [], max(0.0, seconds))[0])
            else:  # in steps of a millisecond
                woken = bool(self._poll.poll(max(0, math.ceil(1e3 * seconds))))
            if woken:
                self.clear()
            return
        due = time.perf_counter() + seconds
        while not news() and (left := due - time.perf_counter()) > 0.0:
            time.sleep(min(left, POLL_INTERVAL))

    def clear(self) -> None:
        """Take all bytes, so that the next wait is for later ones."""
        if not self.works:
            return
        with contextlib.suppress(BlockingIOError):
            os.read(self._file, READ_BYTES)

    def close(self) -> None:
        """Close the pipe. May be called twice."""
        if self.works:
            os.close(self._file)
            self._file = -1
