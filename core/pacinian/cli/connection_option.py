"""The `--connection` option of the commands that talk to a running server."""

from __future__ import annotations

import click

from pacinian.cli.nonempty import PATH

CONNECTION = click.option(
    "--connection",
    default=None,
    type=PATH,
    metavar="FILE",
    help="The server's connection file.  [default: $PACINIAN_CONNECTION, or the server's default]",
)
