"""`pacinian keys`."""

from __future__ import annotations

import click

FOLDER = click.option(
    "--folder", required=True, type=click.Path(file_okay=False), help="Where the keys are kept."
)


@click.group()
def keys() -> None:
    """Make the keys that the server needs to be reached from other machines."""


@keys.command()
@FOLDER
def server(folder: str) -> None:
    """Make the server's own pair of keys."""
    from pacinian.serving.ipc.auth import make_key_pair

    public, secret = make_key_pair(folder, "server", server=True)
    click.echo(f"public, for clients:     {public}")
    click.echo(f"secret, for the server:  {secret}")


@keys.command()
@click.argument("name")
@FOLDER
@click.option("--host", default="", help="Address of the server: writes a connection file, too.")
@click.option("--ports", nargs=3, type=click.IntRange(1, 65535), help="CONTROL COMMAND STATE.")
def client(name: str, folder: str, host: str, ports: tuple[int, int, int] | None) -> None:
    """Make a client's pair of keys and let it in.

    With --host and --ports a connection file is written that holds all that the client needs: carry it there
    by a way that nobody else can read, and delete it here.
    """
    from pacinian.serving.ipc.auth import make_key_pair, write_remote_connection

    if bool(host) != bool(ports):
        raise click.UsageError("--host and --ports go together")
    public, secret = make_key_pair(folder, name)
    click.echo(f"public, let in:          {public}")
    click.echo(f"secret, for the client:  {secret}")
    if host and ports:
        click.echo(f"connection file:         {write_remote_connection(folder, name, host, ports)}")
