"""A separate process for the benchmark, so that measuring does not delay the server. Its messages are JSON lines."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any, TypeVar, cast

import msgspec

from pacinian.closeable import Closeable
from pacinian_lab.solvers.worker_process import WorkerError

if TYPE_CHECKING:
    from typing import IO

    from msgspec import Struct

T = TypeVar("T")

MAX_WAIT = 60.0  # [s] longest wait for an answer


class WorkerProcess(Closeable):
    """Runs `python -m pacinian_lab.server.<module>`. As a context manager, ends the process on exit."""

    def __init__(self, module: str) -> None:
        self.module = module
        self.process = subprocess.Popen(
            [sys.executable, "-m", f"{__package__}.{module}"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=os.name
            == "posix",  # as any program: Linux shares time out by session
        )
        self._lines = queue.SimpleQueue[bytes]()
        threading.Thread(target=self._pump, args=(self.process.stdout,), daemon=True).start()

    def _pump(self, stream: IO[bytes]) -> None:
        for line in stream:
            self._lines.put(line)
        self._lines.put(b"")

    def send(self, message: Struct) -> None:
        """Send a message. Raises WorkerError."""
        stream = self.process.stdin
        assert stream is not None
        try:
            stream.write(msgspec.json.encode(message) + b"\n")
            stream.flush()
        except OSError as error:
            raise WorkerError(f"{self.module}: has ended") from error

    def receive(self, kind: type[T], limit: float = MAX_WAIT) -> T:
        """Return the next answer. Raises WorkerError if the process has ended, or after `limit` seconds."""
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
            raise WorkerError(f"{self.module}: said nothing for {limit:g} s") from None
        if not line:
            raise WorkerError(f"{self.module}: has ended, see above")
        return msgspec.json.decode(line, type=kind)

    def close(self) -> None:
        """Kill the process."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                stream.close()


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
