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
from pacinian.serving import priority
from pacinian.serving.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

LONGEST = 1 << 20  # [bytes] of what a child is told
PDEATHSIG = 1  # of Linux's prctl


class Told(Struct, frozen=True):
    """What a child is told. folder: of the shared memory. secrets: names to values, for the bus alone."""

    folder: str
    settings: Settings
    secrets: dict[str, str] = {}

    def __repr__(self) -> str:  # never the secrets
        return f"Told({self.folder!r})"

    @property
    def path(self) -> Path:
        """The folder."""
        return Path(self.folder)


def start(module: str, told: Told) -> subprocess.Popen[bytes]:
    """Start `python -m pacinian.serving.<module>`. Its standard input stays open: closed, the child ends.

    From a thread that lives as long as the child: on Linux the child is killed when that thread ends.
    """
    return launch([sys.executable, "-m", f"pacinian.serving.{module}"], told)


def launch(command: Sequence[str], told: Told) -> subprocess.Popen[bytes]:
    """Start a child by any command that calls `begin`. Raises ServerError if it cannot be told so much."""
    data = msgspec.json.encode(told)
    if len(data) > LONGEST:
        raise ServerError(f"the settings take {len(data)} bytes, more than {LONGEST}")
    # a group of its own: Ctrl-C is the parent's, which ends its children in order
    process = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=os.name == "posix")
    priority.ease(process.pid)
    if process.stdin is not None:
        file = os.dup(process.stdin.fileno())

        def tell() -> None:
            with contextlib.suppress(OSError), os.fdopen(file, "wb") as pipe:
                pipe.write(len(data).to_bytes(4, "little") + data)

        # one that does not read holds up nobody; one that has died is seen when it is asked for
        threading.Thread(target=tell, name="tell", daemon=True).start()
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


def begin(orphaned: Callable[[], object], *, kill: bool = True) -> Told:
    """In the child: read what the parent tells. `orphaned` is called, in a thread, when the parent has gone.

    kill: on Linux, the system kills this process then, whatever it does; not for the guard, which has a
    device to silence. What runs in this process finds its standard input empty. Raises SystemExit if the
    parent is gone already, or tells nonsense.
    """
    if kill and sys.platform == "linux":
        ctypes.CDLL(None).prctl(PDEATHSIG, signal.SIGKILL)
    pipe = os.dup(0)
    with Path(os.devnull).open("rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    length = int.from_bytes(_read(pipe, 4), "little")
    try:
        told = msgspec.json.decode(_read(pipe, min(length, LONGEST)), type=Told)
    except msgspec.DecodeError as error:
        raise SystemExit(f"not told what to do: {error}") from None

    def watch() -> None:
        while os.read(pipe, 4096):
            pass
        orphaned()

    threading.Thread(target=watch, name="parent", daemon=True).start()
    return told


def _read(pipe: int, length: int) -> bytes:
    """So many bytes, fewer only at the end."""
    data = b""
    while len(data) < length and (more := os.read(pipe, length - len(data))):
        data += more
    return data
