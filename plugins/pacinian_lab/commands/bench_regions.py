"""`pacinian bench regions`: measure how even the pressure of surfaces and volumes is."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import make_folder, print_tables, require_matplotlib, units

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian_lab.regions.peers import Peers


@click.command()
@units
@click.option(
    "--shape", "chosen", multiple=True, metavar="NAME", help="Only this shape; repeatable."
)
@click.option(
    "--solver",
    "solvers",
    multiple=True,
    metavar="NAME",
    help="Also measure this solver; repeatable.",
)
@click.option(
    "--strength", "strengths", multiple=True, type=FiniteRange(0.0, 10.0, min_open=True),
    help="Fraction of the strongest even field; repeatable.  [default: 0.25, 0.5, 1]",
)  # fmt: skip
@click.option(
    "--peers", is_flag=False, flag_value="", metavar="[DIR]",
    help="Also measure autd3's gspat and greedy in the environment that `.ci/peers` builds in DIR.",
)  # fmt: skip
@click.option(
    "--cost", is_flag=True,
    help="Measure only the cost of a region of 60, 120 and 250 samples on 1 and 9 units.",
)  # fmt: skip
@click.option(
    "--contacts", is_flag=True,
    help="Measure only what a hand feels when it touches balls and an edge.",
)  # fmt: skip
@click.option(
    "--pictures", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
    help="Only draw the shapes into this folder, at half of the strongest even field.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of tables.")
def regions(
    side: int,
    chosen: tuple[str, ...],
    solvers: tuple[str, ...],
    strengths: tuple[float, ...],
    peers: str | None,
    cost: bool,
    contacts: bool,
    pictures: Path | None,
    as_json: bool,
) -> None:
    """Measure how even the pressure of surfaces and volumes is, at places that no solver was given.

    Each shape is made by regions, by free-phase foci 8.5 and 4.25 mm apart, and by one focus that sweeps the shape,
    of which the mean over time counts. docs/regions.md explains the figures.
    """
    from pacinian.acoustics.array import autd
    from pacinian.plugins.registry import discover_plugins
    from pacinian_lab.regions.shapes import SHAPES

    for name in chosen:
        if name not in SHAPES:
            raise click.BadParameter(
                f"{name!r} is not one of {'; '.join(SHAPES)}", param_hint="--shape"
            )
    for name in solvers:
        discover_plugins().find("solver", name)
    names = chosen or tuple(SHAPES)
    if cost:
        _measure_cost(as_json)
    elif contacts:
        _measure_contacts(autd(side, side), as_json)
    elif pictures is not None:
        _draw(autd(side, side), names, pictures)
    else:
        with contextlib.ExitStack() as stack:
            asked = None if peers is None else stack.enter_context(_start_peers(peers, side))
            _measure(autd(side, side), names, solvers, strengths, asked, as_json)


def _measure(
    array: Array,
    names: tuple[str, ...],
    solvers: tuple[str, ...],
    strengths: tuple[float, ...],
    peers: Peers | None,
    as_json: bool,
) -> None:
    from pacinian_lab.regions.run import STRENGTHS, measure
    from pacinian_lab.regions.tables import tabulate
    from pacinian_lab.solvers.report import replace_non_finite

    every = list[dict[str, Any]]()
    for name in names:
        rows = list(measure(array, name, solvers, strengths or STRENGTHS, peers))
        every += [replace_non_finite(row._asdict()) for row in rows]
        if not as_json:
            print_tables(tabulate(rows))
    if as_json:
        click.echo(json.dumps(every))


def _start_peers(given: str, side: int) -> Peers:
    """Start autd3's process.

    Raises UsageError, with the command that installs autd3, if it is not installed.
    """
    from pacinian_lab.regions.peers import PEER, Peers
    from pacinian_lab.solvers import peers
    from pacinian_lab.solvers.worker_process import Worker

    root = Path(given) if given else peers.find_folder()
    python = peers.find_python(root, PEER)
    if python is None:
        raise click.UsageError(peers.describe_missing(root, [PEER]))
    return Peers(Worker.of(PEER, str(python), threads=1), side)


def _measure_cost(as_json: bool) -> None:
    from rich.console import Console

    from pacinian_lab.regions.cost import measure_cost
    from pacinian_lab.regions.tables import tabulate_cost

    costs = list(measure_cost())
    if as_json:
        click.echo(json.dumps([cost._asdict() for cost in costs]))
    else:
        Console().print(tabulate_cost(costs))


def _measure_contacts(array: Array, as_json: bool) -> None:
    from pacinian_lab.regions.contacts import measure_contacts
    from pacinian_lab.regions.tables import tabulate_contacts

    found = list(measure_contacts(array))
    if as_json:
        click.echo(json.dumps([contact._asdict() for contact in found]))
    else:
        print_tables(tabulate_contacts(found))


def _draw(array: Array, names: tuple[str, ...], folder: Path) -> None:
    from pacinian_lab.regions.pictures import draw

    require_matplotlib()
    make_folder(folder, "--pictures")
    for path in draw(array, names, folder):
        click.echo(f"wrote {path}")
