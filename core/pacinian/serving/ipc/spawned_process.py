"""Start a process without a new file descriptor: there may be none left (decision 38)."""

from __future__ import annotations

import contextlib
import math
import os
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

POLL_INTERVAL = 2e-3  # interval between two checks whether a process has ended [s]
# Environment variable that keeps Python from importing from the folder in which the server was started. That folder may
# be another user's.
SAFE_PATH = {"PYTHONSAFEPATH": "1"}


class SystemProcess(Protocol):
    """The part of `subprocess.Popen` that the server needs."""

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


class SpawnedProcess:
    """A process that is started without any new file descriptor of this process: `subprocess.Popen` needs two.

    command: the program and its arguments. stdin: file descriptor of its standard input. It leads its own session.
    Raises OSError if it cannot be started; NotImplementedError if the system cannot start it so.
    """

    def __init__(self, command: Sequence[str], stdin: int) -> None:
        self._command = list(command)
        self._code: int | None = None
        self.pid = os.posix_spawnp(
            command[0],
            self._command,
            {**os.environ, **SAFE_PATH},
            file_actions=[(os.POSIX_SPAWN_DUP2, stdin, 0)],
            setsid=True,
            setsigdef=[signal.SIGPIPE, signal.SIGXFSZ],  # Python ignores these
        )

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


def start_process(command: Sequence[str], stdin: int) -> SystemProcess:
    """Start a program by its path and arguments. stdin: file descriptor of its standard input. Raises OSError."""
    # Own process group: Ctrl-C goes to the parent only, which then ends its children in order.
    if sys.platform != "win32":
        with contextlib.suppress(NotImplementedError):
            return SpawnedProcess(command, stdin)
    own, env = os.name == "posix", {**os.environ, **SAFE_PATH}
    return subprocess.Popen(command, stdin=stdin, env=env, start_new_session=own)
