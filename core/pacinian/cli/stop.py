"""`pacinian stop`."""

from __future__ import annotations

import json

import click

from pacinian.cli.options import CONNECTION, FiniteRange
from pacinian.errors import ServerError

NOT_CONFIRMED = "The stop is not confirmed: if the array sounds, switch it off."
STOPPED = "stopped: silent until a client resets it, in Python by `pacinian.Client().reset()`"


@click.command()
@CONNECTION
@click.option(
    "--timeout",
    type=FiniteRange(0.01, 60),
    default=2.0,
    show_default=True,
    help="Seconds to wait for the server's confirmation.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a line.")
def stop(connection: str | None, timeout: float, as_json: bool) -> None:
    """Emergency stop: silence the array at once.

    Stops the output, whoever owns it, until a client resets it.

    Exit code 0 only if the server has confirmed the stop. Otherwise switch the array off.
    """
    from pacinian.client.emergency_stop import emergency_stop

    try:
        emergency_stop(connection, timeout=timeout)
    except ServerError:
        click.echo(NOT_CONFIRMED, err=True)
        raise
    click.echo(json.dumps({"stopped": True}) if as_json else STOPPED)
