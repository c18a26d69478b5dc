"""What the server's processes log, to standard error: for people, or one JSON object a line.

A thread writes it: where nobody reads standard error, or it is closed, lines are lost, and nothing else.
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

OFTEN = 5.0  # times a second that one event is logged
MAX_FLUSH_TIME = 0.5  # [s] for the last lines at the end
LINKS, CALLS = 4, 20  # exceptions of a chain, and calls to each, that are logged
THREAD = "log"
_waiting: queue.Queue[str] = queue.Queue(1000)


def configure(settings: Log, process: str) -> None:
    """Log as the settings say; each line names the process."""
    if not any(thread.name == THREAD for thread in threading.enumerate()):
        threading.Thread(target=_write, name=THREAD, daemon=True).start()
        atexit.register(flush)

    def named(_log: object, _method: str, event: Any) -> Any:
        event["process"] = process
        return event

    def printable(_log: object, _method: str, event: Any) -> Any:
        for name, value in event.items():
            if isinstance(value, str):  # a client's name, say
                event[name] = "".join(c if c.isprintable() else "?" for c in shorten(value))
        return event

    last: Processor = structlog.processors.JSONRenderer()
    if settings.format != "json":
        formatter = structlog.dev.plain_traceback  # the usual one warns of texts that are made
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
    """The last calls to an exception, and to those that it came of; no local variables, which may be secret."""
    error: BaseException | None = exc_info[1]
    links: list[str] = []
    while error is not None and len(links) < LINKS:
        calls = traceback.format_tb(error.__traceback__, -CALLS)
        links.append("".join([*calls, describe_error(error)]))
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)
    return "\n".join(reversed(links))


class _Lines:
    """What structlog calls with a line."""

    def __init__(self, *_: object) -> None:
        pass

    def msg(self, line: str) -> None:
        with contextlib.suppress(queue.Full):
            _waiting.put_nowait(line)

    debug = info = warning = error = exception = critical = msg


def _write() -> None:
    while True:
        line = _waiting.get()
        with contextlib.suppress(OSError, ValueError, AttributeError):  # gone, or closed
            sys.stderr.write(line + "\n")
            sys.stderr.flush()
        _waiting.task_done()


def flush() -> None:
    """Wait until all is written, but not for long."""
    due = time.monotonic() + MAX_FLUSH_TIME
    while _waiting.unfinished_tasks and time.monotonic() < due:
        time.sleep(0.001)


def log() -> FilteringBoundLogger:
    """The log."""
    return cast("FilteringBoundLogger", structlog.get_logger())


class RateLimitedLog:
    """A log that no client can flood: of each event so many a second, then how many there were besides."""

    def __init__(
        self, clock: Callable[[], float] = time.perf_counter, often: float = OFTEN
    ) -> None:
        self._clock, self._often = clock, often
        self._allowed: dict[str, TokenBucket] = {}
        self._missed: dict[str, int] = {}

    def warning(self, event: str, **values: Any) -> None:
        """Log a warning, unless there were too many of this event lately."""
        self._add("warning", event, values)

    def info(self, event: str, **values: Any) -> None:
        """Log what is worth knowing."""
        self._add("info", event, values)

    def exception(self, event: str, **values: Any) -> None:
        """Log an error, with the exception that is handled."""
        self._add("exception", event, values)

    def _add(self, level: str, event: str, values: dict[str, Any]) -> None:
        if not self._allowed.setdefault(event, TokenBucket(self._often)).take(self._clock()):
            self._missed[event] = self._missed.get(event, 0) + 1
            return
        if missed := self._missed.pop(event, 0):
            values["missed"] = missed
        getattr(log(), level)(event, **values)
