"""`pacinian keys`."""

from __future__ import annotations

import click

from pacinian.cli.options import TEXT, NonEmptyPath

FOLDER = click.option(
    "--folder", required=True, type=NonEmptyPath(file_okay=False), help="Folder of the keys."
)


@click.group()
def keys() -> None:
    """Make the keys for connections from other machines."""


@keys.command()
@FOLDER
def server(folder: str) -> None:
    """Make the server's key pair."""
    from pacinian.serving.ipc.auth import make_server_keys

    public, secret = make_server_keys(folder)
    click.echo(f"public, for clients:     {public}")
    click.echo(f"secret, for the server:  {secret}")


@keys.command()
@click.argument("name", type=TEXT)
@FOLDER
@click.option(
    "--host", type=TEXT, default=None, help="Address of the server; also writes a connection file."
)
@click.option("--ports", nargs=3, type=click.IntRange(1, 65535), help="CONTROL COMMAND STATE.")
def client(name: str, folder: str, host: str | None, ports: tuple[int, int, int] | None) -> None:
    """Make a client's key pair and admit the client.

    With --host and --ports, also write a connection file with everything that the client needs. Copy it to the client
    over a channel that nobody else can read, and delete it here.
    """
    from pacinian.serving.ipc.auth import make_client_keys, write_remote_connection

    if bool(host) != bool(ports):
        raise click.UsageError("--host and --ports go together")
    public, secret = make_client_keys(folder, name)
    click.echo(f"public, let in:          {public}")
    click.echo(f"secret, for the client:  {secret}")
    if host and ports:
        click.echo(f"connection file:         {write_remote_connection(folder, name, host, ports)}")
