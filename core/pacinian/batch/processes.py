"""Other processes that solve parts of a batch, for solvers whose own Python code would keep threads waiting.

A process reads a pickled task from its standard input, then numbers of problems, and writes their solutions as columns.
Pickles go only between this process and the children that it started. Arrays and the medium go once, and solutions
refer to them.
"""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import subprocess
import sys
from typing import IO, TYPE_CHECKING, Any

from pacinian.batch.columns import from_columns, to_columns
from pacinian.errors import PluginError, describe_error
from pacinian.solving.blas import limit_blas_threads

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.batch.task import Task
    from pacinian.solving.solution import Solution

LENGTH_BYTES = 8  # bytes of the length before each pickle
COMMAND = "from pacinian.batch.processes import serve; serve()"
HERE = b"__main__"  # the module that only this process has


def pack_task(task: Task) -> bytes | None:
    """Return the task as bytes; None if another process could not read it, as with functions defined in a script."""
    try:
        packed = pickle.dumps(task)
    except Exception:  # objects of users can raise anything
        return None
    return None if HERE in packed else packed


class WorkerProcess:
    """A process that solves problems of one task. task: and its bytes, by `pack_task`."""

    def __init__(self, task: Task, packed: bytes) -> None:
        self._shared = [*task.arrays, task.medium]
        path = os.pathsep.join(sys.path)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", COMMAND],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": path},
        )  # fmt: skip
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._out, self._in = self._process.stdin, self._process.stdout
        self._packed = packed

    def solve(self, numbers: Sequence[int]) -> list[tuple[int, Solution]]:
        """Return the solutions of the problems with these numbers. Raises what the solver raises, and PluginError."""
        try:
            if self._packed:
                _send(self._out, self._packed)
                self._packed = b""
            _send(self._out, pickle.dumps(numbers))
            answer = _unpack(_receive(self._in), self._shared)
        except (OSError, EOFError):
            raise PluginError("a process that solves a part of a batch has died") from None
        if isinstance(answer, Exception):
            raise answer
        return list(zip(numbers, from_columns(answer, len(numbers)), strict=True))

    def close(self) -> None:
        """End the process, even in the middle of a solve."""
        self._process.kill()
        with contextlib.suppress(OSError):
            self._out.close()
        self._in.close()
        self._process.wait()


def serve() -> None:
    """Solve problems until the standard input ends: what a process of a batch does."""
    source, out = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints is no answer
    task: Task = pickle.loads(_receive(source))
    shared = [*task.arrays, task.medium]
    with limit_blas_threads(), contextlib.suppress(EOFError, KeyboardInterrupt):
        while True:
            numbers: Sequence[int] = pickle.loads(_receive(source))
            answer: Any
            try:
                answer = _pack(to_columns([one for _, one in task.solve(iter(numbers))]), shared)
            except Exception as error:
                try:
                    answer = _pack(error, shared)
                    pickle.loads(answer)  # some errors cannot be read
                except Exception:
                    answer = _pack(PluginError(describe_error(error)), shared)
            _send(out, answer)


def _pack(answer: object, shared: Sequence[object]) -> bytes:
    """Pickle an answer, in which the task's own objects are only named."""
    names = {id(one): k for k, one in enumerate(shared)}
    buffer = io.BytesIO()
    pickler = pickle.Pickler(buffer, protocol=5)
    pickler.persistent_id = lambda one: names.get(id(one))  # type: ignore[method-assign]
    pickler.dump(answer)
    return buffer.getvalue()


def _unpack(packed: bytes, shared: Sequence[object]) -> Any:
    reader = pickle.Unpickler(io.BytesIO(packed))
    reader.persistent_load = lambda name: shared[name]  # type: ignore[method-assign]
    return reader.load()


def _send(to: IO[bytes], packed: bytes) -> None:
    to.write(len(packed).to_bytes(LENGTH_BYTES, "little"))
    to.write(packed)
    to.flush()


def _receive(source: IO[bytes]) -> bytes:
    head = source.read(LENGTH_BYTES)
    packed = source.read(int.from_bytes(head, "little"))
    if not packed:
        raise EOFError
    return packed
