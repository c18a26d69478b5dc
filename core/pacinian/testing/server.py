"""A real server in its own processes, for the duration of a test."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import ServerError
from pacinian.serving.control.supervisor import SPARE, START_ORDER

if TYPE_CHECKING:
    from collections.abc import Generator

    import psutil

    from pacinian.serving.settings import Settings

READY_TIMEOUT = 300.0  # time until all processes are ready, including compilation [s]
END_TIMEOUT = 10.0  # time for the server to end after SIGTERM [s]
POLL_INTERVAL = 0.02  # polling period [s]
EXCERPT_LENGTH = 2000  # length of the log excerpt in an error [characters]
COMMAND = sys.executable, "-m", "pacinian", "serve"
CONTROL = "control"
CHILD = re.compile(r"pacinian\.serving\.(\w+)\.process")  # in the command line of a child


class Usage(NamedTuple):
    """Resources of a process. memory: resident memory [bytes]. cpu: CPU time [s]. files: number of open files."""

    memory: int
    cpu: float
    files: int


@dataclass(frozen=True)
class Running:
    """A running server. process: its first process. connection: its connection file. log: its log file."""

    process: subprocess.Popen[bytes]
    connection: Path
    log: Path

    @property
    def pids(self) -> dict[str, int]:
        """Process ids of the running processes by name: `control`, `bus`, `render`, `guard`."""
        found = list_processes(self.process.pid)
        return {name: found[name].pid for name in (CONTROL, *START_ORDER) if name in found}

    def usage(self) -> dict[str, Usage]:
        """Return the resources of each process."""
        import psutil

        found = dict[str, Usage]()
        for name, pid in self.pids.items():
            with suppress(psutil.Error):
                process = psutil.Process(pid)
                with process.oneshot():
                    times, memory = process.cpu_times(), process.memory_info().rss
                    files = process.num_handles() if sys.platform == "win32" else process.num_fds()
                found[name] = Usage(memory, times.user + times.system, files)
        return found

    def read_log(self) -> str:
        """Return the log."""
        return self.log.read_text(encoding="utf-8", errors="replace")


def list_processes(pid: int) -> dict[str, psutil.Process]:
    """Return the running processes of the server whose first process is `pid`, by name.

    The names are `control`, `bus`, `render`, `guard` and `spare`, which is the younger guard.
    """
    import psutil

    found = dict[str, psutil.Process]()
    with suppress(psutil.Error):
        found[CONTROL] = psutil.Process(pid)
        children = found[CONTROL].children()
        for child in sorted(children, key=lambda child: (child.create_time(), child.pid)):
            with suppress(psutil.Error):
                match = CHILD.search(" ".join(child.cmdline()))
                if match and child.status() != psutil.STATUS_ZOMBIE:
                    found[SPARE if match[1] in found else match[1]] = child
    return found


@contextmanager
def run_server(
    settings: Settings | None = None, *, limit: float = READY_TIMEOUT
) -> Generator[Running]:
    """Start `pacinian serve`, wait until it is ready, and finally end it with all of its processes.

    settings: settings of the server; its defaults if None. The connection file is always a private one. Raises
    ServerError if the server is not ready after `limit` seconds.
    """
    import msgspec
    import psutil

    from pacinian.serving.settings import Settings

    with tempfile.TemporaryDirectory(prefix="pacinian-") as name:
        folder = Path(name)
        connection, config, log = (folder / f for f in ("connection.json", "config.json", "log"))
        made = msgspec.structs.replace(settings or Settings(), connection=str(connection))
        config.write_bytes(msgspec.json.encode(made))
        command = [*COMMAND, str(config)]
        with log.open("wb") as stream:
            process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=stream, stderr=stream,
                start_new_session=os.name == "posix",
            )  # fmt: skip
        running, children = Running(process, connection, log), set[psutil.Process]()
        try:
            _ready(running, limit)
            children = _list_children(running)  # to end them even if the first process is killed
            yield running
        finally:
            _end(running, children)


def _ready(running: Running, limit: float) -> None:
    due = time.monotonic() + limit
    while not running.connection.exists():
        code = running.process.poll()
        if code is not None:
            raise ServerError(
                f"the server ended with {code}: {running.read_log()[-EXCERPT_LENGTH:].strip()}"
            )
        if time.monotonic() > due:
            raise ServerError(
                f"the server is not ready after {limit:g} s: {running.read_log()[-EXCERPT_LENGTH:]}"
            )
        time.sleep(POLL_INTERVAL)


def _list_children(running: Running) -> set[psutil.Process]:
    import psutil

    try:
        return set(psutil.Process(running.process.pid).children(recursive=True))
    except psutil.Error:
        return set()


def _end(running: Running, children: set[psutil.Process]) -> None:
    import psutil

    children = children | _list_children(running)
    running.process.terminate()
    try:
        running.process.wait(END_TIMEOUT)
    except subprocess.TimeoutExpired:
        running.process.kill()
        running.process.wait()
    _, left = psutil.wait_procs(children, timeout=END_TIMEOUT)
    for child in left:
        with suppress(psutil.Error):
            child.kill()
