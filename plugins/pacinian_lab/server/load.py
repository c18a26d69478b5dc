"""Load a server with many clients and updates, and check that the newest positions are those that the hand feels."""

from __future__ import annotations

import time
from collections import Counter
from contextlib import ExitStack
from typing import TYPE_CHECKING

from msgspec import Struct

from pacinian.scene.config_sections import Units
from pacinian.scene.scene import Workspace
from pacinian.serving.settings import ClientLimits, Log, Settings
from pacinian.testing import run_server
from pacinian_lab.server import positions
from pacinian_lab.server.load_observer import Check, Checked, Look, Seen, Watch
from pacinian_lab.server.many_clients import Crowd, Done, Place, Push
from pacinian_lab.server.worker_process import WorkerProcess

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pacinian.testing import Running
    from pacinian.testing.server import Usage

# [Hz] in total: idle, a tenth of the load, the load, ten times the load
RATES = 0.0, 1000.0, 10_000.0, 100_000.0
FULL = 10_000.0  # [Hz] that the tick rate must hold; lower rates run a quarter of the time
CROWDS = 2  # number of sending processes
SCENE = "load"
LEAD = 0.5  # [s] from the order to the start
SETTLE = 0.1  # fraction of a phase that passes before it is observed
MAX_WAIT = 60.0  # [s] longest wait for an answer
MAX_BUSY_WAIT = 600.0  # [s] longest wait for an answer when the server does not answer any client
STEP = 0.25  # [s] between two memory readings
MEGA = 1e6


class Row(Struct, frozen=True):
    """Results of one phase.

    rate: intended messages per second in total. sent: messages per second that the sockets took; full: messages per
    second that found no room. errors: those that clients received, by code. memory: of all server processes together,
    at the start, at the end, and the maximum [MB]. cpu: of each process, as a fraction of a core.
    """

    clients: int
    rate: float
    sent: float
    full: float
    errors: dict[str, int]
    seen: Seen
    memory: tuple[float, float, float]
    cpu: dict[str, float]


class Final(Struct, frozen=True):
    """Results after all phases.

    objects: number put by the clients; known: number that the server has; missing: objects that the hand does not
    feel at their last position. sent: commands that the sockets took; received, errors, dropped: as counted by the
    server. refused: refused final moves, by code.
    """

    clients: int
    objects: int
    known: int
    missing: tuple[int, ...]
    sent: int
    received: int
    errors: int
    dropped: int
    refused: dict[str, int] = {}


def settings(side: int) -> Settings:
    """Settings of a server with `side` x `side` AUTD units that puts no practical limit on the clients' rate."""
    return Settings(
        array=Units(side, side),
        workspace=Workspace(*positions.WORKSPACE),
        clients=ClientLimits(max_sessions=256, max_rate=1e6),
        log=Log(level="warning"),
    )


def measure(
    side: int, seconds: float, clients: int, rates: Sequence[float] = RATES
) -> Iterator[Row | Final]:
    """Yield a row for each rate, measured for `seconds` [s] or a quarter of it, then the final state."""
    objects = max(clients, positions.CELLS)
    with ExitStack() as stack:
        server = stack.enter_context(run_server(settings(side)))
        watcher = stack.enter_context(WorkerProcess("load_observer"))
        watcher.send(Watch(str(server.connection), SCENE))
        watcher.receive(Watch)
        crowds = [
            stack.enter_context(WorkerProcess("many_clients")) for _ in range(min(CROWDS, clients))
        ]
        for k, crowd in enumerate(crowds):
            members = tuple(range(k, clients, len(crowds)))
            crowd.send(Crowd(str(server.connection), SCENE, members, clients, objects))
        for crowd in crowds:
            crowd.receive(Done)
        sent = objects  # one `put` for each object
        for rate in rates:
            length = seconds if rate >= FULL else seconds / 4
            row = _phase(server, watcher, crowds, clients, rate, length)
            sent += round(row.sent * length)
            yield row
        checks, refused = list[Checked](), Counter[str]()
        for group in range(-(-objects // positions.CELLS)):
            now = time.perf_counter()
            for crowd in crowds:
                crowd.send(Place(now, group))
            done = [crowd.receive(Done, MAX_BUSY_WAIT) for crowd in crowds]
            sent += sum(one.sent for one in done)
            for one in done:
                refused.update(one.notices)
            first = group * positions.CELLS
            watcher.send(Check(now, first, min(first + positions.CELLS, objects), sent))
            checks.append(watcher.receive(Checked, MAX_WAIT))
        missing = tuple(i for one in checks for i in one.missing)
        last = checks[-1]
        yield Final(
            clients,
            objects,
            last.objects,
            missing,
            sent,
            last.commands,
            last.errors,
            last.dropped,
            dict(refused),
        )


def _phase(
    server: Running,
    watcher: WorkerProcess,
    crowds: Sequence[WorkerProcess],
    clients: int,
    rate: float,
    seconds: float,
) -> Row:
    begin = time.perf_counter() + LEAD
    end = begin + seconds
    for crowd in crowds:
        crowd.send(Push(rate / len(crowds), begin, end))
    watcher.send(Look(begin + SETTLE * seconds, end))
    time.sleep(max(0.0, begin - time.perf_counter()))
    before = server.usage()
    memory = [_memory(before)]
    while (left := end - time.perf_counter()) > 0.0:
        time.sleep(min(left, STEP))
        memory.append(_memory(server.usage()))
    after = server.usage()
    done = [crowd.receive(Done, MAX_WAIT) for crowd in crowds]
    seen = watcher.receive(Seen, MAX_WAIT)
    errors = Counter[str]()
    for one in done:
        errors.update(one.notices)
    return Row(
        clients=clients,
        rate=rate,
        sent=sum(one.sent for one in done) / seconds,
        full=sum(one.full for one in done) / seconds,
        errors=dict(errors),
        seen=seen,
        memory=(memory[0], memory[-1], max(memory)),
        cpu={
            name: (after[name].cpu - used.cpu) / seconds
            for name, used in before.items()
            if name in after
        },
    )


def _memory(usage: Mapping[str, Usage]) -> float:
    """Return the memory of all processes [MB]."""
    return sum(used.memory for used in usage.values()) / MEGA
