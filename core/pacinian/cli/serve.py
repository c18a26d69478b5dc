"""`pacinian serve`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from pacinian.serving.settings import Settings

PORT = click.IntRange(0, 65535)


@click.command()
@click.argument("config", type=click.Path(path_type=Path), required=False)
@click.option("--solver", default=None, help="Instead of the file's.")
@click.option("--backend", default=None, help="Instead of the file's.")
@click.option(
    "--host", default=None, help="IP address to listen on; but for loopback, keys are needed."
)
@click.option("--control", type=PORT, default=None, help="Port; 0 for any that is free.")
@click.option("--command", type=PORT, default=None, help="Port; 0 for any that is free.")
@click.option("--state", type=PORT, default=None, help="Port; 0 for any that is free.")
@click.option("--keys", default=None, help="Folder of keys: see `pacinian keys`.")
@click.option("--connection", default=None, help="Where clients find how to connect.")
@click.option("--metrics", type=PORT, default=None, help="Port for Prometheus, on 127.0.0.1.")
@click.option(
    "--log-format", type=click.Choice(["console", "json"]), default=None, help="On standard error."
)
@click.option("--quiet", is_flag=True, help="Log warnings and errors only.")
def serve(config: Path | None, **given: Any) -> None:
    """Run the server that games connect to, until Ctrl-C.

    CONFIG is a TOML or JSON file; options go before what it says. Prints where the connection file is, once
    clients may come.
    """
    from pacinian.serving.server import serve as run
    from pacinian.serving.settings import Settings, load

    settings = _with(load(config) if config else Settings(), given)

    def ready(path: Path) -> None:
        click.echo(f"ready: {path}")

    run(settings, ready)


def _with(settings: Settings, given: dict[str, Any]) -> Settings:
    """The settings with what the options say."""
    from msgspec.structs import replace

    from pacinian.serving.settings import Metrics, Security

    chosen = {
        name: value for name, value in given.items() if value is not None and value is not False
    }
    quiet, log = chosen.pop("quiet", False), settings.log
    if "log_format" in chosen:
        log = replace(log, format=chosen.pop("log_format"))
    if quiet:
        log = replace(log, level="warning")
    sockets = {
        name: chosen.pop(name) for name in ("host", "control", "command", "state") if name in chosen
    }
    if "metrics" in chosen:
        chosen["metrics"] = Metrics(chosen["metrics"])
    if "keys" in chosen:
        chosen["security"] = Security(chosen.pop("keys"))
    return replace(settings, log=log, network=replace(settings.network, **sockets), **chosen)
