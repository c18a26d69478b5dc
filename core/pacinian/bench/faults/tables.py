"""Faults as a table for a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.bench.tables import plain_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from pacinian.bench.faults.run import Row


def faults(rows: Sequence[Row]) -> Table:
    """Fault by worst time to silence, worst recovery and worst gap, beside what is stated."""
    head = [
        "",
        "times",
        "silent\n[ms]",
        "bound\n[ms]",
        "sounds again\n[ms]",
        "gap\n[ms]",
        "bound is",
    ]
    table = [
        [row.fault, str(len(row.times)), str(len(row.failed) or "")]
        + [milliseconds(row.worst("silence")), milliseconds(row.bound)]
        + [milliseconds(row.worst(name)) for name in ("recovery", "gap")]
        for row in rows
    ]
    return plain_table("Faults: the worst of all times", head, table)


def milliseconds(seconds: float) -> str:
    """In ms, or nothing where there is none."""
    return "" if math.isnan(seconds) else f"{1e3 * seconds:.1f}"
