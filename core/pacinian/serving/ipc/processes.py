"""Spawn or fork a process without a new file descriptor, because there may be none left (decision 38)."""

from __future__ import annotations

import atexit
import contextlib
import math
import os
import signal
import subprocess
import sys
import threading
import time
import traceback
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from pacinian.serving.ipc.system_setup import list_file_descriptors

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

POLL_INTERVAL = 2e-3  # interval between two checks whether a process has ended [s]
# Environment variable that keeps Python from importing from the folder in which the server was started. That folder may
# be another user's.
SAFE_PATH = {"PYTHONSAFEPATH": "1"}
# What a write to a standard stream raises that is None, closed, or not read.
UNWRITABLE = AttributeError, OSError, ValueError


class Child(Protocol):
    """A process that this one has started: the part of `subprocess.Popen` that the server needs."""

    @property
    def pid(self) -> int:
        """Process id."""
        ...

    def poll(self) -> int | None:
        """Return the exit code; None while the process runs."""
        ...

    def kill(self) -> None:
        """Kill the process."""
        ...

    def wait(self, timeout: float | None = None) -> int:
        """Wait until the process has ended; return its exit code. Raises subprocess.TimeoutExpired."""
        ...


class PosixChild:
    """A child on a POSIX system. pid: its id. command: its program and arguments, for errors."""

    def __init__(self, pid: int, command: Sequence[str]) -> None:
        self.pid, self._command = pid, list(command)
        self._code: int | None = None

    def poll(self) -> int | None:
        """Return the exit code; None while the process runs."""
        return self._reap(os.WNOHANG)

    def kill(self) -> None:
        """Kill the process, unless it has ended."""
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)

    def wait(self, timeout: float | None = None) -> int:
        """Wait until the process has ended; return its exit code. Raises subprocess.TimeoutExpired."""
        due = time.monotonic() + (math.inf if timeout is None else timeout)
        while (code := self._reap(0 if timeout is None else os.WNOHANG)) is None:
            if time.monotonic() >= due:
                raise subprocess.TimeoutExpired(self._command, timeout or 0.0)
            time.sleep(POLL_INTERVAL)
        return code

    def _reap(self, options: int) -> int | None:
        if self._code is None:
            try:
                pid, status = os.waitpid(self.pid, options)
            except ChildProcessError:  # SIGCHLD is ignored: the system keeps no exit code
                self._code = 0
            else:
                self._code = os.waitstatus_to_exitcode(status) if pid else None
        return self._code


def spawn_process(command: Sequence[str], stdin: int) -> Child:
    """Start a program by its path and arguments. stdin: file descriptor of its standard input. Raises OSError."""
    # Own session: Ctrl-C goes to the parent only, which then ends its children in order.
    if sys.platform != "win32":
        with contextlib.suppress(NotImplementedError):
            pid = os.posix_spawnp(
                command[0],
                list(command),
                {**os.environ, **SAFE_PATH},
                file_actions=[(os.POSIX_SPAWN_DUP2, stdin, 0)],
                setsid=True,
                setsigdef=[signal.SIGPIPE, signal.SIGXFSZ],  # Python ignores these
            )
            return PosixChild(pid, command)
    own, env = os.name == "posix", {**os.environ, **SAFE_PATH}
    return subprocess.Popen(command, stdin=stdin, env=env, start_new_session=own)


def fork_process(run: Callable[[], object], command: Sequence[str], stdin: int) -> PosixChild:
    """Start a copy of this process that calls `run` and then ends.

    The two share the pages of memory that neither changes. command: title of the copy in lists of processes. Without an
    environment, this process cannot set it. stdin: file descriptor of its standard input. Other threads do not exist in
    the copy, so none may hold a lock. No signal handler may raise, because the copy would clean up what belongs to its
    parent. What was registered with `atexit` before runs in both. Only for Linux. Raises OSError.
    """
    _flush_output()
    with warnings.catch_warnings():
        # of other threads: those of BLAS, which ends them before a fork
        warnings.simplefilter("ignore", DeprecationWarning)
        pid = os.fork()
    if pid:
        return PosixChild(pid, command)
    code = 1
    try:
        _separate(command, stdin)
        code = _run(run)
    finally:
        os._exit(code)


def _separate(command: Sequence[str], stdin: int) -> None:
    """Give this copy a session, signals, files and paths of its own, as a spawned process has, before all else."""
    os.setsid()
    for name in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
        if signal.getsignal(name) is not signal.SIG_IGN:
            own = signal.default_int_handler if name is signal.SIGINT else signal.SIG_DFL
            signal.signal(name, own)
    os.dup2(stdin, 0)
    for number in list_file_descriptors():
        os.close(number)
    os.environ.update(SAFE_PATH)
    if not sys.flags.safe_path:
        del sys.path[0]  # the folder of the program, or the one in which it was started

    from setproctitle import setproctitle, setthreadtitle  # not from that folder

    setproctitle(" ".join(command))
    setthreadtitle(Path(command[0]).name)


def _run(run: Callable[[], object]) -> int:
    """Call `run` and end as the interpreter does; return the exit code, 0..255."""
    code = 1
    try:
        run()
        code = 0
    except SystemExit as error:
        code = error.code & 0xFF if isinstance(error.code, int) else int(error.code is not None)
        if not isinstance(error.code, int | None):
            _write_error(f"{error.code}\n")
    except BaseException:
        _write_error(traceback.format_exc())
    getattr(threading, "_shutdown")()  # noqa: B009  # threads that are not daemons, and pools
    getattr(atexit, "_run_exitfuncs")()  # noqa: B009
    _flush_output()
    return code


def _write_error(text: str) -> None:
    with contextlib.suppress(*UNWRITABLE):
        sys.stderr.write(text)


def _flush_output() -> None:
    for stream in sys.stdout, sys.stderr:
        with contextlib.suppress(*UNWRITABLE):
            stream.flush()
