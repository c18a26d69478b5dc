"""Logging of the server's processes to standard error: readable text, or one JSON object a line.

A thread writes the lines. If standard error is not read, or is closed, lines are lost and nothing else fails.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import queue
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from pacinian.serving.ipc.log_lines import format_coloured_text, format_json, format_text
from pacinian.serving.ipc.rate_limit import TokenBucket

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.serving.ipc.log_lines import Formatter
    from pacinian.serving.settings import Log

MAX_EVENT_RATE = 5.0  # maximum rate of one event [1/s]
MAX_FLUSH_TIME = 0.5  # time limit to write the last lines at the end [s]
LEVELS = "debug", "info", "warning", "error"  # levels of the log, the mildest first
_waiting: queue.Queue[str] = queue.Queue(1000)


class EventLog:
    """Writes events of at least a level, each with its values and the name of the process."""

    def __init__(
        self, process: str = "", level: str = "info", form: Formatter = format_text
    ) -> None:
        self._process, self._least, self._form = process, LEVELS.index(level), form

    def info(self, event: str, **values: Any) -> None:
        """Log information."""
        self._add("info", event, values)

    def warning(self, event: str, **values: Any) -> None:
        """Log a warning."""
        self._add("warning", event, values)

    def error(self, event: str, **values: Any) -> None:
        """Log an error."""
        self._add("error", event, values)

    def exception(self, event: str, **values: Any) -> None:
        """Log an error with the current exception."""
        self._add("error", event, values, sys.exception())

    def _add(
        self, level: str, event: str, values: dict[str, Any], error: BaseException | None = None
    ) -> None:
        if LEVELS.index(level) >= self._least:
            with contextlib.suppress(RuntimeError):  # no more threads: a later line starts it
                _start_writer()
            line = self._form(level, event, {**values, "process": self._process}, error)
            with contextlib.suppress(queue.Full):
                _waiting.put_nowait(line)


_logs = [EventLog()]  # the current one


def configure(settings: Log, process: str) -> None:
    """Log as the settings say. Each line names the process."""
    terminal = (
        sys.stderr is not None and sys.stderr.isatty()
    )  # None if it was closed before the start
    form = format_coloured_text if terminal else format_text
    _logs[0] = EventLog(process, settings.level, format_json if settings.format == "json" else form)


def log() -> EventLog:
    """Return the log."""
    return _logs[0]


@functools.cache
def _start_writer() -> None:
    """Start the thread that writes, once."""
    threading.Thread(target=_write, name="log", daemon=True).start()
    atexit.register(flush)


def _write() -> None:
    while True:
        line = _waiting.get()
        # Standard error is gone or closed.
        with contextlib.suppress(OSError, ValueError, AttributeError):
            sys.stderr.write(line + "\n")
            sys.stderr.flush()
        _waiting.task_done()


def flush() -> None:
    """Wait until all lines are written, but at most `MAX_FLUSH_TIME`."""
    due = time.monotonic() + MAX_FLUSH_TIME
    while _waiting.unfinished_tasks and time.monotonic() < due:
        time.sleep(0.001)


class RateLimitedLog:
    """A log that no client can flood: it limits the rate of each event, and then logs how many were left out."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock = clock
        self._allowed: dict[str, TokenBucket] = {}
        self._missed: dict[str, int] = {}

    def warning(self, event: str, **values: Any) -> None:
        """Log a warning, unless the event is over its rate."""
        self._add("warning", event, values)

    def info(self, event: str, **values: Any) -> None:
        """Log information, unless the event is over its rate."""
        self._add("info", event, values)

    def exception(self, event: str, **values: Any) -> None:
        """Log an error with the current exception, unless the event is over its rate."""
        self._add("exception", event, values)

    def _add(self, level: str, event: str, values: dict[str, Any]) -> None:
        if not self._allowed.setdefault(event, TokenBucket(MAX_EVENT_RATE)).take(self._clock()):
            self._missed[event] = self._missed.get(event, 0) + 1
            return
        if missed := self._missed.pop(event, 0):
            values["missed"] = missed
        getattr(log(), level)(event, **values)
