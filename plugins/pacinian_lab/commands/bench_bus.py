"""`pacinian bench bus`: measure the server's latency and load, with real processes and sockets."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import print_tables, units

if TYPE_CHECKING:
    from pacinian_lab.server.latency_sender import Times
    from pacinian_lab.server.load import Final, Row

What = Literal["latency", "load", "all"]


@click.command()
@click.argument("what", type=click.Choice(["latency", "load", "all"]), default="all")
@click.option(
    "--seconds",
    type=FiniteRange(1.0, 3600.0),
    default=60.0,
    show_default=True,
    help="Time to measure each rate; runs for comparison take a quarter.",
)
@units
@click.option(
    "--clients", type=int, multiple=True, default=(1, 8, 64), show_default=True,
    help="Number of clients that load the server; repeatable.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
def bus(what: What, seconds: float, side: int, clients: tuple[int, ...], as_json: bool) -> None:
    """Measure a server that runs in its own processes: the latency of what the hand feels, and the load it sustains.

    latency: from sending a hand pose to emitting the frame, at 90 Hz and at 1 kHz, compared with the round trip of a
    bare ROUTER and DEALER. load: 1, 8 and 64 clients, with 10,000 and with 100,000 messages per second in total.
    """
    from pacinian_lab.server import report

    found, interrupted = _measure(what, side, seconds, clients)
    if as_json:
        result = report.plain(*found, units=side * side, seconds=seconds, interrupted=interrupted)
        click.echo(json.dumps(result))
    else:
        _print(found)
    if interrupted:
        raise SystemExit(130)


class Found(NamedTuple):
    """The results of all measurements."""

    times: list[Times]
    rows: list[Row]
    finals: list[Final]


def _measure(what: What, side: int, seconds: float, clients: tuple[int, ...]) -> tuple[Found, bool]:
    """Return the results, and whether Ctrl-C interrupted the run."""
    from pacinian_lab.server import latency, load

    found = Found([], [], [])
    try:
        if what != "load":
            for times in latency.measure(side, seconds):
                found.times.append(times)
                click.echo(f"hands at {times.rate:g} Hz measured", err=True)
        if what != "latency":
            for count in clients:
                for row in load.measure(side, seconds, count):
                    if isinstance(row, load.Row):
                        found.rows.append(row)
                        click.echo(f"{count} clients at {row.rate:g}/s measured", err=True)
                    else:
                        found.finals.append(row)
    except KeyboardInterrupt:
        return found, True
    return found, False


def _print(found: Found) -> None:
    from pacinian_lab.scenes import tables as scene_tables
    from pacinian_lab.server import report, tables

    shown: list[Any] = []
    if found.times:
        shown += tables.latency(found.times)
    if found.rows:
        shown += tables.load_(found.rows)
    verdicts = [*report.latency(found.times), *report.load(found.rows, found.finals)]
    print_tables([*shown, scene_tables.verdicts(verdicts)])
