"""Ctrl-C, and the signals that end a command like Ctrl-C, so that a run ends in silence."""

from __future__ import annotations

import _thread
import contextlib
import math
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType

CHECK_PERIOD = 0.01  # time between two checks whether an import has ended [s]
MAX_DEFERRAL = 2.0  # longest wait of an interrupt for the end of an import [s]


def catch_signals() -> None:
    """Handle SIGTERM and the end of the terminal like Ctrl-C."""
    signal.signal(signal.SIGTERM, interrupt)
    if sys.platform == "win32":  # sent when the console is closed
        signal.signal(signal.SIGBREAK, interrupt)
    elif signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # which nohup sets
        signal.signal(signal.SIGHUP, interrupt)


class DeferredInterrupt:
    """A signal handler that raises KeyboardInterrupt; during an import, only at its end, or after `MAX_DEFERRAL`.

    An import can lose a KeyboardInterrupt, or turn it into an ImportError: in C code, and in callbacks.
    """

    def __init__(self) -> None:
        # when a deferred interrupt is raised at the latest [s]; infinite if there is none
        self._due = math.inf

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Raise KeyboardInterrupt, or defer it. number: of the signal. frame: what the main thread runs now."""
        now = time.monotonic()
        if _is_importing(frame) and now < self._due:
            if self._due < math.inf:
                return
            with contextlib.suppress(RuntimeError):  # no more threads
                self._due = now + MAX_DEFERRAL
                _thread.start_new_thread(self._repeat, (number,))
                return
        self._due = math.inf
        raise KeyboardInterrupt

    def raise_deferred(self) -> None:
        """Raise KeyboardInterrupt now if one is deferred."""
        if self._due < math.inf:
            self._due = math.inf
            raise KeyboardInterrupt

    def _repeat(self, number: int) -> None:
        """Send the signal to the main thread until this has raised KeyboardInterrupt, or once to a later handler."""
        ours = True
        while ours and self._due < math.inf:
            time.sleep(CHECK_PERIOD)
            ours = signal.getsignal(number) is self
            if sys.platform == "win32":
                signal.raise_signal(number)
            else:  # which also ends a wait of the main thread
                signal.pthread_kill(threading.main_thread().ident or 0, number)


def _is_importing(frame: FrameType | None) -> bool:
    """Return whether an import has called the code of `frame`."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


interrupt = DeferredInterrupt()
"""The handler of Ctrl-C, SIGTERM and the end of the terminal."""
