"""Tables of the rows, for a terminal or for a document."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian_lab.examples.score import score
from pacinian_lab.solvers.tables import markdown_table, plain_table, short

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from pacinian_lab.examples.examples import Example
    from pacinian_lab.examples.run import Row

HEAD = ["", "time [ms]", "peaks [Pa]", "error [%]", "offset [mm]", "quiet [%]"]


def tabulate(rows: Sequence[Row], examples: Sequence[Example]) -> list[Table]:
    """Return a table for each example."""
    return [
        plain_table(f"{made.title} ({made.source})", HEAD, _cells(rows, made))
        for made in examples
        if any(row.example == made.name for row in rows)
    ]


def write_markdown(rows: Sequence[Row], examples: Sequence[Example]) -> str:
    """Return one table of all examples in Markdown."""
    lines = [
        ["" if k else made.title, *cells]
        for made in examples
        for k, cells in enumerate(_cells(rows, made))
    ]
    return markdown_table(["example", "solved by", *HEAD[1:]], lines)


def _cells(rows: Sequence[Row], example: Example) -> list[list[str]]:
    found: list[list[str]] = []
    for row in (row for row in rows if row.example == example.name):
        made, alone = score(example, row.gains), example.points.shape[:2] == (1, 1)
        found.append(
            [
                row.way,
                short(1e3 * row.p50),
                f"{made.strength:.0f}",
                "" if alone else short(100.0 * made.error),
                f"{1e3 * made.offset:.2f}",
                "" if math.isnan(made.quiet) else short(100.0 * made.quiet),
            ]
        )
    return found
