"""A child's link to its parent: it receives its configuration, and notices when its parent has gone."""

from __future__ import annotations

import ctypes
import importlib
import os
import select
import signal
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from pacinian.serving.ipc import scheduling
from pacinian.serving.ipc.launch_config import ACTIVATE, MAX_CONFIG_BYTES, LaunchConfig

if TYPE_CHECKING:
    from collections.abc import Callable

PDEATHSIG = 1  # number of PR_SET_PDEATHSIG, an option of Linux's prctl


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
        _die_with_parent()
        self._prepared, self._begun = False, threading.Event()
        self._orphaned: Callable[[], object] = lambda: None
        self.pipe = os.dup(0)
        with Path(os.devnull).open("rb") as nothing:
            os.dup2(nothing.fileno(), 0)
        length = int.from_bytes(_read_bytes(self.pipe, 4), "little")
        try:
            self.config = msgspec.json.decode(
                _read_bytes(self.pipe, min(length, MAX_CONFIG_BYTES)), type=LaunchConfig
            )
        except msgspec.DecodeError as error:
            raise SystemExit(f"no valid launch configuration: {error}") from None

    def wait(self) -> None:
        """Wait until the parent activates this spare. Raises SystemExit when the parent has gone."""
        if not os.read(self.pipe, len(ACTIVATE)):
            raise SystemExit(0)

    def watch(self, orphaned: Callable[[], object], *, kill: bool = True) -> None:
        """From now on, call `orphaned` in a thread when the parent has gone.

        kill: whether, on Linux, the system then also kills this process. Pass False if the process must silence a
        device first.
        """
        if not kill:
            _outlive_parent()
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


def run_module(name: str, *, later: bool) -> None:
    """In a forked child, run the module of its process as soon as its configuration arrives.

    Returns at once when the parent has gone. later: whether to import the module only once the configuration arrives.
    """
    _die_with_parent()
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


def _die_with_parent() -> None:
    """On Linux, let the system kill this process when its parent has gone."""
    _set_death_signal(signal.SIGKILL)


def _outlive_parent() -> None:
    """On Linux, let this process continue when its parent has gone."""
    _set_death_signal(0)


def _set_death_signal(number: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PDEATHSIG, number)


def _read_bytes(pipe: int, length: int) -> bytes:
    """Read `length` bytes, or fewer at the end of the input."""
    data = b""
    while len(data) < length and (more := os.read(pipe, length - len(data))):
        data += more
    return data
