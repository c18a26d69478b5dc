"""Logging of the server's processes to standard error: readable text, or one JSON object a line.

A thread writes the lines. If standard error is not read, or is closed, lines are lost and nothing else fails.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import queue
import sys
import threading
import time
import traceback
from typing import TYPE_CHECKING, Any, cast

import structlog

from pacinian.errors import describe_error, shorten
from pacinian.serving.ipc.clocks import TokenBucket

if TYPE_CHECKING:
    from collections.abc import Callable

    from structlog.typing import ExcInfo, FilteringBoundLogger, Processor

    from pacinian.serving.settings import Log

OFTEN = 5.0  # maximum rate of one event [1/s]
MAX_FLUSH_TIME = 0.5  # time limit to write the last lines at the end [s]
LINKS, CALLS = 4, 20  # logged exceptions of a chain, and calls of each
THREAD = "log"
_waiting: queue.Queue[str] = queue.Queue(1000)


def configure(settings: Log, process: str) -> None:
    """Log as the settings say. Each line names the process."""
    if not any(thread.name == THREAD for thread in threading.enumerate()):
        threading.Thread(target=_write, name=THREAD, daemon=True).start()
        atexit.register(flush)

    def named(_log: object, _method: str, event: Any) -> Any:
        event["process"] = process
        return event

    def printable(_log: object, _method: str, event: Any) -> Any:
        for name, value in event.items():
            if isinstance(value, str):  # for example, a client's name
                event[name] = "".join(c if c.isprintable() else "?" for c in shorten(value))
        return event

    last: Processor = structlog.processors.JSONRenderer()
    if settings.format != "json":
        formatter = structlog.dev.plain_traceback  # the default one warns of rendered text
        last = structlog.dev.ConsoleRenderer(
            colors=sys.stderr.isatty(), exception_formatter=formatter
        )
    structlog.configure(
        processors=[
            named,
            printable,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            structlog.processors.ExceptionRenderer(_trace),
            last,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(
            logging.getLevelNamesMapping()[settings.level.upper()]
        ),
        logger_factory=_Lines,
        cache_logger_on_first_use=False,
    )


def _trace(exc_info: ExcInfo) -> str:
    """Return the last calls of an exception and its causes.

    Local variables are left out, because they may be secret.
    """
    error: BaseException | None = exc_info[1]
    links: list[str] = []
    while error is not None and len(links) < LINKS:
        calls = traceback.format_tb(error.__traceback__, -CALLS)
        links.append("".join([*calls, describe_error(error)]))
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)
    return "\n".join(reversed(links))


class _Lines:
    """The logger that structlog calls with each line."""

    def __init__(self, *_: object) -> None:
        pass

    def msg(self, line: str) -> None:
        with contextlib.suppress(queue.Full):
            _waiting.put_nowait(line)

    debug = info = warning = error = exception = critical = msg


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


def log() -> FilteringBoundLogger:
    """Return the log."""
    return cast("FilteringBoundLogger", structlog.get_logger())


class RateLimitedLog:
    """A log that no client can flood: it limits the rate of each event, and then logs how many were left out."""

    def __init__(
        self, clock: Callable[[], float] = time.perf_counter, often: float = OFTEN
    ) -> None:
        self._clock, self._often = clock, often
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
        if not self._allowed.setdefault(event, TokenBucket(self._often)).take(self._clock()):
            self._missed[event] = self._missed.get(event, 0) + 1
            return
        if missed := self._missed.pop(event, 0):
            values["missed"] = missed
        getattr(log(), level)(event, **values)
