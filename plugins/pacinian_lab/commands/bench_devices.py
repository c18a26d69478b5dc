"""`pacinian bench devices`."""

from __future__ import annotations

import json
from dataclasses import asdict

import click


@click.command()
@click.option(
    "--seconds",
    type=click.FloatRange(0.01, 600.0),
    default=10.0,
    show_default=True,
    help="How long each rate is held.",
)
@click.option("--markdown", "as_markdown", is_flag=True, help="Tables for a document.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
def devices(seconds: float, as_markdown: bool, as_json: bool) -> None:
    """Measure how evenly frames reach a device model, how long they take to pack, and what USB has to carry."""
    from rich.console import Console

    from pacinian_lab.devices import pacing as bench

    found = list(bench.loads())
    rates = [bench.held(2000.0, 1, seconds), bench.held(1000.0, 2, seconds)]
    if as_json:
        plain = {"loads": [asdict(one) for one in found], "rates": [asdict(one) for one in rates]}
        click.echo(json.dumps(plain))
    elif as_markdown:
        click.echo(bench.markdown(found, rates))
    else:
        for table in bench.tables(found, rates):
            Console().print(table)
