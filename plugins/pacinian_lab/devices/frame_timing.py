"""Measure how evenly frames reach a device, how long packing takes, and how much data the bus carries.

The device is the backend's own model, in this process. The benchmark therefore measures the loop, the packing and the
model's response, but not USB.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import autd
from pacinian.plugins import registry
from pacinian.plugins.backend import Frame
from pacinian.rendering.clock import SystemClock
from pacinian.rendering.realtime_section import realtime_section
from pacinian.rendering.tick_pacing import pace
from pacinian_lab.solvers.tables import markdown_table, plain_table, short
from pacinian_lab.solvers.timing import measure, quantile

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.table import Table

    from pacinian.acoustics.array import Array
    from pacinian.types import Levels

BACKEND = "usb-autd"
GRIDS = (1, 1), (2, 2), (3, 3)  # units in x and y
# [B/s] maximum of bulk data over USB 2.0: packets per frame, bytes per packet, frames per second
FULL_SPEED = 19 * 64 * 1e3
HIGH_SPEED = 13 * 512 * 8e3
TICK = 1e-3  # [s] of the default loop


@dataclass(frozen=True)
class Load:
    """Load of frames on the bus.

    rows: rows sent per tick. size: of one tick [B]. rate: [B/s]. full, high: fractions of the capacity of full-speed
    and high-speed USB.
    """

    units: int
    rows: int
    size: int
    rate: float
    full: float
    high: float


@dataclass(frozen=True)
class Held:
    """A rate held for a while. Times [s]: how late a frame was started, and how long its `send` took.

    missed: ticks skipped. accepted, starved, overrun: the device's counts of frames. pack: time to pack a frame [s];
    over_copy: the same, relative to the time to copy its levels.
    """

    rate: float
    frames: int
    missed: int
    accepted: int
    starved: int
    overrun: int
    late: tuple[float, float, float]
    took: tuple[float, float, float]
    pack: float
    over_copy: float


def loads() -> Iterator[Load]:
    """Yield the loads of some arrays, with rows that differ and with equal rows."""
    for grid in GRIDS:
        array = autd(*grid)
        for rows in (2, 1):
            backend = _open(array)
            frame = _frame(array, 2, alike=rows == 1)
            size = sum(len(message) for message in backend.pack_frame(frame))
            backend.close()
            rate = size / TICK
            yield Load(grid[0] * grid[1], rows, size, rate, rate / FULL_SPEED, rate / HIGH_SPEED)


def measure_rate(rate: float, rows: int, seconds: float) -> Held:
    """Send frames of `rows` rows to nine units at a rate [Hz]."""
    array = autd(3, 3)
    backend, clock = _open(array), SystemClock()
    frames = [_frame(array, rows, seed=k) for k in range(8)]
    copy = measure(lambda: (frames[0].phase.copy(), frames[0].amplitude.copy()), 0.1)[1].p50
    pack = measure(lambda: backend.pack_frame(frames[0]), 0.1)[1].p50
    backend.close()
    backend = _open(array)
    late: list[float] = []
    took: list[float] = []
    missed = 0
    with realtime_section():
        for due, lost in pace(clock, 1.0 / rate, seconds):
            begin = clock.now()
            backend.send(frames[len(took) % len(frames)])
            took.append(clock.now() - begin)
            late.append(begin - due)
            missed += lost
    (status,) = (board.status() for board in backend.boards)
    backend.close()
    return Held(
        rate, len(took), missed, status.accepted, status.starved, status.overrun,
        _quantiles(late), _quantiles(took), pack, pack / copy,
    )  # fmt: skip


def _open(array: Array) -> Any:
    backend: Any = registry.backend(BACKEND, pretend=True)
    backend.open(array)
    return backend


def _frame(array: Array, rows: int, alike: bool = False, seed: int = 0) -> Frame:
    chance, shape = np.random.default_rng(seed), (1 if alike else rows, len(array))
    phase: Levels = chance.integers(0, 640, shape, np.uint16)
    amplitude: Levels = chance.integers(0, 320, shape, np.uint16)
    if alike:
        phase, amplitude = (np.repeat(levels, rows, axis=0) for levels in (phase, amplitude))
    return Frame(0, time.perf_counter(), phase, amplitude)


def _quantiles(times: list[float]) -> tuple[float, float, float]:
    times = sorted(times)
    return quantile(times, 0.5), quantile(times, 0.99), times[-1]


LOAD = "units", "rows sent", "bytes per tick", "MB/s", "% of full speed", "% of high speed"
HELD = (
    "ticks [Hz]", "frames sent", "ticks skipped", "frames accepted", "late frames", "early frames",
    "late by, p50 [ms]", "p99", "worst", "send took, p50 [ms]", "p99", "worst", "packing [µs]",
    "packing over copying levels",
)  # fmt: skip

Lines = list[list[str]]


def _loads(rows: Sequence[Load]) -> Lines:
    """Return a line for each load."""
    return [
        [
            str(row.units), str(row.rows), f"{row.size:,}", f"{1e-6 * row.rate:.2f}",
            *(f"{100.0 * share:.0f}" for share in (row.full, row.high)),
        ]
        for row in rows
    ]  # fmt: skip


def _helds(rows: Sequence[Held]) -> Lines:
    """Return a column for each rate."""
    columns = [
        [
            f"{row.rate:g}",
            *map(str, (row.frames, row.missed, row.accepted, row.starved, row.overrun)),
            *(short(1e3 * one) for one in (*row.late, *row.took)),
            short(1e6 * row.pack), short(row.over_copy),
        ]
        for row in rows
    ]  # fmt: skip
    return [list(line) for line in zip(HELD, *columns, strict=True)]


def _all(found: Sequence[Load], rates: Sequence[Held]) -> list[tuple[str, list[str], Lines]]:
    head, *lines = _helds(rates)
    return [
        ("Data on the bus, in ticks of 1 ms", list(LOAD), _loads(found)),
        ("Nine units, frames sent to their model", head, lines),
    ]


def tables(found: Sequence[Load], rates: Sequence[Held]) -> list[Table]:
    """Return tables for a terminal."""
    return [plain_table(*table) for table in _all(found, rates)]


def markdown(found: Sequence[Load], rates: Sequence[Held]) -> str:
    """Return Markdown tables."""
    return "\n\n".join(markdown_table(head, lines) for _, head, lines in _all(found, rates))
