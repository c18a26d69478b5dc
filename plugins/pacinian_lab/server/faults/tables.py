"""Faults as a table for a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian_lab.solvers.tables import plain_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from pacinian_lab.server.faults.run import Row


def faults(rows: Sequence[Row]) -> Table:
    """Fault by worst times, beside what is stated; gaps beside those of the same run undisturbed."""
    head = [
        "",
        "times",
        "silent",
        "bound",
        "again",
        "gap:\nmedian",
        "\nworst",
        "undisturbed:\nmedian",
        "\nworst",
    ]
    table = [
        [row.fault, str(len(row.times)) + f", {len(row.failed)} failed" * bool(row.failed)]
        + [milliseconds(s) for s in (row.worst("silence"), row.bound, row.worst("recovery"))]
        + [
            milliseconds(f(name))
            for name in ("gap", "undisturbed")
            for f in (row.median, row.worst)
        ]
        for row in rows
    ]
    return plain_table("Faults: the worst of all times [ms]", head, table)


def milliseconds(seconds: float) -> str:
    """In ms, or nothing where there is none."""
    return "" if math.isnan(seconds) else f"{1e3 * seconds:.1f}"
