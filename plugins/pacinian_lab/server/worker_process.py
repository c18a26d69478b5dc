"""A separate process for the benchmark, so that measuring does not delay the server. Its messages are JSON lines."""

from __future__ import annotations

import os
import queue
import sys
import threading
from typing import TYPE_CHECKING, Any, TypeVar, cast

import msgspec

from pacinian_lab.solvers.worker_process import JsonLineProcess, WorkerError

if TYPE_CHECKING:
    from msgspec import Struct

T = TypeVar("T")

MAX_WAIT = 60.0  # [s] longest wait for an answer


class WorkerProcess(JsonLineProcess):
    """Runs `python -m pacinian_lab.server.<module>`. As a context manager, ends the process on exit."""

    def __init__(self, module: str) -> None:
        self.module = module
        # a session of its own, as any program: Linux shares time out by session
        own_session = os.name == "posix"
        command = [sys.executable, "-m", f"{__package__}.{module}"]
        super().__init__(command, start_new_session=own_session)

    def send(self, message: Struct) -> None:
        """Send a message. Raises WorkerError."""
        try:
            self.write_line(msgspec.json.encode(message))
        except OSError as error:
            raise WorkerError(f"{self.module}: has ended") from error

    def receive(self, kind: type[T], limit: float = MAX_WAIT) -> T:
        """Return the next answer. Raises WorkerError if the process has ended, or after `limit` seconds."""
        try:
            line = self.read_line(limit)
        except TimeoutError:
            raise WorkerError(f"{self.module}: said nothing for {limit:g} s") from None
        if not line:
            raise WorkerError(f"{self.module}: has ended, see above")
        return msgspec.json.decode(line, type=kind)


def read_order(kind: Any) -> Any:
    """In the process: return the next order, or None when the parent has ended."""
    line = sys.stdin.buffer.readline()
    return msgspec.json.decode(line, type=kind) if line else None


def queue_orders(kind: Any) -> queue.SimpleQueue[Any]:
    """In the process: return a queue of the orders, then None. For a process that also does other work."""
    made = queue.SimpleQueue[Any]()

    def read() -> None:
        while (message := read_order(kind)) is not None:
            made.put(message)
        made.put(None)

    threading.Thread(target=read, daemon=True).start()
    return made


def read_task(kind: type[T]) -> T:
    """In the process: return the task. Ends the process if the parent has ended."""
    message = read_order(kind)
    if message is None:
        raise SystemExit(0)
    return cast("T", message)


def answer(message: Struct) -> None:
    """In the process: send an answer to the parent."""
    sys.stdout.buffer.write(msgspec.json.encode(message) + b"\n")
    sys.stdout.buffer.flush()
