"""`pacinian bench expiry`."""

from __future__ import annotations

import json
from dataclasses import asdict

import click


@click.command()
@click.option("--short", is_flag=True, help="A hundredth of it.")
@click.option("--json", "as_json", is_flag=True, help="One JSON list instead of a table.")
def expiry(short: bool, as_json: bool) -> None:
    """Measure from the end of a permit to silence: 100,000 expiries told and real, stops, late frames, kills."""
    from rich.console import Console

    from pacinian_lab.server.expiry import FULL, SHORT, measure, table

    rows = list(measure(sizes=SHORT if short else FULL))
    if as_json:
        click.echo(json.dumps([asdict(row) for row in rows]))
    else:
        Console().print(table(rows))
