"""A server under load: so many clients, so many updates a second, and whether what was put last is what is felt."""

from __future__ import annotations

import time
from collections import Counter
from contextlib import ExitStack
from typing import TYPE_CHECKING

from msgspec import Struct

from pacinian.scene.file import Units
from pacinian.scene.scene import Workspace
from pacinian.serving.settings import Clients, Log, Settings
from pacinian.testing import serving
from pacinian_lab.server import positions
from pacinian_lab.server.many_clients import Crowd, Done, Place, Push
from pacinian_lab.server.observer import Check, Checked, Look, Seen, Watch
from pacinian_lab.server.worker_process import WorkerProcess

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pacinian.testing import Running
    from pacinian.testing.server import Usage

CLIENTS = 1, 8, 64
RATES = 0.0, 1000.0, 10_000.0, 100_000.0  # [Hz] in all: nothing, a tenth, the load, ten times that
FULL = 10_000.0  # [Hz]: lower rates are there to compare with, for a quarter of the time
CROWDS = 2  # processes that send
SCENE = "load"
LEAD = 0.5  # [s] from the order to the begin
SETTLE = 0.1  # of a phase, until it is looked at: what was put before is not old
SLACK = 60.0  # [s] for an answer
LONG = 600.0  # [s] for one when no client is answered
STEP = 0.25  # [s] between two looks at memory
MEGA = 1e6


class Row(Struct, frozen=True):
    """A phase.

    rate: messages a second that were to be sent in all. sent: that were taken by sockets, full: that found no room,
    both per second. told: errors that clients were told, by code. memory: of all of the server's processes, at the
    begin, at the end, and the most [MB]. cpu: of each process, as a share of a core.
    """

    clients: int
    rate: float
    sent: float
    full: float
    told: dict[str, int]
    seen: Seen
    memory: tuple[float, float, float]
    cpu: dict[str, float]


class Final(Struct, frozen=True):
    """After all of it.

    objects: that were put; known: that the server has; missing: that are not felt where they were put last. sent:
    commands that sockets took; received, errors, dropped: as the server counts. refused: last moves, by code.
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
    """A server with `side` x `side` AUTD units that lets clients send as much as they can."""
    return Settings(
        array=Units(side, side),
        workspace=Workspace(*positions.WORKSPACE),
        clients=Clients(most=256, rate=1e6),
        log=Log(level="warning"),
    )


def measure(
    side: int, seconds: float, clients: int, rates: Sequence[float] = RATES
) -> Iterator[Row | Final]:
    """A row for each rate, for `seconds` [s] or a quarter of it; then what was there in the end."""
    objects = max(clients, positions.CELLS)
    with ExitStack() as stack:
        server = stack.enter_context(serving(settings(side)))
        watcher = stack.enter_context(WorkerProcess("observer"))
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
        sent = objects  # each was put
        for rate in rates:
            row = _phase(
                server, watcher, crowds, clients, rate, seconds / (1 if rate >= FULL else 4)
            )
            sent += round(row.sent * seconds / (1 if rate >= FULL else 4))
            yield row
        checks, refused = list[Checked](), Counter[str]()
        for group in range(-(-objects // positions.CELLS)):
            now = time.perf_counter()
            for crowd in crowds:
                crowd.send(Place(now, group))
            done = [crowd.receive(Done, LONG) for crowd in crowds]
            sent += sum(one.sent for one in done)
            for one in done:
                refused.update(one.told)
            first = group * positions.CELLS
            watcher.send(Check(now, first, min(first + positions.CELLS, objects), sent))
            checks.append(watcher.receive(Checked, SLACK))
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
    done = [crowd.receive(Done, SLACK) for crowd in crowds]
    seen = watcher.receive(Seen, SLACK)
    told = dict[str, int]()
    for one in done:
        for what, count in one.told.items():
            told[what] = told.get(what, 0) + count
    return Row(
        clients=clients,
        rate=rate,
        sent=sum(one.sent for one in done) / seconds,
        full=sum(one.full for one in done) / seconds,
        told=told,
        seen=seen,
        memory=(memory[0], memory[-1], max(memory)),
        cpu={
            name: (after[name].cpu - used.cpu) / seconds
            for name, used in before.items()
            if name in after
        },
    )


def _memory(usage: Mapping[str, Usage]) -> float:
    """Of all processes [MB]."""
    return sum(used.memory for used in usage.values()) / MEGA
