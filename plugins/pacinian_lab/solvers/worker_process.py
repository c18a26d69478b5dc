"""Workers: the process of one project's solvers is asked with a time limit, killed if it hangs, and restarted."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import subprocess
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.closeable import Closeable
from pacinian.errors import PacinianError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.types import Complexes, Floats

START = 300.0  # [s] to start, including compilation by the peers
THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "RAYON_NUM_THREADS",
)
HERE = Path(__file__).parent
WORKERS = HERE / "workers"


class WorkerError(PacinianError):
    """A worker crashed, hung, or gave an invalid answer."""


class JsonLineProcess(Closeable):
    """A process that reads and writes JSON lines. As a context manager, ends the process on exit.

    options: of `subprocess.Popen`. Raises OSError if the process cannot be started.
    """

    def __init__(self, command: Sequence[str], **options: Any) -> None:
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, **options)
        self._lines = queue.SimpleQueue[bytes]()
        threading.Thread(target=self._pump, daemon=True).start()

    def _pump(self) -> None:
        """Put the lines of the process's output into the queue, and an empty line at the end."""
        with contextlib.suppress(OSError, ValueError):  # closed while reading
            for line in self.process.stdout or ():
                self._lines.put(line)
        self._lines.put(b"")

    def write_line(self, line: bytes) -> None:
        """Write a line. Raises OSError if the process has ended."""
        stream = self.process.stdin
        assert stream is not None
        stream.write(line + b"\n")
        stream.flush()

    def read_line(self, limit: float) -> bytes:
        """Return the next line, or an empty one if the process has ended. Raises TimeoutError after `limit` seconds."""
        try:
            return self._lines.get(timeout=limit)
        except queue.Empty:
            raise TimeoutError(f"no line within {limit:g} s") from None

    def close(self) -> None:
        """Kill the process."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()


class Worker:
    """A process that answers each JSON line with one JSON line.

    name: "pacinian" or a peer. command: what to run. threads: maximum for its libraries. The process starts when it is
    first needed, and again after a failure ended it.
    """

    def __init__(self, name: str, command: Sequence[str], threads: int) -> None:
        self.name, self.command, self.threads = name, list(command), threads
        self.versions: dict[str, str] = {}
        self._process: JsonLineProcess | None = None
        self._offers: list[tuple[str, str]] = []

    @classmethod
    def of(cls, name: str, python: str, threads: int, folder: Path = WORKERS) -> Worker:
        """Return a worker for the solvers in `{name}.py` of a folder, run by this Python."""
        files = (HERE / "worker.py", folder / f"{name}.py")
        return cls(name, [python, "-P", *(str(file) for file in files)], threads)

    def offers(self) -> list[tuple[str, str]]:
        """Return the (solver, mode) pairs of its solvers. Raises WorkerError."""
        if self._process is None:
            self._start()
        return self._offers

    def ask(self, message: dict[str, Any], limit: float) -> dict[str, Any]:
        """Send a message and return the answer. Raises WorkerError, also after `limit` seconds."""
        self.offers()
        process = self._process
        if process is None:
            raise WorkerError("is not running")
        with contextlib.suppress(OSError):  # the process has ended; reading reports how
            process.write_line(json.dumps(message).encode())
        reply = self._read(process, limit)
        if "error" in reply:
            raise WorkerError(f"failed: {reply['error']}")
        return reply

    def close(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is not None:
            process.close()
            self._errors.close()

    def _start(self) -> None:
        environment = {
            **os.environ,
            **dict.fromkeys(THREADS, str(self.threads)),
            "CUDA_VISIBLE_DEVICES": "",
            "PYTHONWARNINGS": "ignore",
        }
        self._errors = tempfile.TemporaryFile(mode="w+", errors="replace")  # noqa: SIM115
        try:
            process = JsonLineProcess(self.command, stderr=self._errors, env=environment)
        except OSError as error:
            self._errors.close()
            raise WorkerError(f"cannot be started: {error}") from error
        self._process = process
        reply = self._read(process, START)
        try:
            self._offers = [(str(solver), str(mode)) for solver, mode in reply["offers"]]
            self.versions = dict(reply["versions"])
        except (KeyError, TypeError, ValueError) as error:
            self.close()
            raise WorkerError(f"does not say what it offers: {error!r}") from error

    def _read(self, process: JsonLineProcess, limit: float) -> dict[str, Any]:
        try:
            line = process.read_line(limit)
        except TimeoutError:
            self.close()
            raise WorkerError(f"timed out after {limit:g} s") from None
        if not line:
            said = self._last_words()
            self.close()
            raise WorkerError(f"crashed: {said}")
        try:
            return dict(json.loads(line))
        except (ValueError, TypeError) as error:
            self.close()
            raise WorkerError(f"gave an invalid answer: {error}") from None

    def _last_words(self) -> str:
        self._errors.seek(0)
        lines = self._errors.read().strip().splitlines()
        return lines[-1] if lines else "without a message"


def read_gains(reply: dict[str, Any], shape: tuple[int, ...]) -> Complexes:
    """Return the gains of an answer. Raises WorkerError unless they are finite and have this shape."""
    try:
        gains = np.array(reply["re"], np.float64) + 1j * np.array(reply["im"], np.float64)
    except (KeyError, TypeError, ValueError) as error:
        raise WorkerError(f"gave an invalid answer: {error!r}") from error
    check_array("gains", gains, shape)
    return gains


def check_array(name: str, array: Complexes | Floats, shape: tuple[int, ...]) -> None:
    """Refuse an array of an answer that is not finite, or of another shape. Raises WorkerError."""
    if array.shape != shape:
        raise WorkerError(f"returned {name} of shape {array.shape}, not {shape}")
    if not np.isfinite(array).all():
        raise WorkerError(f"returned {name} that are not finite")
