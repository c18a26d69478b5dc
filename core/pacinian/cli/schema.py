"""`pacinian schema`."""

from __future__ import annotations

import json

import click


@click.command()
def schema() -> None:
    """Print the JSON Schema of scene files."""
    from pacinian.scene.file import make_schema as made

    click.echo(json.dumps(made(), indent=2))
