"""`pacinian bench batches`: measure batches of solves on cores and on GPUs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from pacinian.cli.options import FiniteRange

if TYPE_CHECKING:
    from pacinian_lab.solvers.batches import Row


@click.command()
@click.option(
    "--units",
    type=click.IntRange(1),
    default=4,
    show_default=True,
    help="AUTD units, a square number.",
)
@click.option(
    "--points",
    type=click.IntRange(1),
    default=16,
    show_default=True,
    help="Points of each problem.",
)
@click.option(
    "--problems",
    type=click.IntRange(1),
    default=512,
    show_default=True,
    help="Problems of the batch.",
)
@click.option(
    "--field",
    type=click.IntRange(1),
    default=100_000,
    show_default=True,
    help="Points of the field.",
)
@click.option(
    "--seconds",
    type=FiniteRange(0.0, 600.0),
    default=2.0,
    show_default=True,
    help="Time to measure each contestant.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of tables.")
def batches(
    units: int, points: int, problems: int, field: int, seconds: float, as_json: bool
) -> None:
    """Measure many solves at once, and one large field.

    The contestants are Pacinian's own kernels, on one core and on all, and `pacinian.array_api` with each installed
    array library, on each of its devices. Compare machines by the ratios to the first row of each table.
    """  # fmt: skip
    import msgspec
    from rich.console import Console

    from pacinian.errors import ArgumentError
    from pacinian_lab.solvers.batches import measure
    from pacinian_lab.solvers.tables import plain_table

    try:
        rows = list(measure(units, points, problems, field, seconds))
    except ArgumentError as error:
        raise click.UsageError(str(error)) from error
    if as_json:
        click.echo(msgspec.json.encode(rows))
        return
    for job, title in (
        ("solve", f"{problems} problems of {points} points, {units} units"),
        ("field", f"the field at {field} points, {units} units"),
    ):
        mine = [row for row in rows if row.job == job]
        head = ["", "all\n[ms]", "each\n[us]", "times\nas fast", "error"]
        Console().print(plain_table(title, head, [_line(row, mine[0]) for row in mine]))


def _line(row: Row, first: Row) -> list[str]:
    ms, each = 1e3 * row.seconds, 1e6 * row.seconds / row.count
    return [
        row.contestant, f"{ms:.1f}", f"{each:.3g}", f"{first.seconds / row.seconds:.2f}", f"{row.error:.1e}",
    ]  # fmt: skip
