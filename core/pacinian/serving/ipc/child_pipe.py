"""The pipes through which control sends its children their configuration, and ends them.

Strangers' connections may take all file descriptors that the system permits (decision 38). The pipes are therefore open
before anybody can connect, and stay open: a child that is started later inherits the pipe of one that has ended.
"""

from __future__ import annotations

import contextlib
import os
import select
import sys
import threading
from typing import TYPE_CHECKING

from pacinian.errors import ServerError
from pacinian.serving.ipc.system_setup import list_file_descriptors

if TYPE_CHECKING:
    from pacinian.serving.ipc.processes import Child

READ_BYTES = 1 << 16  # number of bytes read at once when the pipe is emptied
MAX_POLL_TIME = 10  # longest wait for data of a pipe that is being emptied [ms]


class ChildPipe:
    """The standard input of one child. When it is closed, the child ends.

    source: file descriptor of the end that the child inherits. child: the last one that did.
    """

    def __init__(self) -> None:
        self.source, self._sink = os.pipe()
        self.child: Child | None = None
        self._lock = threading.Lock()
        self._closed, self._unwritten = False, 0  # number of texts that are not yet written
        self._writer: threading.Thread | None = None

    def write(self, data: bytes) -> None:
        """Write `data` after all earlier data.

        This uses a thread, because the child may not read. Raises RuntimeError if the system permits no more threads.
        """
        before = self._writer

        def write_all() -> None:
            try:
                if before is not None:
                    before.join()
                rest = memoryview(data)
                with contextlib.suppress(OSError):  # the child has died; its exit code shows that
                    while rest:
                        rest = rest[os.write(self._sink, rest) :]
            finally:
                self._count(-1)

        thread = threading.Thread(target=write_all, name="child pipe", daemon=True)
        if not self._count(1):
            return  # closed: nobody reads
        try:
            thread.start()
        except RuntimeError:
            self._count(-1)
            raise
        self._writer = thread

    def empty(self) -> None:
        """Read what the last child has not read. That child must have ended."""
        poll = select.poll()
        poll.register(self.source, select.POLLIN)
        while True:
            # before the poll: then nothing comes after a poll that finds nothing
            unwritten = self._unwritten
            if poll.poll(MAX_POLL_TIME if unwritten else 0):
                os.read(self.source, READ_BYTES)
            elif not unwritten:
                return

    def close(self) -> None:
        """Close both ends. The child still receives what is being written."""
        with self._lock:
            if not self._closed:
                self._closed = True
                os.close(self.source)
                self._close_sink()

    def _count(self, change: int) -> bool:
        """Count a text that is to be written, or was. Returns False, and does nothing, for a new one after `close`."""
        with self._lock:
            if change > 0 and self._closed:
                return False
            self._unwritten += change
            if self._closed:
                self._close_sink()
            return True

    def _close_sink(self) -> None:
        if not self._unwritten:
            os.close(self._sink)


class ChildPipes:
    """Pipes for at most `count` children at the same time. A context manager.

    The files that this process has inherited are no longer passed on to its children.
    """

    def __init__(self, count: int) -> None:
        _pass_on_no_files()
        self._pipes = [ChildPipe() for _ in range(count)]

    def __enter__(self) -> ChildPipes:
        return self

    def __exit__(self, *_: object) -> None:
        for pipe in self._pipes:
            pipe.close()

    def take(self) -> ChildPipe:
        """Return an empty pipe without a running child. Raises ServerError if each has one."""
        for i, pipe in enumerate(self._pipes):
            if pipe.child is None:
                return pipe
            if pipe.child.poll() is not None:
                if sys.platform == "win32":  # cannot look into a pipe, but limits no files
                    pipe.close()
                    self._pipes[i] = ChildPipe()
                else:
                    pipe.empty()
                return self._pipes[i]
        raise ServerError(f"{len(self._pipes)} processes have not ended yet")


def _pass_on_no_files() -> None:
    with contextlib.suppress(OSError):  # where the system does not list them
        for number in list_file_descriptors():
            os.set_inheritable(number, False)
