"""A server to inject faults into: real processes, and the device that logs."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil

from pacinian.closeable import Closeable
from pacinian.errors import ServerError
from pacinian.serving.control.supervisor import START_ORDER
from pacinian.testing.server import CONTROL, READY_TIMEOUT, list_processes
from pacinian_lab.server.faults.logged_backends import Models, Simulated
from pacinian_lab.server.faults.logging_device import Log, Other, Probe
from pacinian_lab.server.faults.plugins import install

if TYPE_CHECKING:
    from typing import Self

CONFIGURATION = """backend = "probe"
connection = "connection.json"
[array]
type = "autd"
columns = 1
rows = 1
[log]
format = "json"
"""
DEVICES = Probe, Other, Simulated, Models


class Server(Closeable):
    """`pacinian serve` in its own folder; a context manager that leaves no process running.

    more: TOML to append to its configuration. rate: of frames [Hz].
    """

    def __init__(self, folder: Path, more: str = "", rate: float = 1000.0) -> None:
        self.folder = folder
        self.file = folder / "connection.json"
        self.logs = tuple(Log(folder / kind.name) for kind in DEVICES)
        self.log = self.logs[0]
        self._environment = install(folder)
        self._configuration = folder / "server.toml"
        self._configuration.write_text(f"rate = {rate}\n{CONFIGURATION}{more}", encoding="utf-8")
        self._process: subprocess.Popen[bytes] | None = None
        self._seen: set[psutil.Process] = set()
        self._shared: set[Path] = set()

    def start(self) -> None:
        """Start the server, also after its end, and wait until all its processes run. Raises ServerError."""
        command = [sys.executable, "-m", "pacinian", "serve", str(self._configuration)]
        self.file.unlink(missing_ok=True)
        if self._process is not None:
            self._process.wait()
        with (self.folder / "log").open("ab") as errors:
            self._process = subprocess.Popen(
                command, env=self._environment, stdin=subprocess.DEVNULL,
                stdout=errors, stderr=errors, cwd=self.folder,
            )  # fmt: skip
        end = time.monotonic() + READY_TIMEOUT
        while not (self.file.exists() and self.parts().keys() >= set(START_ORDER)):
            if self._process.poll() is not None or time.monotonic() > end:
                raise ServerError(f"the server did not start: {self.read_output()[-2000:]}")
            time.sleep(0.02)
        self._shared |= memory(self._process.pid)

    @property
    def process(self) -> subprocess.Popen[bytes]:
        """The parent process, which is control."""
        if self._process is None:
            raise ServerError("the server has not been started")
        return self._process

    def parts(self) -> dict[str, psutil.Process]:
        """Return the child processes by name. "spare" is the spare guard, if there is one."""
        found = list_processes(self.process.pid)
        found.pop(CONTROL, None)
        self._seen.update(found.values())
        return found

    def signal(self, part: str, number: int) -> None:
        """Send a signal to one of the processes; "control" is the parent."""
        process = self.process if part == "control" else self.parts()[part]
        process.send_signal(number)

    def read_output(self) -> str:
        """Return the output of the server."""
        return (self.folder / "log").read_text(encoding="utf-8", errors="replace")

    def events(self) -> list[dict[str, Any]]:
        """Return the entries of its log that are JSON."""
        found: list[dict[str, Any]] = []
        for line in self.read_output().splitlines():
            with contextlib.suppress(ValueError):
                if isinstance(entry := json.loads(line), dict):
                    found.append(entry)
        return found

    def terminate(self, wait: float = 10.0) -> int:
        """Send SIGTERM and return the exit code."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(wait)

    def list_running(self) -> list[psutil.Process]:
        """Return the server's processes that still run."""
        return [process for process in self._seen if _runs(process)]

    def close(self) -> None:
        """End all processes that still run, and close the logs."""
        if self._process is not None:
            self.parts()
            if self._process.poll() is None:
                self._process.send_signal(signal.SIGCONT)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self.terminate(5.0)
            self._process.kill()
            self._process.wait()
        for process in self.list_running():
            with contextlib.suppress(psutil.Error):
                process.kill()
                process.wait(5.0)
        for folder in self._shared:  # a killed server leaves them behind
            shutil.rmtree(folder, ignore_errors=True)
        for log in self.logs:
            log.close()

    def __enter__(self) -> Self:
        try:
            self.start()
        except BaseException:
            self.close()
            raise
        return self


def _runs(process: psutil.Process) -> bool:
    try:
        return process.is_running() and bool(process.status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:  # it ended between the two calls
        return False


def memory(pid: int) -> set[Path]:
    """Return the folders of shared memory that a process maps."""
    maps = psutil.Process(pid).memory_maps() if os.name == "posix" else []
    return {Path(m.path).parent for m in maps if "/pacinian-" in m.path and m.path[0] == "/"}
