"""Measure the time from the end of a permit to silence: the guard's bound, and the delay that the machine adds.

The bound is one round: the pause between two polls of the guard, plus the time of one poll. With a simulated clock,
the bound holds exactly. The benchmark then runs a guard process with real sleeps and the simulated array, and
measures until the guard reports silence. It discards runs in which the benchmark itself was late.
"""

from __future__ import annotations

import random
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from pacinian.plugins import registry
from pacinian.serving.guard.output_gate import OutputGate
from pacinian.serving.guard.process import POLL_INTERVAL
from pacinian.serving.ipc import scheduling
from pacinian.serving.ipc.messages import FrameHead, Permit
from pacinian.serving.settings import Settings
from pacinian.testing import ManualClock
from pacinian_lab.server.guard_process import MAX_WAIT, PROMPT, GuardProcess, levels
from pacinian_lab.server.quantiles import Quantiles
from pacinian_lab.solvers.tables import plain_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.table import Table


BOUND = 2 * POLL_INTERVAL  # [s] one round: its pause, and as long again for its work
TICK = 1e-3  # [s] between frames
MAX_TIME_LEFT = 1e-3  # [s] longest time left on a real permit at its last write


class Sizes(NamedTuple):
    """Number of repeats of each measurement."""

    simulated: int = 100_000
    sleeps: int = 20_000
    expired: int = 100_000
    stopped: int = 10_000
    stale: int = 1_000
    killed: int = 10


FULL, SHORT = Sizes(), Sizes(2_000, 200, 200, 50, 10, 1)


@dataclass(frozen=True)
class Row:
    """Times from the end to silence [s].

    bound: their maximum on a machine that is never late [s]. over: fraction of the times above the bound.
    """

    what: str
    count: int
    bound: float
    p50: float
    p99: float
    p999: float
    worst: float
    over: float


def measure(sizes: Sizes) -> Iterator[Row]:
    """Yield a row for each kind of end, with the repeats in `sizes`.

    Raises ServerError if a guard does not answer.
    """
    settings, chance = Settings(), random.Random(1)
    stale = settings.safety.frame_timeout
    yield _row(
        "expired, simulated clock [rounds]",
        1.0,
        _measure_simulated(settings, sizes.simulated, chance),
    )
    yield _row("a sleep of one round, alone", POLL_INTERVAL, _sleeps(sizes.sleeps))
    with GuardProcess(settings) as real:
        yield _row("expired", BOUND, _measure_expired(real, sizes.expired, chance))
        yield _row("emergency stop", BOUND, _measure_stopped(real, sizes.stopped))
        # The guard sees the last frame up to one round after its write, and takes up to one round
        # more to find it stale.
        yield _row("no more frames", stale + 2 * BOUND, _stale(real, sizes.stale))
    # The rest is the operating system's time: it closes the pipe after it has freed the parent's
    # memory.
    yield _row("parent killed", BOUND, _measure_killed(settings, sizes.killed))


def _row(what: str, bound: float, times: Sequence[float]) -> Row:
    found = Quantiles.of(times)
    over = sum(one > bound for one in times) / found.count
    return Row(what, found.count, bound, found.p50, found.p99, found.p999, found.most, over)


def _measure_simulated(settings: Settings, count: int, chance: random.Random) -> list[float]:
    """Return the times from `until` to silence, each divided by the length of its round."""
    array, clock = settings.array.make(), ManualClock()
    backend = registry.backend("simulated", keep=1)
    backend.open(array)
    guard = OutputGate(
        len(array), gain=1.0, frame_timeout=settings.safety.frame_timeout, clock=clock.now
    )
    guard.adopt_device(backend, backend.capability)
    data = levels(array)
    found: list[float] = []
    for epoch in range(1, count + 1):
        lease = settings.safety.lease * chance.uniform(0.01, 1.0)
        until, renewals = clock.time + lease, chance.randrange(4)
        due = clock.time + TICK * chance.random()  # time of the next frame
        while True:
            pause = POLL_INTERVAL * chance.uniform(0.2, 4.0)
            left = until - clock.time
            if left > 3 * TICK and not renewals:  # only frames follow: skip to the end
                clock.advance(left - chance.uniform(1.0, 3.0) * TICK)
            clock.advance(pause)
            if renewals and chance.random() < 0.3:
                until, renewals = max(until, clock.time + lease * chance.random()), renewals - 1
            frame = None
            if clock.time >= due:
                due = clock.time + TICK * chance.uniform(0.5, 1.5)
                frame = FrameHead(epoch, clock.time, epoch, 1, 1, len(array)).pack() + data
            was = guard.sounding
            guard.step(Permit(1, until, epoch), frame)
            if was and not guard.sounding and clock.time >= until:
                found.append((clock.time - until) / pause)
            if clock.time >= until:
                break
    backend.close()
    return found


def _sleeps(count: int) -> list[float]:
    """Return how long the machine really sleeps when a sleep of one round is requested."""
    scheduling.raise_priority(0)
    found: list[float] = []
    for _ in range(count):
        begin = time.perf_counter()
        time.sleep(POLL_INTERVAL)
        found.append(time.perf_counter() - begin)
    return found


def _measure_expired(real: GuardProcess, count: int, chance: random.Random) -> list[float]:
    """Return the times from `until` to silence."""
    found: list[float] = []
    while len(found) < count:
        before, _ = real.sound()
        until = time.perf_counter() + MAX_TIME_LEFT * chance.random()
        real.permit(until)
        late = time.perf_counter() > until  # the benchmark was late, not the guard
        silent = real.silent("expired", before)
        if silent is not None and not late:
            found.append(silent - until)
    return found


def _measure_stopped(real: GuardProcess, count: int) -> list[float]:
    """Return the times from the stop order to silence."""
    found: list[float] = []
    while len(found) < count:
        before, _ = real.sound()
        now = time.perf_counter()
        real.permit(now + MAX_WAIT, stopped=1)
        late = time.perf_counter() - now > PROMPT
        silent = real.silent("stopped", before)
        if silent is not None and not late:
            found.append(silent - now)
    return found


def _stale(real: GuardProcess, count: int) -> list[float]:
    """Return the times from the last frame to silence."""
    found: list[float] = []
    while len(found) < count:
        before, written = real.sound()
        if (silent := real.silent("stale", before)) is not None:
            found.append(silent - written)
    return found


def _measure_killed(settings: Settings, count: int) -> list[float]:
    """Return the times from kill -9 of the guard's parent to silence. The permit stays valid and the frames fresh."""
    patient = replace(settings, safety=replace(settings.safety, frame_timeout=1.0))
    found: list[float] = []
    while len(found) < count:
        with GuardProcess(patient, orphan=True) as real:
            before, _ = real.sound()
            now = time.perf_counter()
            real.process.kill()
            if (silent := real.silent("end", before)) is not None:
                found.append(silent - now)
    return found


def tabulate(rows: Sequence[Row]) -> Table:
    """Return a table with a line for each kind of end."""
    head = ["[ms]", "times", "bound", "p50", "p99", "p99.9", "worst", "over the\nbound [%]"]
    lines: list[list[str]] = []
    for row in rows:
        unit = 1.0 if "[rounds]" in row.what else 1e3
        times = (row.bound, row.p50, row.p99, row.p999, row.worst)
        numbers = [f"{unit * one:.3f}" for one in times]
        lines.append([row.what, str(row.count), *numbers, f"{100 * row.over:.3g}"])
    return plain_table("From the end of a permit to silence", head, lines)
