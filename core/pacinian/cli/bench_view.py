"""`pacinian bench view`: what the live viewer costs the loop."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from pacinian.cli.bench_bus import side

if TYPE_CHECKING:
    from pacinian.bench.view import Row


@click.command()
@click.option(
    "--seconds",
    type=click.FloatRange(1.0, 600.0),
    default=8.0,
    show_default=True,
    help="Of each window.",
)
@click.option("--rounds", type=click.IntRange(1), default=3, show_default=True, help="Of windows.")
@click.option(
    "--units", "side", callback=side, type=int, default=9, show_default=True,
    help="AUTD units, a square number.",
)  # fmt: skip
@click.option("--browser", default="", metavar="PATH", help="A Chromium to open the page in, too.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def view(seconds: float, rounds: int, side: int, browser: str, as_json: bool) -> None:
    """Measure the loop's ticks with the viewer closed, open, and open with a slice of 128 x 128, in turn.

    A page that is no browser reads all that it is sent; with --browser a real one does, in windows of its own.
    """
    import msgspec

    from pacinian.bench.view import measure

    rows: list[Row] = []
    for row in measure(side, seconds, rounds, browser):
        rows.append(row)
        if not as_json:
            click.echo(
                f"{row.how:8} p50 {row.p50:6.3f} ms, p99 {row.p99:6.3f} ms, "
                f"sounding {row.sounding:4.0%}, late {row.late:6.2%}, {row.states:5.1f} states/s, "
                f"{row.slices:5.1f} slices/s, {row.cpu:4.2f} cores"
            )
    if as_json:
        click.echo(json.dumps({"units": side * side, "rows": msgspec.to_builtins(rows)}))
