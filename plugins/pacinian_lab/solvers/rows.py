"""The measurements, one row each: written as CSV during the run."""

from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

from pacinian.closeable import Closeable

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True)
class Row:
    """One entry on one problem.

    family: "pacinian", a peer, or "reference". mode: "cold", "warm" (all points have moved by 1 mm), "one moved",
    "rescaled" (only the strength has changed) or "reference". threads: maximum number of threads. units, N, M, level,
    seed: the problem. p50, p99: run time [s] of `samples` solves. error, scale, mean_pressure [Pa]: see
    `score.Score`; error_8bit: after rounding to 8 bits. drive: largest |g| as returned. traced: peak memory of one
    solve that Python tracks [bytes]; resident: peak memory of the process so far [bytes]. status: "ok", or the
    failure; the numbers are then NaN.
    """

    family: str
    solver: str
    mode: str
    threads: int
    units: int
    N: int
    M: int
    level: float
    seed: int
    status: str = "ok"
    p50: float = math.nan
    p99: float = math.nan
    samples: int = 0
    error: float = math.nan
    error_8bit: float = math.nan
    scale: float = math.nan
    mean_pressure: float = math.nan
    drive: float = math.nan
    traced: float = math.nan
    resident: float = math.nan

    @property
    def ok(self) -> bool:
        """Whether the measurement succeeded."""
        return self.status == "ok"


COLUMNS = [field.name for field in fields(Row)]


class Writer(Closeable):
    """Writes rows to a CSV file and flushes each row, so that an interrupted run keeps its measurements."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("w", newline="", encoding="utf-8")
        self._writer = csv.DictWriter(self._file, COLUMNS)
        self._writer.writeheader()
        self._file.flush()

    def write(self, row: Row) -> None:
        """Append a row."""
        self._writer.writerow(asdict(row))
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()
