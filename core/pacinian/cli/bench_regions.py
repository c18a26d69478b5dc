"""`pacinian bench regions`: how evenly surfaces and volumes press."""

from __future__ import annotations

import json
import math

import click


@click.command()
@click.option(
    "--units", type=int, default=9, show_default=True, help="AUTD units, a square number."
)
@click.option(
    "--shape", "chosen", multiple=True, metavar="NAME", help="Only this one, again for more."
)
@click.option(
    "--solver", "solvers", multiple=True, metavar="NAME", help="Also this one, again for more."
)
@click.option(
    "--strength", "strengths", multiple=True, type=click.FloatRange(0.0, 10.0, min_open=True),
    help="Of the strongest even field, again for more.  [default: 0.25, 0.5, 1]",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of tables.")
def regions(
    units: int,
    chosen: tuple[str, ...],
    solvers: tuple[str, ...],
    strengths: tuple[float, ...],
    as_json: bool,
) -> None:
    """Measure surfaces and volumes at places that no solver was given: force, rms, holes, what presses beside.

    Beside regions: points of free phase 8.5 and 4.25 mm apart, and one focus that sweeps the shape, whose mean counts.
    """
    from rich.console import Console

    from pacinian.acoustics.array import autd
    from pacinian.bench.regions import SHAPES, STRENGTHS, measure, table
    from pacinian.plugins.registry import installed

    side = math.isqrt(max(units, 0))
    if side * side != units or not units:
        raise click.BadParameter(f"must be 1, 4, 9, ..., not {units}", param_hint="--units")
    for name in chosen:
        if name not in SHAPES:
            raise click.BadParameter(
                f"{name!r} is none of {'; '.join(SHAPES)}", param_hint="--shape"
            )
    for name in solvers:
        installed().find("solver", name)
    array, console = autd(side, side), Console()
    every = []
    for name in chosen or SHAPES:
        rows = list(measure(array, name, solvers, strengths or STRENGTHS))
        every += [row._asdict() for row in rows]
        if not as_json:
            console.print(table(name, rows))
            console.print()
    if as_json:
        click.echo(json.dumps(every))
