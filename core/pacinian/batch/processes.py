"""Other processes that solve parts of a batch, for solvers whose own Python code would keep threads waiting.

A process reads pickled tasks and numbers of problems from its standard input, and writes the solutions as columns.
Pickles go only between this process and the children that it started. Arrays and the medium go once, and solutions
refer to them. A message is a pickle and the buffers of its NumPy arrays, which are sent and received without a copy.

A process takes 0.1 to 0.4 s to start, so it stays for the batches to come, and ends after `IDLE_TIMEOUT` without any.
"""

from __future__ import annotations

import atexit
import contextlib
import io
import os
import pickle
import signal
import subprocess
import sys
import threading
from collections import deque
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from pacinian.batch.columns import from_columns, to_columns
from pacinian.errors import PluginError, describe_error
from pacinian.solving.blas import limit_blas_threads

if sys.platform == "linux":
    import fcntl

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from pacinian.batch.task import Task
    from pacinian.solving.solution import Solution

LENGTH = np.dtype("<i8")  # of the lengths before each message
COMMAND = "from pacinian.batch.processes import serve; serve()"
IDLE_TIMEOUT = 60.0  # time after which a process ends if no batch has come [s]
PIPE_SIZE = 1 << 20  # of answers, by default the largest that Linux allows [bytes]
DIED = "a process that solves a part of a batch has died"
HERE = b"__main__"  # the module that only this process has


def pack_task(task: Task) -> bytes | None:
    """Return the task as bytes; None if another process could not read it, as with functions defined in a script."""
    try:
        packed = pickle.dumps(task)
    except Exception:  # objects of users can raise anything
        return None
    return None if HERE in packed else packed


def _widen(pipe: IO[bytes]) -> None:
    """Make a pipe hold an answer, so that the other process does not wait until a thread here runs and reads it."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError):  # all pipes of a user together have a limit
            fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, PIPE_SIZE)


class WorkerProcess:
    """A process that solves problems of one task at a time. code: by `WaitingProcesses.identify_code`."""

    def __init__(self, code: object) -> None:
        self.code = code
        self.started = threading.Event()
        """Whether it can solve; also set if it has died."""
        self._task: Task | None = None
        self._packed: bytes | None = None
        path = os.pathsep.join(sys.path)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", COMMAND],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": path},
        )  # fmt: skip
        assert self._process.stdin is not None
        assert isinstance(self._process.stdout, io.BufferedReader)
        self._out, self._in = self._process.stdin, self._process.stdout
        _widen(self._in)
        self._greeter = threading.Thread(target=self._await_greeting, daemon=True)
        self._greeter.start()

    def _await_greeting(self) -> None:
        with contextlib.suppress(OSError, EOFError, ValueError):
            _receive(self._in)
        self.started.set()

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process.poll() is None

    def begin(self, task: Task, packed: bytes) -> None:
        """Take a task. packed: its bytes, by `pack_task`."""
        self._task, self._packed = task, packed

    def solve(self, parts: Iterable[Sequence[int]]) -> Iterator[tuple[int, Solution]]:
        """Yield the solutions of the problems with these numbers. Raises what the solver raises, and PluginError.

        parts: of one problem each if they are long, else of several. The process then has the next part already, so
        that it does not wait while this one reads its answer.
        """
        self.started.wait()
        asked: deque[Sequence[int]] = deque()
        for part in parts:
            self._ask(part)
            asked.append(part)
            while len(asked) > (len(part) > 1):
                yield from self._read_answer(asked.popleft())
        while asked:
            yield from self._read_answer(asked.popleft())

    def _ask(self, numbers: Sequence[int]) -> None:
        try:
            _send(self._out, _pack((self._packed, numbers)))
        except OSError:
            raise PluginError(DIED) from None
        self._packed = None

    def _read_answer(self, numbers: Sequence[int]) -> Iterator[tuple[int, Solution]]:
        assert self._task is not None
        try:
            answer = _receive(self._in, [*self._task.arrays, self._task.medium])
        except (OSError, EOFError):
            raise PluginError(DIED) from None
        if isinstance(answer, Exception):
            raise answer
        return zip(numbers, from_columns(answer, len(numbers)), strict=True)

    def close(self) -> None:
        """End the process, even in the middle of a solve."""
        self._process.kill()
        self._greeter.join()
        with contextlib.suppress(OSError):
            self._out.close()
        self._in.close()
        self._process.wait()


class WaitingProcesses:
    """The processes that wait for the next batch."""

    def __init__(self) -> None:
        self._all: list[WorkerProcess] = []
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None
        self._written: dict[str, int] = {}  # times by module [ns]
        self._edits = 0
        self._starts = 0.0  # processes that the batches so far were worth

    def identify_code(self, task: Task) -> object:
        """Return a key that changes when running processes may lack this task's code, or have an old version of it.

        The key holds the module search path, and how often solver modules were edited after their first use.
        """
        module, written = type(task.solver).__module__, 0
        file = getattr(sys.modules.get(module), "__file__", None)
        with contextlib.suppress(OSError):
            written = os.stat(file).st_mtime_ns if file else 0
        with self._lock:
            self._edits += self._written.setdefault(module, written) != written
            self._written[module] = written
            return tuple(sys.path), self._edits

    def count_worthwhile(self, code: object, starts: float) -> int:
        """Return how many processes to use: those that wait and know this code, or those worth starting, if more.

        starts: how many this batch is worth. The batches before count, too, until the processes end.
        """
        with self._lock:
            self._starts += starts
            return max(sum(one.code == code and one.alive for one in self._all), int(self._starts))

    def take(self, code: object, count: int) -> list[WorkerProcess]:
        """Return `count` processes that know this code; starts those that are missing, and ends all others."""
        with self._lock:
            waiting, self._all = self._all, []
        fit = [one for one in waiting if one.code == code and one.alive]
        for one in waiting:
            if one not in fit[:count]:
                one.close()
        return fit[:count] + [WorkerProcess(code) for _ in range(count - len(fit))]

    def keep(self, processes: Sequence[WorkerProcess]) -> None:
        """Keep processes that have no work for the next batch, for `IDLE_TIMEOUT`."""
        with self._lock:
            self._all += processes
            if self._timer is not None:
                self._timer.cancel()
            self._timer = threading.Timer(IDLE_TIMEOUT, self.close)
            self._timer.daemon = True
            self._timer.start()

    def close(self) -> None:
        """End all processes that wait."""
        with self._lock:
            waiting, self._all, self._starts = self._all, [], 0.0
        for one in waiting:
            one.close()

    def forget(self) -> None:
        """Leave them to the process that this one was forked from."""
        self._all, self._lock, self._timer, self._starts = [], threading.Lock(), None, 0.0


waiting = WaitingProcesses()
atexit.register(waiting.close)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=waiting.forget)


def serve() -> None:
    """Solve problems until the standard input ends: what a process of a batch does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that asks
    source, out = os.fdopen(0, "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints is no answer
    _send(out, _pack("started"))
    shared: list[object] = []
    task: Task | None = None
    with limit_blas_threads(), contextlib.suppress(EOFError, OSError):
        while True:
            packed, numbers = _receive(source)
            answer: list[memoryview]
            try:
                if packed is not None:
                    task = pickle.loads(packed)
                    assert task is not None
                    shared = [*task.arrays, task.medium]
                assert task is not None
                answer = _pack(to_columns([one for _, one in task.solve(iter(numbers))]), shared)
            except Exception as error:
                try:
                    answer = _pack(error, shared)
                    _unpack(answer, shared)  # some errors cannot be read
                except Exception:
                    answer = _pack(PluginError(describe_error(error)), shared)
            _send(out, answer)


def _pack(message: object, shared: Sequence[object] = ()) -> list[memoryview]:
    """Pickle a message, in which the task's own objects are only named. Returns the buffers of its arrays, too."""
    names = {id(one): k for k, one in enumerate(shared)}
    pickled = io.BytesIO()
    buffers: list[pickle.PickleBuffer] = []
    pickler = pickle.Pickler(pickled, protocol=5, buffer_callback=buffers.append)
    pickler.persistent_id = lambda one: names.get(id(one))  # type: ignore[method-assign]
    pickler.dump(message)
    return [pickled.getbuffer(), *(buffer.raw() for buffer in buffers)]


def _unpack(parts: Sequence[memoryview], shared: Sequence[object]) -> Any:
    """Return the message of `_pack`."""
    reader = pickle.Unpickler(io.BytesIO(parts[0]), buffers=parts[1:])
    reader.persistent_load = lambda name: shared[name]  # type: ignore[method-assign]
    return reader.load()


def _send(to: IO[bytes], parts: Sequence[memoryview]) -> None:
    """Write how many parts there are, the length of each, and the parts."""
    sizes = np.array([len(parts), *(part.nbytes for part in parts)], LENGTH)
    to.write(sizes.tobytes())
    for part in parts:
        to.write(part)
    to.flush()


def _receive(source: io.BufferedReader, shared: Sequence[object] = ()) -> Any:
    """Read the message of `_pack`. Raises EOFError if the other process has ended."""
    (count,) = np.frombuffer(_read(source, LENGTH.itemsize), LENGTH)
    sizes = np.frombuffer(_read(source, count * LENGTH.itemsize), LENGTH)
    return _unpack([_read(source, size) for size in sizes], shared)


def _read(source: io.BufferedReader, size: int) -> memoryview:
    """Read exactly `size` bytes. Raises EOFError."""
    buffer = np.empty(size, np.uint8)
    if source.readinto(buffer.data) < size:
        raise EOFError
    return buffer.data
