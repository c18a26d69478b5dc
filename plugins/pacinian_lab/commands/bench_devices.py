"""`pacinian bench devices`: measure frame timing at the device models."""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from pacinian.cli.options import FiniteRange


@click.command()
@click.option(
    "--seconds",
    type=FiniteRange(0.01, 600.0),
    default=10.0,
    show_default=True,
    help="Time to hold each rate.",
)
@click.option("--markdown", "as_markdown", is_flag=True, help="Print Markdown tables.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
def devices(seconds: float, as_markdown: bool, as_json: bool) -> None:
    """Measure how evenly frames reach a device model, how long packing takes, and how much data USB carries."""
    from rich.console import Console

    from pacinian_lab.devices import frame_timing as bench

    found = list(bench.loads())
    rates = [bench.measure_rate(2000.0, 1, seconds), bench.measure_rate(1000.0, 2, seconds)]
    if as_json:
        plain = {"loads": [asdict(one) for one in found], "rates": [asdict(one) for one in rates]}
        click.echo(json.dumps(plain))
    elif as_markdown:
        click.echo(bench.markdown(found, rates))
    else:
        for table in bench.tables(found, rates):
            Console().print(table)
