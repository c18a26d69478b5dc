"""`pacinian stress`: check that every solver keeps its guarantees on hard problems."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian_lab.stress.check import Evidence
    from pacinian_lab.stress.run import Row

MOVES = (10_000, 100_000)  # moves of single points, in a quick and in a full run
MAX_LISTED = 10  # number of broken guarantees printed in full
COLUMNS = {"family": 10, "solver": 14, "guarantees": 14, "excess": 8, "residual": 8}
NOTE = (
    "excess: the largest |g| minus the limit. residual: largest ratio to the best possible residual,"
    " within the precision of B; blank where none is guaranteed."
)


@click.command()
@click.option("--solvers", default="", help="Only these, separated by commas.  [default: all]")
@click.option("--quick", is_flag=True, help="Every fifth problem, without the slow ones.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def stress(solvers: str, quick: bool, as_json: bool) -> None:
    """Check every solver on hard problems.

    Checks its guarantees and shows the worst evidence. The problems have coincident points, points on and behind
    transducers, arrays of low rank, condition numbers up to 1e16, targets from 1e-30 to 1e30 Pa, limits of every kind,
    and endless moves. docs/stability.md lists the guarantees. Every solver, also of other plug-ins, must return finite
    gains within the limits. Exit code 1 if a guarantee is broken.
    """
    from pacinian.argument_checks import check_names
    from pacinian.errors import ArgumentError
    from pacinian_lab.stress.run import rows

    try:
        names = check_names("--solvers", solvers)
    except ArgumentError as error:
        raise click.BadParameter(str(error)) from error
    found = _run(names, quick)
    table = rows(found)
    broken = [e for e in found if e.broken]
    if as_json:
        click.echo(json.dumps(_plain(table, broken, quick)))
    else:
        _print(table, broken)
    if broken:
        raise SystemExit(1)


def _run(names: Sequence[str], quick: bool) -> list[Evidence]:
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.stress import run
    from pacinian_lab.stress.cases import cases

    chosen = names or run.solvers()
    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("making the problems", total=None)
        problems = cases(quick)
        total = len(problems) * len(chosen)

        def advance(what: str) -> None:
            progress.update(task, advance=1, total=total, description=what[:50])

        found = run.run(chosen, problems, advance)
        progress.update(task, description="moving points", total=None)
        return [*found, run.drift(MOVES[not quick])]


def _print(table: Sequence[Row], broken: Sequence[Evidence]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    shown = Table(box=SIMPLE_HEAD, collapse_padding=True, pad_edge=False)
    for name, width in COLUMNS.items():
        shown.add_column(name, no_wrap=True, min_width=width)
    shown.add_column("worst", no_wrap=True, overflow="ellipsis")
    family = ""
    for row in table:
        verdict = f"{row.problems} kept"
        if row.broken:
            verdict = f"{len(row.broken)} of {row.problems} broken"
        cells = [row.family if row.family != family else "", row.solver, verdict]
        cells += [_figure(row.excess), _figure(row.ratio), row.where]
        shown.add_row(*map(Text, cells), style="bold red" if row.broken else "")
        family = row.family
    console.print(shown)
    console.print(NOTE, highlight=False, markup=False)
    for e in broken[:MAX_LISTED]:
        for guarantee, figure in e.broken.items():
            console.print(f"\n{e.solver} breaks {guarantee!r}: {figure}", style="red", markup=False)
            again = f'pacinian_lab.stress.cases.find("{e.case}").solve("{e.solver}")'
            console.print(again, highlight=False, markup=False, soft_wrap=True)
    if len(broken) > MAX_LISTED:
        console.print(f"\nand {len(broken) - MAX_LISTED} more: see --json")


def _figure(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.2g}"


def _plain(table: Sequence[Row], broken: Sequence[Evidence], quick: bool) -> dict[str, Any]:
    """Return the run for JSON, with null for values that are not finite."""
    from pacinian_lab.solvers.report import replace_non_finite
    from pacinian_lab.stress import guarantees

    summaries = [{**asdict(row), "broken": len(row.broken)} for row in table]
    return {
        "quick": quick,
        "guarantees": {**guarantees.EVERY, **guarantees.OURS, **guarantees.PROPAGATOR},
        "rows": [replace_non_finite(row) for row in summaries],
        "broken": [replace_non_finite(asdict(e)) for e in broken],
    }
