"""What is to be reached, and in how many kinds of problems it is: ratios within one run."""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from pacinian_lab.solvers.run import OURS, REFERENCE
from pacinian_lab.solvers.summary import fastest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from pacinian_lab.solvers.rows import Row
    from pacinian_lab.solvers.summary import Key


@dataclass(frozen=True)
class Target:
    """Something to reach: `value` of a row and its rival's at most `limit`, where it applies.

    head: for a table; percent: whether it shows the value so.
    mode: of the row. rival: (solver, mode) of the row compared with, "" for the same solver; None for none.
    """

    name: str
    head: str
    limit: float
    value: Callable[[Row, Row], float]
    rival: tuple[str, str] | None = None
    applies: Callable[[Row], bool] = lambda row: True
    mode: str = "cold"
    percent: bool = False


GSPAT, LEVITATE = ("autd3-gspat", "cold"), ("levitate", "cold")
ROOFLINE, GEMM, SELF = ("roofline", REFERENCE), ("gemm", REFERENCE), ("", "cold")

TARGETS = (
    Target("level 0.5: error", "error\nL 0.5\n≤.01 %", 1e-4, lambda a, b: a.error,
           applies=lambda row: row.level == 0.5, percent=True),
    Target("level 0.5: scale off by", "scale\noff by\n≤.1 %", 1e-3, lambda a, b: abs(a.scale - 1.0),
           applies=lambda row: row.level == 0.5, percent=True),
    Target("level 0.5: time over autd3-gspat's", "time/\ngspat\n≤1", 1.0, lambda a, b: a.p50 / b.p50,
           GSPAT, lambda row: row.level == 0.5),
    Target("level 1.0: error over levitate's by", "error\n-lev.\n≤.01 %", 1e-4,
           lambda a, b: a.error - b.error, LEVITATE, lambda row: row.level == 1.0, percent=True),
    Target("level 1.0: mean sound pressure below levitate's by", "weaker\nby\n≤.1 %", 1e-3,
           lambda a, b: 1.0 - a.mean_pressure / b.mean_pressure, LEVITATE,
           lambda row: row.level == 1.0, percent=True),
    Target("level 1.0: time over levitate's", "time/\nlev.\n≤.02", 0.02, lambda a, b: a.p50 / b.p50,
           LEVITATE, lambda row: row.level == 1.0),
    Target("N M >= 35000: time over the roofline", "time/\nroof\n≤3", 3.0,
           lambda a, b: a.p50 / b.p50, ROOFLINE, lambda row: row.N * row.M >= 35_000),
    Target("level 0.5: time over cold where only the strength changed", "resc./\ncold\n≤.1", 0.1,
           lambda a, b: a.p50 / b.p50, SELF, lambda row: row.level == 0.5, mode="rescaled"),
    Target("p99/p50 over that of a fixed GEMM", "p99/50\n/gemm\n≤1.3", 1.3,
           lambda a, b: (a.p99 / a.p50) / (b.p99 / b.p50), GEMM, lambda row: row.samples >= 100),
)  # fmt: skip


@dataclass(frozen=True)
class Verdict:
    """How one of our solvers does against a target.

    met, of: kinds of problems (N, M, level). worst: the largest value of all; where: its problem.
    """

    target: Target
    solver: str
    met: int
    of: int
    worst: float
    where: str


def verdicts(rows: Sequence[Row]) -> list[Verdict]:
    """Of all our solvers, for all targets that something was measured for."""
    ours = dict.fromkeys(row.solver for row in rows if row.family == OURS)

    @functools.cache
    def find(solver: str, mode: str) -> dict[Key, Row]:
        return fastest(rows, solver, mode)

    found: list[Verdict] = []
    for solver in ours:
        for target in TARGETS:
            own = find(solver, target.mode)
            name, mode = target.rival or SELF
            if verdict := _verdict(target, solver, own, find(name or solver, mode)):
                found.append(verdict)
    return found


def _verdict(
    target: Target, solver: str, own: Mapping[Key, Row], rival: Mapping[Key, Row]
) -> Verdict | None:
    values: defaultdict[tuple[int, int, float], list[float]] = defaultdict(list)
    for key, row in own.items():
        if key in rival and target.applies(row):
            value = target.value(row, rival[key])
            values[key[:3]].append(math.inf if math.isnan(value) else value)
    if not values:
        return None
    medians = {place: median(found) for place, found in values.items()}
    (N, M, level), worst = max(medians.items(), key=lambda item: item[1])
    met = sum(value <= target.limit for value in medians.values())
    return Verdict(target, solver, met, len(medians), worst, f"N {N}, M {M}, level {level:g}")
