"""`pacinian bench expiry`: measure the time from the end of a permit to silence."""

from __future__ import annotations

import json
from dataclasses import asdict

import click


@click.command()
@click.option("--short", is_flag=True, help="Run a hundredth of the measurement.")
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of a table.")
def expiry(short: bool, as_json: bool) -> None:
    """Measure the time from the end of a permit to silence.

    Covers 100,000 expiries in simulated and real time, stops, late frames and kills.
    """
    from rich.console import Console

    from pacinian_lab.server.expiry import FULL, SHORT, measure, tabulate

    rows = list(measure(SHORT if short else FULL))
    if as_json:
        click.echo(json.dumps([asdict(row) for row in rows]))
    else:
        Console().print(tabulate(rows))
