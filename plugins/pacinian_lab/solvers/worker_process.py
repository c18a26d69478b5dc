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


class Worker:
    """A process that answers each JSON line with one JSON line.

    name: "pacinian" or a peer. command: what to run. threads: maximum for its libraries. The process starts when it is
    first needed, and again after a failure ended it.
    """

    def __init__(self, name: str, command: Sequence[str], threads: int) -> None:
        self.name, self.command, self.threads = name, list(command), threads
        self.versions: dict[str, str] = {}
        self._process: subprocess.Popen[str] | None = None
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
        if process is None or process.stdin is None:
            raise WorkerError("is not running")
        try:
            process.stdin.write(json.dumps(message) + "\n")
            process.stdin.flush()
        except OSError:  # the process has ended; reading reports how
            pass
        reply = self._read(limit)
        if "error" in reply:
            raise WorkerError(f"failed: {reply['error']}")
        return reply

    def close(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()
        self._errors.close()

    def _start(self) -> None:
        environment = {
            **os.environ,
            **dict.fromkeys(THREADS, str(self.threads)),
            "CUDA_VISIBLE_DEVICES": "",
            "PYTHONWARNINGS": "ignore",
        }
        self._errors = tempfile.TemporaryFile(mode="w+", errors="replace")  # noqa: SIM115
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        try:
            self._process = subprocess.Popen(
                self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors,
                text=True, encoding="utf-8", env=environment,
            )  # fmt: skip
        except OSError as error:
            self._errors.close()
            raise WorkerError(f"cannot be started: {error}") from error
        threading.Thread(target=_pump, args=(self._process, self._lines), daemon=True).start()
        reply = self._read(START)
        try:
            self._offers = [(str(solver), str(mode)) for solver, mode in reply["offers"]]
            self.versions = dict(reply["versions"])
        except (KeyError, TypeError, ValueError) as error:
            self.close()
            raise WorkerError(f"does not say what it offers: {error!r}") from error

    def _read(self, limit: float) -> dict[str, Any]:
        try:
            line = self._lines.get(timeout=limit)
        except queue.Empty:
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


def _pump(process: subprocess.Popen[str], lines: queue.SimpleQueue[str]) -> None:
    """Put the lines of the process's output into the queue, and an empty line at the end."""
    with contextlib.suppress(OSError, ValueError):
        for line in process.stdout or ():
            lines.put(line)
    lines.put("")
