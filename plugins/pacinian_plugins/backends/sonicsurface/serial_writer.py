"""Writes to a serial port in a thread of its own, so that no caller waits for the line."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian_plugins.backends.sonicsurface.ports import STUCK, explain

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_plugins.backends.sonicsurface.write_scheduler import WriteScheduler

POLL_INTERVAL = 1e-3  # interval at which the system's output buffer is polled [s]


class SerialWriter:
    """Writes the data of a `WriteScheduler` to a port, and closes the port when it is closed.

    port: of pyserial. timeout: time that the system may hold bytes after the line should be free [s]. clock: [s].
    """

    def __init__(
        self, port: Any, feed: WriteScheduler, timeout: float, clock: Callable[[], float]
    ) -> None:
        self._port, self._feed, self._timeout, self._clock = port, feed, timeout, clock
        self._changed = threading.Condition()
        self._idle = self._closing = False
        self._problem = ""
        self._thread = threading.Thread(target=self._run, name="sonicsurface", daemon=True)
        self._thread.start()

    def show(self, pattern: bytes) -> None:
        """Send a pattern when the line is free, unless a newer one replaces it. Raises BackendError."""
        try:
            self._count_waiting()  # fails if the port has gone
        except Exception as error:
            self._record_problem(error)
        with self._changed:
            if self._problem:
                raise pc.BackendError(self._problem)
            self._feed.newest = pattern
            self._changed.notify_all()

    def silence(self) -> None:
        """Silence at once; return when the bytes have left the system. Raises BackendError if the sound continues."""
        with self._changed:
            self._problem, self._idle = "", False
            self._feed.off()
            self._changed.notify_all()
            left = max(0.0, self._feed.free - self._clock())
            limit = left + 2.0 * self._timeout
            self._changed.wait_for(lambda: self._idle or self._problem, limit)
            if not (self._idle or self._problem):
                self._problem = explain(TimeoutError(STUCK), self._port.port)
            if self._problem:
                raise pc.BackendError(self._problem)

    def close(self) -> None:
        """Silence the array, and close the port when the line is free. Never raises."""
        try:
            self.silence()
        except pc.BackendError:
            with self._changed:
                self._feed.forget()
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(2.0 * self._timeout + max(0.0, self._feed.free - self._clock()))
        self._port.close()

    def _run(self) -> None:
        while True:
            try:
                if not (data := self._next()):
                    return
                self._port.write(data)
            except Exception as error:
                self._record_problem(error)

    def _next(self) -> bytes:
        """Wait for the next bytes to write, and return them; empty at the end."""
        with self._changed:
            while True:
                now, feed = self._clock(), self._feed
                held = self._count_waiting() if feed.newest else 0
                if feed.urgent:
                    self._port.reset_output_buffer()  # drop the rest of the message under way
                elif held and now > feed.free + self._timeout:
                    raise TimeoutError(STUCK)
                elif not (held or self._idle):
                    self._idle = True
                    self._changed.notify_all()
                if (feed.urgent or not held) and (data := feed.next(now)):
                    return data
                if self._closing and now >= feed.free:
                    return b""
                due = now + POLL_INTERVAL if held else feed.free if self._closing else feed.due
                self._changed.wait(min(max(due - now, 0.0), threading.TIMEOUT_MAX))

    def _count_waiting(self) -> int:
        """Return the number of bytes that the system has not passed to the adapter. Raises OSError."""
        return int(self._port.out_waiting)

    def _record_problem(self, error: Exception) -> None:
        with self._changed:
            self._problem = explain(error, self._port.port)
            self._feed.forget()
            self._changed.notify_all()
