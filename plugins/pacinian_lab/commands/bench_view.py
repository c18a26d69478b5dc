"""`pacinian bench view`: what the live viewer costs the loop."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import click

from pacinian_lab.commands.bench_server import side

if TYPE_CHECKING:
    from pacinian_lab.server.viewer import Row


def program(context: click.Context, parameter: click.Parameter, name: str) -> str:
    """Of that name or path; "" stays."""
    if name and shutil.which(name) is None:
        raise click.BadParameter(f"{name!r} is no program: give the path of a Chromium")
    return name


@click.command()
@click.option(
    "--seconds",
    type=click.FloatRange(2.0, 600.0),  # quantiles come once a second
    default=8.0,
    show_default=True,
    help="Of each window.",
)
@click.option("--rounds", type=click.IntRange(1), default=3, show_default=True, help="Of windows.")
@click.option(
    "--units", "side", callback=side, type=int, default=9, show_default=True,
    help="AUTD units, a square number.",
)  # fmt: skip
@click.option(
    "--browser", callback=program, default="", metavar="PATH",
    help="A Chromium to open the page in, too.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def view(seconds: float, rounds: int, side: int, browser: str, as_json: bool) -> None:
    """Measure the loop's ticks with the viewer closed, open, and open with a slice of 128 x 128, in turn.

    A page that is no browser reads all that it is sent. With --browser a real one shows it, in windows of its own; and
    then alone, without a server, a recording, drawing all that it can: how many frames a second that are.
    """
    import msgspec

    from pacinian_lab.server.viewer import measure

    rows: list[Row] = []
    for row in measure(side, seconds, rounds, browser):
        rows.append(row)
        if not as_json:
            click.echo(_line(row))
    if as_json:
        click.echo(json.dumps({"units": side * side, "rows": msgspec.to_builtins(rows)}))


def _line(row: Row) -> str:
    ticks = row.ticks
    loop = (
        f"p50 {ticks.p50:6.3f} ms, p99 {ticks.p99:6.3f} ms, sounding {ticks.sounding:4.0%}, late {ticks.late:6.2%}"
        if ticks
        else "no server" + 47 * " "
    )
    cores = f"viewer {row.viewer:4.2f}, browser {row.browser:4.2f} cores"
    return f"{row.how:8} {loop}, {row.frames:5.1f} frames/s, {row.slices:5.1f} slices/s, {cores}"
