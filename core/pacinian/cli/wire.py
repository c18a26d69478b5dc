"""`pacinian wire`."""

from __future__ import annotations

import json

import click


@click.command()
@click.option(
    "--schema", is_flag=True, help="Print an AsyncAPI document with JSON Schemas instead."
)
def wire(schema: bool) -> None:
    """Print the protocol of `pacinian serve`.

    By this, a program in any language can talk to it.
    """
    from pacinian.serving.settings import Safety
    from pacinian.wire.asyncapi import make_asyncapi
    from pacinian.wire.protocol_pages import make_guide, make_reference

    if schema:
        click.echo(json.dumps(make_asyncapi(), indent=2))
    else:
        click.echo(f"{make_guide(Safety().lease)}\n{make_reference()}".rstrip())
