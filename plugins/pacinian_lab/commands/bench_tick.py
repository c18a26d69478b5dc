"""`pacinian bench tick`: divide the time of a tick into kernels, Python and the wake-up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.bench_scenes import names
from pacinian_lab.commands.shared import units

if TYPE_CHECKING:
    from rich.table import Table

    from pacinian_lab.scenes.tick_parts import Part, Row


@click.command()
@units
@click.option(
    "--seconds",
    type=FiniteRange(0.1, 600.0),
    default=5.0,
    show_default=True,
    help="Time to tick each scene; a loop that only sleeps runs as long again.",
)
@click.option(
    "--scene", "chosen", multiple=True, callback=names, metavar="NAME",
    help="Only this scene; repeatable.  [default: all]",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of tables.")
def tick(side: int, seconds: float, chosen: tuple[str, ...], as_json: bool) -> None:
    """Measure what a tick of each built-in scene consists of, at 1 kHz.

    Kernels are compiled functions, LAPACK and BLAS; Python is all the rest. Wake-up is the delay with which a tick
    begins; the dummy loop only sleeps. Compare machines by the ratios to the calibration loop of the same run.
    """
    import msgspec
    from rich.console import Console

    from pacinian.acoustics.array import autd
    from pacinian.gallery import SCENES
    from pacinian_lab.scenes.tick_parts import measure

    array = autd(side, side)
    rows: list[Row] = []
    for name in chosen or tuple(SCENES):
        rows.append(measure(array, name, seconds))
        if not as_json:
            Console().print(_tabulate(rows[-1]))
    if as_json:
        click.echo(msgspec.json.encode(rows))  # not a number is null


def _tabulate(row: Row) -> Table:
    from pacinian_lab.solvers.tables import plain_table

    parts = {
        f"{stage}, {kind}": part
        for kind in ("total", "kernels", "python")
        for stage, part in getattr(row, kind).items()
    }
    parts |= {
        "tick, processor time": row.processor,
        "wake-up": row.wakeup,
        "wake-up, dummy loop": row.dummy,
    }
    title = f"{row.scene}: {row.ticks} ticks, {row.late:.0%} late; a loop of {1e3 * row.calibration:.1f} ms"
    head = ["[ms]", "p50", "p99", "p99.9", "p50 / loop"]
    return plain_table(title, head, [_line(n, p, row.calibration) for n, p in parts.items()])


def _line(name: str, part: Part, calibration: float) -> list[str]:
    if math.isnan(part.p50):
        return [name, "", "", "", ""]
    numbers = [f"{1e3 * x:.3f}" for x in (part.p50, part.p99, part.p999)]
    return [name, *numbers, f"{part.p50 / calibration:.4f}"]
