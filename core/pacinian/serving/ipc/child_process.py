"""Child processes: the parent configures a child through its standard input. When that closes, the child ends."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
from msgspec import Struct

from pacinian.errors import ServerError
from pacinian.serving.ipc import scheduling
from pacinian.serving.ipc.child_pipe import ChildPipe
from pacinian.serving.ipc.spawned_process import start_process
from pacinian.serving.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

MAX_CONFIG_BYTES = 1 << 20  # largest launch configuration [bytes]
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

    def __init__(self, command: Sequence[str], pipe: ChildPipe) -> None:
        self._system, self._pipe = start_process(command, pipe.source), pipe
        pipe.child = self._system

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
    return launch([sys.executable, "-m", f"pacinian.serving.{module}.process"], config, pipe)


def launch(command: Sequence[str], config: LaunchConfig, pipe: ChildPipe | None = None) -> Process:
    """Start a child by any command that calls `read_launch_config`. pipe: its standard input; None makes one.

    Raises ServerError if the configuration is too long or cannot be sent; OSError if the child cannot be started.
    """
    try:
        data = msgspec.json.encode(config)
    except UnicodeEncodeError as error:
        raise ServerError(
            f"the path {error.object!r} in the settings is not Unicode: rename that file or folder"
        ) from None
    if len(data) > MAX_CONFIG_BYTES:
        raise ServerError(f"the settings take {len(data)} bytes, more than {MAX_CONFIG_BYTES}")
    process = Process(command, ChildPipe() if pipe is None else pipe)
    scheduling.lower_child_priority(process.pid)
    try:
        process.tell(len(data).to_bytes(4, "little") + data)
    except RuntimeError as error:
        process.kill()
        process.wait()
        if pipe is None:
            process.close()
        raise ServerError(f"a process cannot be told its settings: {error}") from error
    return process


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
