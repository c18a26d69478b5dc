"""What a process of the server asks of the operating system: file descriptors, memory, signals, systemd."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import signal
import socket
import sys
import threading
from typing import TYPE_CHECKING

from pacinian.errors import ServerError

if TYPE_CHECKING:
    from collections.abc import Generator
    from types import FrameType

# Smallest number of file descriptors with which a server starts. Its own are 52; ZeroMQ ends the process that has none
# left.
MIN_FILE_LIMIT = 64


def list_file_descriptors() -> list[int]:
    """Return the open file descriptors except the standard ones. Raises OSError if the system has no list."""
    found = []
    for number in map(int, os.listdir("/dev/fd")):
        with contextlib.suppress(OSError):  # the list's own, which is closed again
            os.fstat(number)
            found.append(number)
    return [number for number in found if number > 2]


def has_open_files() -> bool:
    """Return whether this process has opened other files than the standard ones, or the system does not tell.

    Files that it has inherited do not count: they are inheritable, and those that Python opens are not.
    """
    try:
        return any(not os.get_inheritable(number) for number in list_file_descriptors())
    except OSError:
        return True


def hold_standard_files() -> None:
    """Open the null device for standard files that are closed, so that no other file gets their numbers."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)


def raise_file_limit() -> None:
    """Allow as many connections as the system permits. Each connection takes a file descriptor.

    Raises ServerError if the system permits too few.
    """
    if sys.platform == "win32":
        return
    import resource

    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    if most != resource.RLIM_INFINITY and most < MIN_FILE_LIMIT:
        raise ServerError(
            f"the system permits {most} files, and a server needs {MIN_FILE_LIMIT}: "
            f"run `ulimit -Hn {MIN_FILE_LIMIT}` as root, or raise the limit of this user or service"
        )
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def trim_memory() -> None:
    """Return unused memory to the system, and leave what is loaded out of later garbage collections.

    Call this once a process is warm. The C library keeps what was freed: after a warm-up of the renderer, 30 MB.
    """
    gc.collect()
    gc.freeze()
    if sys.platform == "linux":
        with contextlib.suppress(AttributeError):  # only glibc has it
            ctypes.CDLL(None).malloc_trim(0)


@contextlib.contextmanager
def catch_signals(ending: threading.Event) -> Generator[None]:
    """Let SIGTERM, Ctrl-C and the end of a terminal set `ending`, instead of ending the process anywhere.

    In another thread than the main one, which alone can catch signals, this does nothing.
    """

    def request_end(number: int, frame: FrameType | None) -> None:
        ending.set()

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    names = [getattr(signal, n) for n in ("SIGTERM", "SIGINT", "SIGBREAK") if hasattr(signal, n)]
    if sys.platform != "win32" and signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # nohup
        names.append(signal.SIGHUP)
    before = {name: signal.signal(name, request_end) for name in names}
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)


def notify_systemd(state: str) -> None:
    """Send a state to systemd, if it asks for that: sd_notify(3)."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address or not hasattr(socket, "AF_UNIX"):
        return
    name = "\0" + address[1:] if address.startswith("@") else address
    with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as to:
        to.sendto(state.encode(), name)
