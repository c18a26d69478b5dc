"""All faults, each several times: the worst times, and beside them what the server states."""

from __future__ import annotations

import contextlib
import math
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import PacinianError
from pacinian.serving.guard import process as guard_process
from pacinian.serving.ipc import child_process
from pacinian.serving.settings import Safety
from pacinian_lab.server.faults import clients
from pacinian_lab.server.faults import server_parts as parts
from pacinian_lab.server.faults.server import Server
from pacinian_lab.server.faults.stage import Stage, Times

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

STATED = Safety()
SWAP = "no gap longer by more than a tick than undisturbed"
LED = "the same, and the lead that frames wait for in a device"
TICK, ROUND = 1e-3, 2 * guard_process.ROUND  # [s]; of the guard: its pause, and what a round takes
LEAD = 2.5e-3  # [s] of `usb-autd`, and what is left of the row then
LEASE, STALE = STATED.lease + ROUND, STATED.stale + 2 * ROUND
OPENED = 0.1  # [s]: the guard's end is seen, and the spare opens the device
# [s]: in steps of 20 ms it is seen to hang
HUNG = STATED.hung / child_process.HASTE + 0.05 + OPENED


class Fault(NamedTuple):
    """One of the table.

    bound: on silence [s]; where it should sound on, on how much longer `gap` is than undisturbed; nan: none is stated.
    """

    name: str
    do: Callable[[Stage], Times]
    bound: float
    stated: str


FAULTS = (
    Fault("client killed -9", clients.killed, LEASE, "link, or lease"),
    Fault("client stopped (SIGSTOP)", clients.stopped, LEASE, "lease"),
    Fault("game thread frozen", clients.frozen, LEASE, "lease"),
    Fault("half open: nothing is passed on", clients.half_open, LEASE, "lease"),
    Fault("client's clock jumps by 1 h", clients.jumped, LEASE, "lease"),
    Fault("state is never read", clients.slow, math.nan, "memory bounded"),
    Fault("thousands of topics", clients.greedy, math.nan, "memory bounded"),
    Fault("emergency stop by another", clients.emergency, TICK, "the way, and two rounds"),
    Fault("solver never returns", parts.solver_hangs, STALE, "stale"),
    Fault("solver holds the interpreter", parts.solver_holds, STALE, "stale"),
    Fault("renderer killed -9", parts.render_killed, STALE, "stale"),
    Fault("renderer stopped", parts.render_stopped, STALE, "stale"),
    Fault("bus killed -9", parts.bus_killed, math.nan, "as soon as it is seen"),
    Fault("guard killed -9", parts.guard_killed, OPENED, "device's watchdog, or the spare"),
    Fault("guard stopped", parts.guard_stopped, HUNG, "an eighth of hung, and as before"),
    Fault("device blocks in a frame", parts.guard_blocked, HUNG, "the same"),
    Fault("control killed -9", parts.control_killed, LEASE, "lease"),
    Fault("control stopped", parts.control_stopped, LEASE, "lease"),
    Fault("all stand still, and go on", parts.all_stopped, ROUND, "a round, from then"),
    Fault("server killed and restarted", clients.restarted, LEASE, "lease"),
    Fault("device unplugged", parts.unplugged, TICK + ROUND, "the next frame"),
    Fault("... while swapping solvers", parts.unplugged_swapping, TICK + ROUND, "the next frame"),
    Fault("... while swapping devices", parts.unplugged_both, TICK + 2 * ROUND, "a round later"),
    Fault("solvers swapped", parts.solvers_swapped, TICK, SWAP),
    Fault("devices swapped", parts.devices_swapped, TICK, SWAP),
    Fault("simulated to USB models", parts.to_models, LEAD + TICK, LED),
    Fault("USB models to simulated", parts.from_models, TICK, SWAP),
    Fault("a hanging solver is warmed", parts.solver_hangs_warming, TICK, SWAP),
    Fault("SIGTERM of the server", parts.terminated, math.nan, "silent first, exit code 0"),
)


@dataclass
class Row:
    """All times of one fault. failed: what went otherwise than it should."""

    fault: str
    bound: float
    stated: str
    times: list[Times] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)

    def worst(self, name: str) -> float:
        """Of one of `Times` [s]; nan where there is none."""
        return max(self._all(name), default=math.nan)

    def median(self, name: str) -> float:
        """The same in the middle [s]."""
        values = self._all(name)
        return statistics.median(values) if values else math.nan

    def _all(self, name: str) -> list[float]:
        values = [float(getattr(t, name)) for t in self.times]
        return [v for v in values if not math.isnan(v)]

    @property
    def notes(self) -> list[str]:
        """Each once."""
        return list(dict.fromkeys([*self.failed, *(t.note for t in self.times if t.note)]))


def measure(faults: Iterable[Fault] = FAULTS, repeats: int = 5, busy: int = 0) -> Iterator[Row]:
    """Each fault so many times, on a server that goes on where it can. busy: so many processes run beside it."""
    with _busy(busy), tempfile.TemporaryDirectory(prefix="pacinian-faults-") as folder:
        made = iter(range(1 << 30))
        server: Server | None = None
        try:
            for fault in faults:
                row = Row(fault.name, fault.bound, fault.stated)
                for _ in range(repeats):
                    if server is None:
                        server = _start(Path(folder, str(next(made))))
                    if not _once(server, fault, row):
                        server.close()
                        server = None
                yield row
        finally:
            if server is not None:
                server.close()


@contextlib.contextmanager
def _busy(count: int) -> Generator[None]:
    """Processes that never wait, each in a session of its own, by which Linux shares time out."""
    command = [sys.executable, "-c", "while True: pass"]
    processes = [subprocess.Popen(command, start_new_session=True) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _start(folder: Path) -> Server:
    folder.mkdir()
    server = Server(folder)
    try:
        server.start()
    except BaseException:
        server.close()
        raise
    return server


def _once(server: Server, fault: Fault, row: Row) -> bool:
    """Whether the server is well after it."""
    try:
        with Stage(server) as stage:
            row.times.append(fault.do(stage))
            stage.sounding()
    except (TimeoutError, OSError, KeyError, RuntimeError, PacinianError) as error:
        row.failed.append(f"{type(error).__name__}: {error}")
        return False
    return True
