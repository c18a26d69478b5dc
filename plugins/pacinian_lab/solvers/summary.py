"""What the rows say: medians of the fastest setting of threads, and how run time grows."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from pacinian_lab.solvers.run import REFERENCE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from pacinian_lab.solvers.rows import Row

Key = tuple[int, int, float, int]  # N, M, level, seed


@dataclass(frozen=True)
class Cell:
    """One solver on one kind of problem: medians over the seeds, of the fastest setting of threads.

    Fields as in `rows.Row`. note: empty, or why nothing was measured.
    """

    family: str
    solver: str
    mode: str
    N: int
    M: int
    level: float
    note: str
    threads: int = 0
    p50: float = math.nan
    p99: float = math.nan
    error: float = math.nan
    error_8bit: float = math.nan
    scale: float = math.nan
    mean_pressure: float = math.nan


def fastest(rows: Iterable[Row], solver: str, mode: str) -> dict[Key, Row]:
    """For each problem the row of the number of threads that took least."""
    best: dict[Key, Row] = {}
    for row in rows:
        key = (row.N, row.M, row.level, row.seed)
        if (row.solver, row.mode, row.ok) == (solver, mode, True) and (
            key not in best or row.p50 < best[key].p50
        ):
            best[key] = row
    return best


def cells(rows: Sequence[Row]) -> list[Cell]:
    """All cells, in the order of the rows."""
    groups: defaultdict[tuple[str, str, str, int, int, float], list[Row]] = defaultdict(list)
    for row in rows:
        groups[row.family, row.solver, row.mode, row.N, row.M, row.level].append(row)
    return [_cell(found) for found in groups.values()]


def _cell(rows: list[Row]) -> Cell:
    first = rows[0]
    place = (first.family, first.solver, first.mode, first.N, first.M, first.level)
    best = list(fastest(rows, first.solver, first.mode).values())
    if not best:
        return Cell(*place, note=first.status)
    threads = Counter(row.threads for row in best).most_common(1)[0][0]
    names = ("p50", "p99", "error", "error_8bit", "scale", "mean_pressure")
    return Cell(
        *place, "", threads, **{name: median(getattr(row, name) for row in best) for name in names}
    )


@dataclass(frozen=True)
class Growth:
    """How a solver's run time grows: times [s] for sizes, and the exponent of the line through them.

    along: "N" or "M"; fixed: the other one.
    """

    family: str
    solver: str
    along: str
    fixed: int
    level: float
    sizes: tuple[int, ...]
    times: tuple[float, ...]

    @property
    def exponent(self) -> float:
        """Of time ~ size^exponent, by least squares of the logarithms."""
        return float(np.polyfit(np.log(self.sizes), np.log(self.times), 1)[0])


def growth(found: Iterable[Cell]) -> list[Growth]:
    """Along N for the middle M, and along M for the largest N, at the lowest level, cold; and the roofline's."""
    measured = [
        c for c in found if not c.note and c.mode in ("cold", REFERENCE) and c.solver != "gemm"
    ]
    if not measured:
        return []
    level = min(c.level for c in measured)
    measured = [c for c in measured if c.level == level]
    counts = sorted({c.M for c in measured})
    fixed = {"N": counts[len(counts) // 2], "M": max(c.N for c in measured)}
    lines: list[Growth] = []
    for along, other in (("N", "M"), ("M", "N")):
        for family, solver in dict.fromkeys((c.family, c.solver) for c in measured):
            points = sorted(
                (getattr(c, along), c.p50)
                for c in measured
                if c.solver == solver and getattr(c, other) == fixed[along]
            )
            if len(points) > 1:
                sizes, times = zip(*points, strict=True)
                lines.append(Growth(family, solver, along, fixed[along], level, sizes, times))
    return lines
