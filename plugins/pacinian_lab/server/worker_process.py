"""A process of the benchmark's own, so that measuring does not delay what is measured. It speaks JSON lines."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any, TypeVar, cast

import msgspec

from pacinian.errors import PacinianError

if TYPE_CHECKING:
    from types import TracebackType
    from typing import IO, Self

    from msgspec import Struct

T = TypeVar("T")

MAX_WAIT = 60.0  # [s] for an answer


class WorkerError(PacinianError):
    """A process of the benchmark's that crashed or hung."""


class WorkerProcess:
    """Runs `python -m pacinian_lab.server.<module>`. Ends it as a context manager."""

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
        """The next answer. Raises WorkerError if it has ended, or after `limit` seconds."""
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
            raise WorkerError(f"{self.module}: said nothing for {limit:g} s") from None
        if not line:
            raise WorkerError(f"{self.module}: has ended, see above")
        return msgspec.json.decode(line, type=kind)

    def close(self) -> None:
        """End it at once."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                stream.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def read_order(kind: Any) -> Any:
    """In the process: its next order; None when its parent has ended."""
    line = sys.stdin.buffer.readline()
    return msgspec.json.decode(line, type=kind) if line else None


def queue_orders(kind: Any) -> queue.SimpleQueue[Any]:
    """In the process: a queue of its orders as they come, then None; for a process that also does other work."""
    made = queue.SimpleQueue[Any]()

    def read() -> None:
        while (message := read_order(kind)) is not None:
            made.put(message)
        made.put(None)

    threading.Thread(target=read, daemon=True).start()
    return made


def read_task(kind: type[T]) -> T:
    """In the process: its task. Ends the process when its parent has ended."""
    message = read_order(kind)
    if message is None:
        raise SystemExit(0)
    return cast("T", message)


def answer(message: Struct) -> None:
    """In the process: tell the parent."""
    sys.stdout.buffer.write(msgspec.json.encode(message) + b"\n")
    sys.stdout.buffer.flush()
