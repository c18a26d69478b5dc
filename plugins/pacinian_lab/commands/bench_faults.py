"""`pacinian bench faults` and `pacinian bench hostile`: break and flood a server."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import print_tables

if TYPE_CHECKING:
    from pacinian_lab.server.faults.run import Row


@click.command()
@click.option(
    "--repeats", type=click.IntRange(1), default=5, show_default=True, help="Repeats of each fault."
)
@click.option(
    "--only", "words", multiple=True, help="Only faults whose name contains this word; repeatable."
)
@click.option(
    "--busy",
    type=click.IntRange(0),
    default=0,
    help="Number of processes that load the CPU meanwhile.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of a table.")
def faults(repeats: int, words: tuple[str, ...], busy: int, as_json: bool) -> None:
    """Break a real server in every known way and measure the time to silence and to recovery.

    Clients, the server's processes and devices are killed, stopped, frozen, cut off and unplugged while a game emits
    sound. A test device logs what it receives, so the times include the last link of the chain.
    """
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.server.faults.run import FAULTS, measure
    from pacinian_lab.server.faults.tables import faults as table

    chosen = [f for f in FAULTS if not words or any(word in f.name for word in words)]
    if not chosen:
        raise click.BadParameter("no fault has that word", param_hint="--only")
    rows: list[Row] = []
    with Progress(console=Console(stderr=True), transient=True, refresh_per_second=2) as bar:
        task = bar.add_task("starting", total=len(chosen))
        for row in measure(chosen, repeats, busy):
            rows.append(row)
            bar.update(task, advance=1, description=row.fault)
    if as_json:
        click.echo(json.dumps([asdict(row) for row in rows]))
    else:
        Console().print(table(rows))
        for row in rows:
            for note in (f"bound: {row.stated}", *row.notes):
                click.echo(f"- {row.fault}: {note}")
    if any(row.failed for row in rows):
        raise SystemExit(1)


@click.command()
@click.option(
    "--messages",
    type=click.IntRange(1),
    default=1_000_000,
    show_default=True,
    help="Total number of messages.",
)
@click.option(
    "--seconds", type=FiniteRange(1.0), default=300.0, show_default=True,
    help="Stop sending after this time.",
)  # fmt: skip
@click.option("--seed", type=int, default=1, show_default=True, help="Seed of the mutations.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
def hostile(messages: int, seconds: float, seed: int, as_json: bool) -> None:
    """Flood a real server with mutated messages, raw bytes and other protocols.

    A game emits sound meanwhile. The flood alternates with an equal CPU load that sends nothing to the server: gaps
    in that phase are due to the machine.
    """
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.server.fuzz import run, tables

    with Progress(console=Console(stderr=True), transient=True, refresh_per_second=2) as bar:
        task = bar.add_task("messages", total=messages)
        found = run.run(messages, seconds, seed, lambda done: bar.update(task, completed=done))
    judged = tables.verdicts(found)
    if as_json:
        result: dict[str, Any] = {
            "sent": found.flooded.sent, "codes": found.flooded.codes, "counts": found.counts,
            "growth": found.growth,
            "verdicts": [verdict._asdict() for verdict in judged],
        }  # fmt: skip
        click.echo(json.dumps(result))
    else:
        print_tables(
            [
                tables.phases(found),
                tables.tabulate_sent(found),
                tables.tabulate_errors(found),
                tables.memory(found),
                tables.tabulate_verdicts(found),
            ]
        )
    if not all(verdict.met for verdict in judged[1:]):
        raise SystemExit(1)
