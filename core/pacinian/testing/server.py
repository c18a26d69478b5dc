"""A real server in processes of its own, for as long as it is needed."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import ServerError

if TYPE_CHECKING:
    from collections.abc import Generator

    import psutil

    from pacinian.serving.settings import Settings

START = 300.0  # [s] for all of its processes to be ready, and to compile what there is to compile
END = 10.0  # [s] to end by itself when it is told to
LOOK = 0.02  # [s] between two looks
TOLD = 2000  # characters of the log that an error tells
COMMAND = sys.executable, "-m", "pacinian", "serve"
CONTROL = "control"
CHILDREN = "bus", "render", "guard"


class Usage(NamedTuple):
    """What a process takes. memory: resident [bytes]. cpu: time since it started [s]. files: open ones."""

    memory: int
    cpu: float
    files: int


@dataclass(frozen=True)
class Running:
    """A running server. connection: its connection file. process: its first one. log: what it logs to."""

    process: subprocess.Popen[bytes]
    connection: Path
    log: Path

    @property
    def pids(self) -> dict[str, int]:
        """Its processes now: `control`, `bus`, `render`, `guard`; those that run."""
        import psutil

        found = {CONTROL: self.process.pid}
        with suppress(psutil.Error):
            children = psutil.Process(self.process.pid).children()
            for child in sorted(children, key=lambda child: (child.create_time(), child.pid)):
                with suppress(psutil.Error):
                    words = child.cmdline()
                    for name in CHILDREN:
                        if f"pacinian.serving.{name}.process" in words:
                            found.setdefault(name, child.pid)  # the guard is older than its spare
        return {name: found[name] for name in (CONTROL, *CHILDREN) if name in found}

    def usage(self) -> dict[str, Usage]:
        """What each of its processes takes."""
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

    def said(self) -> str:
        """What it has logged."""
        return self.log.read_text(encoding="utf-8", errors="replace")


@contextmanager
def serving(settings: Settings | None = None, *, limit: float = START) -> Generator[Running]:
    """Start `pacinian serve` and wait until it is ready; end it, with all of its processes.

    settings: the server's own unless given; its connection file is always a private one. Raises ServerError if it
    is not ready after `limit` seconds.
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
            children = _children(running)  # who is left if the first one is killed
            yield running
        finally:
            _end(running, children)


def _ready(running: Running, limit: float) -> None:
    due = time.monotonic() + limit
    while not running.connection.exists():
        code = running.process.poll()
        if code is not None:
            raise ServerError(f"the server ended with {code}: {running.said()[-TOLD:].strip()}")
        if time.monotonic() > due:
            raise ServerError(
                f"the server is not ready after {limit:g} s: {running.said()[-TOLD:]}"
            )
        time.sleep(LOOK)


def _children(running: Running) -> set[psutil.Process]:
    import psutil

    try:
        return set(psutil.Process(running.process.pid).children(recursive=True))
    except psutil.Error:
        return set()


def _end(running: Running, children: set[psutil.Process]) -> None:
    import psutil

    children = children | _children(running)
    running.process.terminate()
    try:
        running.process.wait(END)
    except subprocess.TimeoutExpired:
        running.process.kill()
        running.process.wait()
    _, left = psutil.wait_procs(children, timeout=END)
    for child in left:
        with suppress(psutil.Error):
            child.kill()
