"""Run all faults, each several times: the worst times, next to the documented bounds."""

from __future__ import annotations

import contextlib
import itertools
import math
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import PacinianError
from pacinian.rendering.pipeline import WAIT_FOR_SOLVE_AFTER
from pacinian.serving.control import process as control_process
from pacinian.serving.guard import process as guard_process
from pacinian.serving.ipc.hang_detection import SOUNDING_HANG_DIVISOR
from pacinian.serving.settings import Safety
from pacinian_lab.server.faults import client_faults, server_faults
from pacinian_lab.server.faults.rig import Rig, Times
from pacinian_lab.server.faults.server import Server

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

STATED = Safety()
SWAP = "gap at most a tick longer than undisturbed"
LED = "the same, plus the time that frames wait in the device"
TICK = 1e-3  # [s]
GUARD_ROUND = 2 * guard_process.POLL_INTERVAL  # [s] pause of a guard's round, and its work
LEAD = 2.5e-3  # [s] lead of `usb-autd` plus the rest of the current row
# bounds of the silence [s]
STOPPED = 2 * GUARD_ROUND
LEASE = STATED.lease + GUARD_ROUND
STALE = STATED.frame_timeout + 2 * GUARD_ROUND
LINK = control_process.OWNER_PROBE_INTERVAL + GUARD_ROUND
ENDED = control_process.CHECK_INTERVAL + GUARD_ROUND
OPENED = 0.1  # until the end of the guard is seen and the spare has opened the device
# a hang is detected in steps of 20 ms
HUNG = STATED.hang_timeout / SOUNDING_HANG_DIVISOR + 0.05 + OPENED


class Fault(NamedTuple):
    """A fault to inject.

    bound: on the silence [s]. For a fault during which the output should continue, on the increase of `gap` over the
    undisturbed gap. nan if no bound is documented.
    """

    name: str
    do: Callable[[Rig], Times]
    bound: float
    stated: str


FAULTS = (
    Fault("client killed -9", client_faults.kill_client, LINK, "the next check of the link"),
    Fault("client stopped (SIGSTOP)", client_faults.stop_client, LEASE, "lease"),
    Fault("game thread frozen", client_faults.freeze_client, LEASE, "lease"),
    Fault(
        "half-open connection: a relay that passes nothing on",
        client_faults.half_open_client,
        LEASE,
        "lease",
    ),
    Fault("client's clock jumps by 1 h", client_faults.jump_clock, LEASE, "lease"),
    Fault(
        "subscribers that never read the state",
        client_faults.subscribe_unread,
        math.nan,
        "memory bounded",
    ),
    Fault(
        "subscriber to thousands of topics",
        client_faults.subscribe_widely,
        math.nan,
        "memory bounded",
    ),
    Fault(
        "emergency stop by another client",
        client_faults.stop_in_emergency,
        STOPPED,
        "two rounds",
    ),
    Fault(
        "solver never returns",
        server_faults.hang_solver,
        STALE + WAIT_FOR_SOLVE_AFTER,
        "age of a solve, stale",
    ),
    Fault("solver holds the interpreter", server_faults.hold_solver, STALE, "stale"),
    Fault("renderer killed -9", server_faults.kill_render, STALE, "stale"),
    Fault("renderer stopped", server_faults.stop_render, STALE, "stale"),
    Fault("bus killed -9", server_faults.kill_bus, ENDED, "until its end is detected"),
    Fault(
        "guard killed -9", server_faults.kill_guard, OPENED, "device's watchdog, or the spare guard"
    ),
    Fault(
        "guard stopped",
        server_faults.stop_guard,
        HUNG,
        "an eighth of `hang_timeout`, then the spare guard",
    ),
    Fault("device blocks in a frame", server_faults.block_guard, HUNG, "the same"),
    Fault("control killed -9", server_faults.kill_control, GUARD_ROUND, "a round, after its end"),
    Fault("control stopped", server_faults.stop_control, LEASE, "lease"),
    Fault(
        "all processes suspended and resumed",
        server_faults.stop_all,
        GUARD_ROUND,
        "a round, after they resume",
    ),
    Fault("server killed and restarted", client_faults.restart_server, LEASE, "lease"),
    Fault("device unplugged", server_faults.unplug_device, TICK + GUARD_ROUND, "the next frame"),
    Fault(
        "... while swapping solvers",
        server_faults.unplug_swapping,
        TICK + GUARD_ROUND,
        "the next frame",
    ),
    Fault(
        "... while swapping devices",
        server_faults.unplug_both,
        TICK + 2 * GUARD_ROUND,
        "a round later",
    ),
    Fault("solvers swapped", server_faults.swap_solvers, TICK, SWAP),
    Fault("devices swapped", server_faults.swap_devices, TICK, SWAP),
    Fault("simulated to USB models", server_faults.swap_to_models, LEAD + TICK, LED),
    Fault("USB models to simulated", server_faults.swap_from_models, TICK, SWAP),
    Fault("solver hangs while it warms up", server_faults.hang_solver_warming, TICK, SWAP),
    Fault(
        "SIGTERM of the server",
        server_faults.terminate_server,
        math.nan,
        "silent first, exit code 0",
    ),
)


@dataclass
class Row:
    """All times of one fault. failed: what did not go as it should."""

    fault: str
    bound: float
    stated: str
    times: list[Times] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)

    def worst(self, name: str) -> float:
        """Return the worst of a field of `Times` [s], or nan if there is none."""
        return max(self._all(name), default=math.nan)

    def median(self, name: str) -> float:
        """Return the median of a field of `Times` [s], or nan if there is none."""
        values = self._all(name)
        return statistics.median(values) if values else math.nan

    def _all(self, name: str) -> list[float]:
        values = [float(getattr(t, name)) for t in self.times]
        return [v for v in values if not math.isnan(v)]

    @property
    def notes(self) -> list[str]:
        """All notes, without duplicates."""
        return list(dict.fromkeys([*self.failed, *(t.note for t in self.times if t.note)]))


def measure(faults: Iterable[Fault], repeats: int, busy: int = 0) -> Iterator[Row]:
    """Yield a row for each fault, repeated `repeats` times. Replaces a server that a fault has broken.

    busy: number of processes that load the CPU meanwhile.
    """
    with (
        _busy(busy),
        tempfile.TemporaryDirectory(prefix="pacinian-faults-") as name,
        contextlib.ExitStack() as stack,
    ):
        folders = (Path(name, str(number)) for number in itertools.count())
        server: Server | None = None
        for fault in faults:
            row = Row(fault.name, fault.bound, fault.stated)
            for _ in range(repeats):
                if server is None:
                    folder = next(folders)
                    folder.mkdir()
                    server = stack.enter_context(Server(folder))
                if not _once(server, fault, row):
                    stack.close()
                    server = None
            yield row


@contextlib.contextmanager
def _busy(count: int) -> Generator[None]:
    """Run busy-looping processes, each in its own session, because Linux shares CPU time among sessions."""
    command = [sys.executable, "-c", "while True: pass"]
    processes = [subprocess.Popen(command, start_new_session=True) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _once(server: Server, fault: Fault, row: Row) -> bool:
    """Inject the fault once. Returns whether the server works afterwards."""
    try:
        with Rig(server) as rig:
            row.times.append(fault.do(rig))
            rig.wait_for_sound()
    except (TimeoutError, OSError, KeyError, RuntimeError, PacinianError) as error:
        row.failed.append(f"{type(error).__name__}: {error}")
        return False
    return True
