"""How the server's processes start and end: told by their parent through standard input, whose end is theirs."""

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
from pacinian.serving.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

MAX_CONFIG_BYTES = 1 << 20  # [bytes] of what a child is told
PDEATHSIG = 1  # of Linux's prctl
HASTE = 8  # so many times less silence of the guard is waited for while there may be sound
MIN_HANG_LIMIT = 0.1  # [s]
# [s] that the time between two looks counts for: a process that is late cannot tell whether another one is
MAX_LOOK_GAP = 0.05
CALL = b"!"  # what a spare waits for


class LaunchConfig(Struct, frozen=True):
    """What a child is told. folder: of the shared memory. secrets: names to values, for the bus alone.

    spare: of a spare, the number of the process whose end it waits for.
    """

    folder: str
    settings: Settings
    secrets: dict[str, str] = {}
    spare: int = 0

    def __repr__(self) -> str:  # never the secrets
        return f"Told({self.folder!r})"

    @property
    def path(self) -> Path:
        """The folder."""
        return Path(self.folder)


class Process(subprocess.Popen[bytes]):
    """A child that runs. Its standard input stays open: closed, the child ends."""

    _telling: threading.Thread | None = None

    def tell(self, data: bytes) -> None:
        """Write to its standard input, after all that it was told before; in a thread, as it may not read."""
        if self.stdin is None:
            return
        file, before = os.dup(self.stdin.fileno()), self._telling

        def write() -> None:
            if before is not None:
                before.join()
            with contextlib.suppress(OSError), os.fdopen(file, "wb") as pipe:
                pipe.write(data)

        # one that does not read holds up nobody; one that has died is seen when it is asked for
        self._telling = threading.Thread(target=write, name="tell", daemon=True)
        self._telling.start()

    def call(self) -> None:
        """Let a spare begin."""
        self.tell(CALL)


def start(module: str, told: LaunchConfig) -> Process:
    """Start `python -m pacinian.serving.<module>.process`.

    From a thread that lives as long as the child: on Linux the child is killed when that thread ends.
    """
    return launch([sys.executable, "-m", f"pacinian.serving.{module}.process"], told)


def launch(command: Sequence[str], told: LaunchConfig) -> Process:
    """Start a child by any command that calls `read_launch_config`. Raises ServerError if it cannot be told so much."""
    data = msgspec.json.encode(told)
    if len(data) > MAX_CONFIG_BYTES:
        raise ServerError(f"the settings take {len(data)} bytes, more than {MAX_CONFIG_BYTES}")
    # a group of its own: Ctrl-C is the parent's, which ends its children in order
    process = Process(command, stdin=subprocess.PIPE, start_new_session=os.name == "posix")
    scheduling.lower_child_priority(process.pid)
    process.tell(len(data).to_bytes(4, "little") + data)
    return process


def end(process: subprocess.Popen[bytes], within: float = 1.0) -> int:
    """Let a child end by itself within so many seconds, or kill it; return its exit status."""
    if process.stdin is not None:
        with contextlib.suppress(OSError):
            process.stdin.close()
    try:
        return process.wait(within)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()


def read_launch_config(orphaned: Callable[[], object]) -> LaunchConfig:
    """In the child: read what the parent tells. `orphaned` is called, in a thread, when the parent has gone.

    On Linux, the system also kills this process then, whatever it does. What runs in this process finds its standard
    input empty. Raises SystemExit if the parent is gone already, or tells nonsense.
    """
    parent = Parent()
    parent.watch(orphaned)
    return parent.told


class Parent:
    """In the child: who has started it. told: what it was told. pipe: from it. Raises as `read_launch_config`."""

    def __init__(self) -> None:
        _kill_when_orphaned(True)
        self.pipe = os.dup(0)
        with Path(os.devnull).open("rb") as nothing:
            os.dup2(nothing.fileno(), 0)
        length = int.from_bytes(_read(self.pipe, 4), "little")
        try:
            self.told = msgspec.json.decode(
                _read(self.pipe, min(length, MAX_CONFIG_BYTES)), type=LaunchConfig
            )
        except msgspec.DecodeError as error:
            raise SystemExit(f"not told what to do: {error}") from None

    def wait(self) -> None:
        """Until a spare is called. Raises SystemExit when the parent has gone."""
        if not os.read(self.pipe, len(CALL)):
            raise SystemExit(0)

    def watch(self, orphaned: Callable[[], object], *, kill: bool = True) -> None:
        """From now on, call `orphaned` in a thread when the parent has gone.

        kill: on Linux, the system kills this process then: not where it has a device to silence.
        """
        if not kill:
            _kill_when_orphaned(False)

        def watch() -> None:
            while os.read(self.pipe, 4096):
                pass
            orphaned()

        threading.Thread(target=watch, name="parent", daemon=True).start()


def _kill_when_orphaned(kill: bool) -> None:
    """On Linux, have the system kill this process when its parent has gone, or not."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PDEATHSIG, signal.SIGKILL if kill else 0)


def _read(pipe: int, length: int) -> bytes:
    """So many bytes, fewer only at the end."""
    data = b""
    while len(data) < length and (more := os.read(pipe, length - len(data))):
        data += more
    return data


def compute_hang_limit(hung: float, *, sound: bool) -> float:
    """Time without a sign of life after which a process is killed [s]. sound: of the guard, while there may be some."""
    return min(hung, max(MIN_HANG_LIMIT, hung / HASTE)) if sound else hung
