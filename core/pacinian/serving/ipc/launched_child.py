"""A child, as its parent sees it: its start, its configuration through its standard input, and its end."""

from __future__ import annotations

import contextlib
import functools
import gc
import subprocess
import sys
from typing import TYPE_CHECKING

from pacinian.closeable import Closeable
from pacinian.errors import ServerError
from pacinian.serving.ipc import scheduling
from pacinian.serving.ipc.child_pipe import ChildPipe
from pacinian.serving.ipc.launch_config import ACTIVATE, encode_config
from pacinian.serving.ipc.parent_link import run_module
from pacinian.serving.ipc.processes import fork_process, spawn_process

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from pacinian.serving.ipc.child_pipe import ChildPipes
    from pacinian.serving.ipc.launch_config import LaunchConfig
    from pacinian.serving.ipc.processes import Child

MAX_KILL_TIME = 3.0  # time limit for a process to end after it was killed [s]


class LaunchedChild:
    """A running child with its pipe. Its standard input stays open; closing it ends the child."""

    def __init__(self, process: Child, pipe: ChildPipe) -> None:
        self._process, self._pipe = process, pipe
        pipe.child = process

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def poll(self) -> int | None:
        """Return the exit code; None while the process runs."""
        return self._process.poll()

    def write(self, data: bytes) -> None:
        """Write to the child's standard input, after all earlier data. Raises RuntimeError as `ChildPipe.write`."""
        self._pipe.write(data)

    def activate(self) -> None:
        """Let a spare begin. One that cannot receive this is a spare that hangs."""
        with contextlib.suppress(RuntimeError):
            self.write(ACTIVATE)

    def close(self) -> None:
        """Close the child's standard input, which ends the child. No other child can use that pipe then."""
        self._pipe.close()

    def kill(self) -> None:
        """Kill the process."""
        self._process.kill()

    def wait(self, timeout: float | None = None) -> int:
        """Wait until the process has ended; return its exit code. Raises subprocess.TimeoutExpired."""
        return self._process.wait(timeout)


def start_child(module: str, config: LaunchConfig, pipe: ChildPipe | None = None) -> LaunchedChild:
    """Start `python -m pacinian.serving.<module>.process`.

    Call this from a thread that lives as long as the child: on Linux, the child is killed when that thread ends.
    """
    return start_command(_name_command(module), config, pipe)


def start_command(
    command: Sequence[str], config: LaunchConfig, pipe: ChildPipe | None = None
) -> LaunchedChild:
    """Start a child by any command that calls `read_launch_config`. pipe: its standard input; None makes one.

    Raises ServerError if the configuration is too long or cannot be sent; OSError if the child cannot be started.
    """
    data = encode_config(config)
    own = ChildPipe() if pipe is None else pipe
    child = LaunchedChild(spawn_process(command, own.source), own)
    try:
        _configure(child, data)
    except ServerError:
        if pipe is None:
            child.close()
        raise
    return child


class ForkedChildren(Closeable):
    """Children that are forked from this process, and wait for their configuration.

    They have the imports of this process. They share the pages of memory that neither process changes. Therefore a
    server starts sooner and takes less memory (decision 85). For the conditions, see `fork_process`. A context manager:
    leaving it ends the children that still wait. modules: as for `start_child`. The first child of each imports it at
    once, the others when they are taken. Only Linux has such children; elsewhere, and where the system permits no more,
    there are none.
    """

    def __init__(self, modules: Iterable[str], pipes: ChildPipes) -> None:
        self._waiting: list[tuple[str, LaunchedChild]] = []
        given = tuple(modules) if sys.platform == "linux" else ()
        if given:
            gc.collect()
            gc.freeze()  # otherwise a collection would write to all pages, so that none is shared
        try:
            for module in given:
                pipe = pipes.take()
                later = any(module == name for name, _ in self._waiting)
                run = functools.partial(
                    run_module, f"pacinian.serving.{module}.process", later=later
                )
                process = fork_process(run, _name_command(module), pipe.source)
                self._waiting.append((module, LaunchedChild(process, pipe)))
        except OSError:  # the others are spawned, or fail then
            pass
        except BaseException:
            self.close()
            raise

    def take(self, module: str, config: LaunchConfig) -> LaunchedChild | None:
        """Configure a child that waits; return it. None if no child with this module waits. Raises ServerError."""
        for i, (name, child) in enumerate(self._waiting):
            if name == module and child.poll() is None:
                data = encode_config(config)
                del self._waiting[i]
                _configure(child, data)
                return child
        return None

    def close(self) -> None:
        """End the children that still wait."""
        for _, child in self._waiting:
            child.kill()
        for _, child in self._waiting:
            with contextlib.suppress(subprocess.TimeoutExpired):  # the system does not let it end
                child.wait(MAX_KILL_TIME)


def _name_command(module: str) -> list[str]:
    return [sys.executable, "-m", f"pacinian.serving.{module}.process"]


def _configure(child: LaunchedChild, data: bytes) -> None:
    """Send a new child its configuration. Raises ServerError if it cannot be sent; the child has ended then."""
    scheduling.lower_child_priority(child.pid)
    try:
        child.write(len(data).to_bytes(4, "little") + data)
    except RuntimeError as error:
        child.kill()
        child.wait()
        raise ServerError(f"a process did not receive its settings: {error}") from error


def end_child(child: LaunchedChild, within: float = 1.0) -> int:
    """Let a child end by itself within `within` seconds, otherwise kill it; return its exit status."""
    child.close()
    try:
        return child.wait(within)
    except subprocess.TimeoutExpired:
        child.kill()
        return child.wait()
