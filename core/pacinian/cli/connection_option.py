"""What the commands share that talk to a running server."""

from __future__ import annotations

import click

CONNECTION = click.option(
    "--connection",
    default=None,
    metavar="FILE",
    help="The server's connection file.  [default: $PACINIAN_CONNECTION, or where servers write it]",
)
