"""`pacinian watch`."""

from __future__ import annotations

import json
import math
import time
from contextlib import suppress
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import CONNECTION, FiniteRange
from pacinian.cli.status import make_table, plain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.client.client import Client
    from pacinian.wire.state import State

REFRESH = 0.1  # period of redraws [s]


@click.command()
@CONNECTION
@click.option(
    "--seconds",
    type=FiniteRange(0),
    default=None,
    help="Duration.  [default: until Ctrl-C]",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object per state, one per line.")
def watch(connection: str | None, seconds: float | None, as_json: bool) -> None:
    """Show the status of a server continuously."""
    from pacinian.client.client import Client

    with Client(connection, name="pacinian watch") as client:
        states = _states(client, math.inf if seconds is None else seconds)
        if as_json:
            for state in states:
                click.echo(json.dumps(plain(state)))
        else:
            _show(states)


def _states(client: Client, seconds: float) -> Iterator[State]:
    """Yield the newest states."""
    from pacinian.errors import Refused

    end = time.perf_counter() + seconds
    for state in client.watch():
        with suppress(Refused):  # the state shows what happened to the output
            client.renew()  # keeps the session alive
        yield state
        if time.perf_counter() >= end:
            return


def _show(states: Iterator[State]) -> None:
    from rich.live import Live

    from pacinian.cli.console import make_console

    drawn = -math.inf
    with Live(console=make_console(), auto_refresh=False) as live:
        for state in states:
            if (now := time.perf_counter()) >= drawn + REFRESH:
                drawn = now
                live.update(make_table(state), refresh=True)
