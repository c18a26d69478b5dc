"""`pacinian bench footprint`: measure what a server takes from a game."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import units

if TYPE_CHECKING:
    from rich.table import Table

    from pacinian_lab.server.footprint import Row


@click.command()
@click.option(
    "--seconds",
    type=FiniteRange(1.0, 600.0),
    default=5.0,
    show_default=True,
    help="Length of each window.",
)
@click.option(
    "--rounds", type=click.IntRange(1), default=3, show_default=True, help="Number of servers."
)
@units
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def footprint(seconds: float, rounds: int, side: int, as_json: bool) -> None:
    """Measure a server's wait until it is ready, its memory, and its share of the processor.

    Four states in turn: idle, armed with a still ball, a ball moved at 90 Hz, a hand moved over it at 90 Hz.
    """
    import msgspec
    from rich.console import Console

    from pacinian_lab.server.footprint import measure

    rows = list(measure(side, seconds, rounds))
    if as_json:
        click.echo(json.dumps({"units": side * side, "rows": msgspec.to_builtins(rows)}))
    else:
        Console().print(_tabulate(rows))


def _tabulate(rows: list[Row]) -> Table:
    from rich.table import Table

    names = list(rows[0].memory)
    head = "state", "ready [s]", "/ loop", *(f"{n} [MB]" for n in names), "all [MB]", "cores"
    made = Table(*head, "wake-ups [1/s]")
    for row in rows:
        made.add_row(
            row.state,
            f"{row.ready:.2f}",
            f"{row.ready / row.calibration:.0f}",
            *(f"{row.memory.get(name, 0.0):.0f}" for name in names),
            f"{sum(row.memory.values()):.0f}",
            f"{sum(row.cores.values()):.3f}",
            f"{sum(row.wakeups.values()):.0f}",
        )
    return made
