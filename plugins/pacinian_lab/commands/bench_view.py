"""`pacinian bench view`: measure how the live viewer loads the loop."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import units

if TYPE_CHECKING:
    from pacinian_lab.server.viewer import Row


def program(context: click.Context, parameter: click.Parameter, name: str) -> str:
    """Check that a program of this name or path exists; "" passes."""
    if name and shutil.which(name) is None:
        raise click.BadParameter(f"{name!r} is not a program: give the path of a Chromium")
    return name


@click.command()
@click.option(
    "--seconds",
    type=FiniteRange(2.0, 600.0),  # the server sends quantiles once per second
    default=8.0,
    show_default=True,
    help="Length of each window.",
)
@click.option(
    "--rounds", type=click.IntRange(1), default=3, show_default=True, help="Rounds of windows."
)
@units
@click.option(
    "--browser", callback=program, default="", metavar="PATH",
    help="Also open the page in this Chromium.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def view(seconds: float, rounds: int, side: int, browser: str, as_json: bool) -> None:
    """Measure the loop's ticks with the viewer closed, open, and open with a 128 x 128 slice, in turn.

    A client that is not a browser reads all that the viewer sends. With --browser, a real browser shows the page in
    further windows. It then plays a recording alone, without a server, as fast as it can draw, which gives the frame
    rate.
    """
    import msgspec

    from pacinian.cli.serve import check_viewer
    from pacinian_lab.server.viewer import measure

    check_viewer()

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
