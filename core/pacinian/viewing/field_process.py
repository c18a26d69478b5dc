"""A separate process of low priority, which calls functions one after another."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from pacinian.errors import ArgumentError, describe_error
from pacinian.serving.ipc.scheduling import AUTOGROUP

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection


class ProcessEnded(Exception):
    """The process has ended before it answered."""


class FieldProcess:
    """A process that calls functions. It ends with this one.

    nice: its niceness. A pool of `concurrent.futures` would wait for ever for the rest of an answer if its process is
    killed while it writes: there, this process keeps the writing end of the pipe open.
    """

    def __init__(self, nice: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, nice), daemon=True)
        self._process.start()
        theirs.close()  # so that the pipe ends with the process

    def call(self, work: Callable[..., bytes], *arguments: Any) -> bytes:
        """Call a function in the process. Only one thread may use this.

        Raises ArgumentError if the function raises an exception, ProcessEnded.
        """
        try:
            self._pipe.send((work, arguments))
            answer = self._pipe.recv()
        except (EOFError, OSError) as error:
            raise ProcessEnded from error
        if isinstance(answer, str):
            raise ArgumentError("slice", f"cannot be computed: {answer}")
        return bytes(answer)

    def kill(self) -> None:
        """Kill the process. A call that waits for it then raises ProcessEnded."""
        self._process.kill()


def serve(pipe: Connection, nice: int) -> None:
    """Call functions until the pipe ends: what the process does."""
    _import_fields()
    _lower_own_priority(nice)
    with suppress(EOFError, OSError):
        while True:
            work, arguments = pipe.recv()
            try:
                answer = work(*arguments)
            except Exception as error:
                answer = describe_error(error)
            pipe.send(answer)


def _import_fields() -> None:
    """Import what fields need before the priority is low: on a busy machine, imports would else take a minute."""
    from pacinian.acoustics import propagation
    from pacinian.solving import propagator
    from pacinian.viewing import region_error

    del propagation, propagator, region_error


def _lower_own_priority(nice: int) -> None:
    """Lower the priority of this process, and end it with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles Ctrl-C
    if sys.platform != "win32":
        with suppress(OSError):
            os.setsid()
        os.nice(nice)
    if sys.platform == "linux":
        with suppress(OSError):
            AUTOGROUP.write_text(str(nice))
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    if (parent := multiprocessing.parent_process()) is not None:
        parent.join()
        os._exit(0)
