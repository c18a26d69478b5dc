"""A serial port, fed by a thread of its own: nobody waits for the line."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian_plugins.backends.sonicsurface.ports import STUCK, explain

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_plugins.backends.sonicsurface.write_scheduler import WriteScheduler

LOOK = 1e-3  # [s] between two looks at what the system still holds


class SerialWriter:
    """Writes what a feed says to a port, which is closed with it.

    port: of pyserial. timeout: for which the system may hold bytes beyond the line's time [s]. clock: [s].
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
        """Show a pattern, once there is time for it and it is still the newest. Raises BackendError."""
        try:
            self._held()  # the system knows whether the port is still there
        except Exception as error:
            self._failed(error)
        with self._changed:
            if self._problem:
                raise pc.BackendError(self._problem)
            self._feed.newest = pattern
            self._changed.notify_all()

    def silence(self) -> None:
        """Show nothing, at once; back when that has left the system. Raises BackendError: it goes on."""
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
        """Silence, and close the port when the line has been. Never raises."""
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
                self._failed(error)

    def _next(self) -> bytes:
        """What to write, once there is something; empty at the end."""
        with self._changed:
            while True:
                now, feed = self._clock(), self._feed
                held = self._held() if feed.newest else 0
                if feed.urgent:
                    self._port.reset_output_buffer()  # the rest of what is under way
                elif held and now > feed.free + self._timeout:
                    raise TimeoutError(STUCK)
                elif not (held or self._idle):
                    self._idle = True
                    self._changed.notify_all()
                if (feed.urgent or not held) and (data := feed.next(now)):
                    return data
                if self._closing and now >= feed.free:
                    return b""
                due = now + LOOK if held else feed.free if self._closing else feed.due
                self._changed.wait(min(max(due - now, 0.0), threading.TIMEOUT_MAX))

    def _held(self) -> int:
        """Bytes that the system has not given to the adapter yet. Raises OSError."""
        return int(self._port.out_waiting)

    def _failed(self, error: Exception) -> None:
        with self._changed:
            self._problem = explain(error, self._port.port)
            self._feed.forget()
            self._changed.notify_all()
