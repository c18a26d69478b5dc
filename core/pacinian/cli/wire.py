"""`pacinian wire`."""

from __future__ import annotations

import json

import click


@click.command()
@click.option("--schema", is_flag=True, help="As an AsyncAPI document with JSON Schemas instead.")
def wire(schema: bool) -> None:
    """Print how a program in any language talks to `pacinian serve`."""
    from pacinian.wire.asyncapi import make_asyncapi
    from pacinian.wire.markdown import make_page

    click.echo(json.dumps(make_asyncapi(), indent=2) if schema else make_page().rstrip())
