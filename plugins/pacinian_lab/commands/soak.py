"""`pacinian soak`: play with a server for a long time."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import print_tables, require_matplotlib, units
from pacinian_lab.server import soak_drift

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian_lab.scenes.report import Verdict
    from pacinian_lab.server.soak import Row

SHORT = 10.0  # [s]


@click.command()
@click.option(
    "--minutes", type=FiniteRange(0.05, 10_000.0), default=20.0, show_default=True,
    help="Length of the run.",
)  # fmt: skip
@click.option("--short", is_flag=True, help="About 10 seconds instead.")
@units
@click.option(
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Also draw memory, ticks and ages over time into this PNG.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
def soak(minutes: float, short: bool, side: int, picture: Path | None, as_json: bool) -> None:
    """Play with a server for a long time.

    Nothing may grow, drift or become late. A hand moves, objects come and go, solvers change, clients join, leave and
    are killed, malformed messages arrive, and the output is disarmed, stopped and armed again. Exit code 1 if the
    server misses a target.
    """
    from pacinian_lab.solvers.report import about

    if picture is not None:
        require_matplotlib()
    rows, interrupted = _measure(side, SHORT if short else 60.0 * minutes)
    found = soak_drift.verdicts(rows) if rows else []
    if picture is not None and rows:
        _draw(rows, picture)
    if as_json:
        import msgspec

        result = {
            **about(),
            "interrupted": interrupted,
            "targets": [asdict(verdict) for verdict in found],
            "rows": msgspec.to_builtins(rows),
        }
        click.echo(json.dumps(result))
    elif rows:
        _print(rows, found)
    if interrupted:
        raise SystemExit(130)
    if not all(verdict.met for verdict in found):
        raise SystemExit(1)


def _measure(side: int, seconds: float) -> tuple[list[Row], bool]:
    """Return the rows, and whether Ctrl-C interrupted the run."""
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.server.soak import measure

    rows: list[Row] = []
    with Progress(console=Console(stderr=True), transient=True, auto_refresh=False) as bar:
        task = bar.add_task("soak", total=seconds)
        try:
            for row in measure(side, seconds):
                rows.append(row)
                bar.update(task, completed=row.t)
                bar.refresh()
        except KeyboardInterrupt:
            return rows, True
    return rows, False


def _draw(rows: Sequence[Row], path: Path) -> None:
    from pacinian.errors import MissingExtra
    from pacinian_lab.server.soak_picture import draw

    try:
        draw(rows, path)
    except (MissingExtra, OSError) as error:
        click.echo(f"no picture: {error}", err=True)


def _print(rows: Sequence[Row], verdicts: Sequence[Verdict]) -> None:
    from pacinian_lab.scenes import tables as scene_tables
    from pacinian_lab.server import tables

    print_tables([tables.windows(rows), tables.events(rows), scene_tables.verdicts(verdicts)])
