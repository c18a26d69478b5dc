"""Child processes: the parent configures a child through its standard input. When that closes, the child ends."""

from __future__ import annotations

import contextlib
import ctypes
import functools
import gc
import importlib
import os
import select
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
from msgspec import Struct

from pacinian.closeable import Closeable
from pacinian.errors import ServerError
from pacinian.serving.ipc import scheduling
from pacinian.serving.ipc.child_pipe import ChildPipe
from pacinian.serving.ipc.spawned_process import fork_process, start_process
from pacinian.serving.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from pacinian.serving.ipc.child_pipe import ChildPipes
    from pacinian.serving.ipc.spawned_process import SystemProcess

MAX_CONFIG_BYTES = 1 << 20  # largest launch configuration [bytes]
MAX_KILL_TIME = 3.0  # time limit for a process to end after it was killed [s]
PDEATHSIG = 1  # number of PR_SET_PDEATHSIG, an option of Linux's prctl
# Byte that tells a spare to begin.
ACTIVATE = b"!"


class LaunchConfig(Struct, frozen=True):
    """The launch configuration of a child. folder: of the shared memory. secrets: names to values, only for the bus.

    spare: for a spare, the id of the process whose end it waits for; otherwise 0.
    """

    folder: str
    settings: Settings
    secrets: dict[str, str] = {}
    spare: int = 0

    def __repr__(self) -> str:  # never show the secrets
        return f"LaunchConfig({self.folder!r})"

    @property
    def path(self) -> Path:
        """The folder."""
        return Path(self.folder)


class Process:
    """A running child. Its standard input stays open; closing it ends the child."""

    def __init__(self, system: SystemProcess, pipe: ChildPipe) -> None:
        self._system, self._pipe = system, pipe
        pipe.child = system

    @property
    def pid(self) -> int:
        """Process id."""
        return self._system.pid

    def poll(self) -> int | None:
        """Return the exit code; None while the process runs."""
        return self._system.poll()

    def tell(self, data: bytes) -> None:
        """Write to the child's standard input, after all earlier data. Raises RuntimeError as `ChildPipe.tell`."""
        self._pipe.tell(data)

    def activate(self) -> None:
        """Let a spare begin. One that cannot receive this is a spare that hangs."""
        with contextlib.suppress(RuntimeError):
            self.tell(ACTIVATE)

    def close(self) -> None:
        """Close the child's standard input, which ends the child. No other child can use that pipe then."""
        self._pipe.close()

    def kill(self) -> None:
        """Kill the process."""
        self._system.kill()

    def wait(self, timeout: float | None = None) -> int:
        """Wait until the process has ended; return its exit code. Raises subprocess.TimeoutExpired."""
        return self._system.wait(timeout)


def start(module: str, config: LaunchConfig, pipe: ChildPipe | None = None) -> Process:
    """Start `python -m pacinian.serving.<module>.process`.

    Call this from a thread that lives as long as the child: on Linux, the child is killed when that thread ends.
    """
    return launch(_name_command(module), config, pipe)


def launch(command: Sequence[str], config: LaunchConfig, pipe: ChildPipe | None = None) -> Process:
    """Start a child by any command that calls `read_launch_config`. pipe: its standard input; None makes one.

    Raises ServerError if the configuration is too long or cannot be sent; OSError if the child cannot be started.
    """
    data = _encode(config)
    own = ChildPipe() if pipe is None else pipe
    process = Process(start_process(command, own.source), own)
    try:
        _configure(process, data)
    except ServerError:
        if pipe is None:
            process.close()
        raise
    return process


class ForkedChildren(Closeable):
    """Children that are forked from this process, and wait for their configuration.

    They share this process's memory and have its imports, so a server starts sooner and takes less memory
    (decision 85). `fork_process` says what must hold. A context manager: leaving it ends the children that still wait.
    modules: as for `start`. The first child of each imports it at once, the others when they are started. Only Linux
    has such children; elsewhere, and where the system permits no more, there are none.
    """

    def __init__(self, modules: Iterable[str], pipes: ChildPipes) -> None:
        self._waiting: list[tuple[str, Process]] = []
        given = tuple(modules) if sys.platform == "linux" else ()
        if given:
            gc.collect()
            gc.freeze()  # otherwise a collection would write to all pages, so that none is shared
        try:
            for module in given:
                pipe = pipes.take()
                later = any(module == name for name, _ in self._waiting)
                run = functools.partial(
                    _run_module, f"pacinian.serving.{module}.process", later=later
                )
                system = fork_process(run, _name_command(module), pipe.source)
                self._waiting.append((module, Process(system, pipe)))
        except OSError:  # the others are spawned, or fail then
            pass
        except BaseException:
            self.close()
            raise

    def start(self, module: str, config: LaunchConfig) -> Process | None:
        """Configure a child that waits; return it. None if no child with this module waits. Raises ServerError."""
        for i, (name, process) in enumerate(self._waiting):
            if name == module and process.poll() is None:
                data = _encode(config)
                del self._waiting[i]
                _configure(process, data)
                return process
        return None

    def close(self) -> None:
        """End the children that still wait."""
        for _, process in self._waiting:
            process.kill()
        for _, process in self._waiting:
            with contextlib.suppress(subprocess.TimeoutExpired):  # the system does not let it end
                process.wait(MAX_KILL_TIME)


def _name_command(module: str) -> list[str]:
    return [sys.executable, "-m", f"pacinian.serving.{module}.process"]


def _run_module(name: str, *, later: bool) -> None:
    """Run a process's module as soon as its configuration arrives; end at once when the parent has gone.

    later: whether to import the module only then.
    """
    _kill_when_orphaned(True)
    scheduling.ask_for_precise_timers()
    if not later:
        importlib.import_module(name)
    select.select([0], [], [])
    if _count_waiting(0):
        importlib.import_module(name).main()


def _count_waiting(file: int) -> int:
    """Return the number of bytes that wait to be read from a pipe: 0 at its end."""
    import fcntl
    import termios

    count = bytearray(4)
    fcntl.ioctl(file, termios.FIONREAD, count)
    return int.from_bytes(count, sys.byteorder)


def _encode(config: LaunchConfig) -> bytes:
    """Return the configuration as bytes. Raises ServerError."""
    try:
        data = msgspec.json.encode(config)
    except UnicodeEncodeError as error:
        raise ServerError(
            f"the path {error.object!r} in the settings is not Unicode: rename that file or folder"
        ) from None
    if len(data) > MAX_CONFIG_BYTES:
        raise ServerError(f"the settings take {len(data)} bytes, more than {MAX_CONFIG_BYTES}")
    return data


def _configure(process: Process, data: bytes) -> None:
    """Send a new child its configuration. Raises ServerError if it cannot be sent; the child has ended then."""
    scheduling.lower_child_priority(process.pid)
    try:
        process.tell(len(data).to_bytes(4, "little") + data)
    except RuntimeError as error:
        process.kill()
        process.wait()
        raise ServerError(f"a process cannot be told its settings: {error}") from error


def end(process: Process, within: float = 1.0) -> int:
    """Let a child end by itself within `within` seconds, otherwise kill it; return its exit status."""
    process.close()
    try:
        return process.wait(within)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()


def read_launch_config(orphaned: Callable[[], object]) -> LaunchConfig:
    """In the child, read the launch configuration. Calls `orphaned` in a thread when the parent has gone.

    On Linux, the system then also kills this process, whatever it does. Code in this process finds its standard input
    empty. Raises SystemExit if the parent has already gone, or the configuration is invalid.
    """
    parent = Parent()
    parent.watch(orphaned)
    return parent.config


class Parent:
    """In the child, its parent. config: the launch configuration. pipe: from the parent.

    Raises as `read_launch_config`.
    """

    def __init__(self) -> None:
        _kill_when_orphaned(True)
        self._prepared, self._begun = False, threading.Event()
        self._orphaned: Callable[[], object] = lambda: None
        self.pipe = os.dup(0)
        with Path(os.devnull).open("rb") as nothing:
            os.dup2(nothing.fileno(), 0)
        length = int.from_bytes(_read(self.pipe, 4), "little")
        try:
            self.config = msgspec.json.decode(
                _read(self.pipe, min(length, MAX_CONFIG_BYTES)), type=LaunchConfig
            )
        except msgspec.DecodeError as error:
            raise SystemExit(f"no valid launch configuration: {error}") from None

    def wait(self) -> None:
        """Wait until a spare is called. Raises SystemExit when the parent has gone."""
        if not os.read(self.pipe, len(ACTIVATE)):
            raise SystemExit(0)

    def watch(self, orphaned: Callable[[], object], *, kill: bool = True) -> None:
        """From now on, call `orphaned` in a thread when the parent has gone.

        kill: whether, on Linux, the system then also kills this process. Pass False if the process must silence a
        device first.
        """
        if not kill:
            _kill_when_orphaned(False)
        self.prepare()
        self._orphaned = orphaned
        self._begun.set()

    def prepare(self) -> None:
        """Start the thread for `watch`, which then needs no other: later the system may permit none.

        Raises SystemExit if it permits none now.
        """

        def work() -> None:
            self._begun.wait()
            while os.read(self.pipe, 4096):
                pass
            self._orphaned()

        if not self._prepared:
            try:
                threading.Thread(target=work, name="parent", daemon=True).start()
            except RuntimeError as error:
                raise SystemExit(f"this process cannot watch its parent: {error}") from None
            self._prepared = True


def _kill_when_orphaned(kill: bool) -> None:
    """On Linux, set whether the system kills this process when its parent has gone."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PDEATHSIG, signal.SIGKILL if kill else 0)


def _read(pipe: int, length: int) -> bytes:
    """Read `length` bytes, or fewer at the end of the input."""
    data = b""
    while len(data) < length and (more := os.read(pipe, length - len(data))):
        data += more
    return data
