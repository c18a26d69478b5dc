"""Results of the regions benchmark, as tables for a terminal, 80 columns wide."""

from __future__ import annotations

import math
from itertools import groupby
from typing import TYPE_CHECKING

from pacinian_lab.solvers.tables import plain_table, short

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rich.table import Table

    from pacinian_lab.regions.contacts import Contact
    from pacinian_lab.regions.cost import Cost
    from pacinian_lab.regions.run import Row


def tabulate(rows: Iterable[Row]) -> Iterator[Table]:
    """Yield a table for each shape and strength. Percentages are of the request."""
    head = [
        "[%]", "points", "force", "rms", "scaled\nrms", "holes", "spill", "at\nlimit", "status",
    ]  # fmt: skip
    for (name, strength, pressure), group in groupby(
        rows, lambda row: (row.shape, row.strength, row.pressure)
    ):
        lines = [
            [
                row.way, str(row.samples), f"{100 * row.force:.0f}", f"{100 * row.rms:.1f}",
                f"{100 * row.scaled_rms:.1f}", f"{100 * row.holes:.0f}",
                "" if math.isnan(row.beside) else f"{100 * row.beside:.0f}",
                f"{100 * row.saturation:.0f}", row.status,
            ]
            for row in group
        ]  # fmt: skip
        title = f"{name}: {short(pressure)} Pa, {strength:g} of the strongest even field"
        yield plain_table(title, head, lines)


def tabulate_cost(costs: Iterable[Cost]) -> Table:
    """Return the table of costs."""
    head = [
        "transducers", "samples", "cold\n[ms]", "warm\n[ms]", "corrected\n[ms]", "B alone\n[ms]", "steps\ncold",
        "steps\nwarm", "at limit\n[%]",
    ]  # fmt: skip
    lines = [
        [
            str(cost.transducers), str(cost.samples), f"{cost.cold_ms:.2f}", f"{cost.warm_ms:.2f}",
            f"{cost.corrected_ms:.2f}", f"{cost.build_ms:.2f}", str(cost.cold_steps), f"{cost.warm_steps:g}",
            f"{100 * cost.saturation:.0f}",
        ]
        for cost in costs
    ]  # fmt: skip
    return plain_table("One solve of one region, at half of the strongest even field", head, lines)


def tabulate_contacts(contacts: Iterable[Contact]) -> Iterator[Table]:
    """Yield a table for each contact. Percentages are of the request."""
    head = ["[%]", "points", "force", "rms", "holes", "spill", "at\nlimit"]
    for name, group in groupby(contacts, lambda contact: contact.contact):
        lines = [
            [
                made.way, str(made.samples), f"{100 * made.force:.0f}", f"{100 * made.rms:.1f}",
                f"{100 * made.holes:.0f}", f"{100 * made.beside:.0f}", f"{100 * made.saturation:.0f}",
            ]
            for made in group
        ]  # fmt: skip
        yield plain_table(f"{name}, over all touched skin", head, lines)
