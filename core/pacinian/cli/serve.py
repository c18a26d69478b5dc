"""`pacinian serve`."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pacinian.cli.options import PATH, TEXT, NonEmptyPath

if TYPE_CHECKING:
    from collections.abc import Generator

    from pacinian.plugins.registry import Kind
    from pacinian.scene.config_sections import PluginConfig
    from pacinian.serving.settings import Settings

MAX_VIEWER_END_TIME = 5.0  # time limit for the viewer to end [s]
PORT_TYPE = click.IntRange(0, 65535)
VIEWER_LIBRARIES = "starlette", "uvicorn", "websockets"


@click.command()
@click.argument("config", type=NonEmptyPath(path_type=Path), required=False)
@click.option("--solver", type=TEXT, default=None, help="Override the file's solver.")
@click.option("--backend", type=TEXT, default=None, help="Override the file's backend.")
@click.option(
    "--host",
    type=TEXT,
    default=None,
    help="IP address to listen on; any but loopback needs --keys.",
)
@click.option("--control", type=PORT_TYPE, default=None, help="Port; 0 for any free port.")
@click.option("--command", type=PORT_TYPE, default=None, help="Port; 0 for any free port.")
@click.option("--state", type=PORT_TYPE, default=None, help="Port; 0 for any free port.")
@click.option("--keys", type=PATH, default=None, help="Folder of keys: see `pacinian keys`.")
@click.option("--connection", type=PATH, default=None, help="Connection file to write for clients.")
@click.option("--metrics", type=PORT_TYPE, default=None, help="Port for Prometheus, on 127.0.0.1.")
@click.option(
    "--log-format", type=click.Choice(["console", "json"]), default=None, help="Of standard error."
)
@click.option(
    "--temperature",
    type=float,
    default=None,
    help="Temperature of the air at the array [degC]; measure it. Overrides the file.  [default: 22]",
)
@click.option("--quiet", is_flag=True, help="Log warnings and errors only.")
@click.option("--view", is_flag=True, help="Open the viewer beside it: see `pacinian view`.")
@click.option(
    "--until-eof",
    is_flag=True,
    help="End when standard input closes, as it does when the game that started this process ends.",
)
def serve(config: Path | None, view: bool, until_eof: bool, **given: Any) -> None:
    """Run the server that games connect to.

    Runs until Ctrl-C. CONFIG is a TOML or JSON file, which options override. Prints the path of the connection file as
    soon as clients can connect.
    """
    import threading

    from pacinian.cli.standard_input import call_at_end_of_input
    from pacinian.serving.server import serve as run
    from pacinian.serving.settings import Settings, load

    settings = _override(load(config) if config else Settings(), given)
    imported = _find_plugins(settings)
    if view:
        check_viewer()
    with contextlib.ExitStack() as stack:

        def ready(path: Path) -> None:
            _print_ready(path)
            if view:
                stack.enter_context(_run_viewer(path))

        ending = threading.Event()
        if until_eof:
            call_at_end_of_input(ending.set)
        run(settings, ready, ending=ending, source=config or "settings", fork=not imported)


def _print_ready(path: Path) -> None:
    """Print that clients can connect. A server whose output cannot be written, as on a full disk, runs all the same."""
    try:
        click.echo(f"ready: {path}")
    except OSError:
        sys.stdout = None  # otherwise the interpreter would try to flush it at the end


def _find_plugins(settings: Settings) -> bool:
    """Check that the chosen plug-ins exist, before anything starts; return whether that imported any.

    Raises UnknownPlugin, PluginError.
    """
    from importlib.metadata import entry_points

    from pacinian.plugins.registry import GROUP, Plugins

    installed = entry_points(group=GROUP)
    chosen: tuple[tuple[Kind, str | PluginConfig], ...] = (
        ("solver", settings.solver),
        ("backend", settings.backend),
    )
    imported = False
    for kind, choice in chosen:
        name = choice if isinstance(choice, str) else choice.name
        if name not in installed.names:  # import plug-ins only if no entry point has that name
            Plugins().find(kind, name)
            imported = True
    return imported


def check_viewer() -> None:
    """Check that the viewer's libraries are installed, before anything starts. Raises MissingExtra."""
    from importlib.util import find_spec

    from pacinian.errors import MissingExtra

    for library in VIEWER_LIBRARIES:
        if find_spec(library) is None:
            raise MissingExtra(library, "view")


@contextlib.contextmanager
def _run_viewer(connection: Path) -> Generator[None]:
    """Run the viewer in a process of its own, which ends when its standard input closes."""
    import subprocess

    from pacinian.serving.ipc.processes import SAFE_PATH

    command = [
        sys.executable,
        "-m",
        "pacinian",
        "view",
        "--until-eof",
        "--connection",
        str(connection),
    ]
    # A process group of its own: only the server receives Ctrl-C, and fades the sound out first.
    env = {**os.environ, **SAFE_PATH}
    process = subprocess.Popen(command, stdin=subprocess.PIPE, env=env, start_new_session=True)
    try:
        yield
    finally:
        try:
            process.communicate(timeout=MAX_VIEWER_END_TIME)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def _override(settings: Settings, given: dict[str, Any]) -> Settings:
    """Return the settings, overridden by the options."""
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
    if "temperature" in chosen:  # drop a speed of sound from the file, which would take precedence
        medium = replace(settings.medium, speed_of_sound=0.0, density=0.0)
        chosen["medium"] = replace(medium, temperature=chosen.pop("temperature"))
        chosen["medium"].make()
    if "keys" in chosen:
        chosen["security"] = Security(chosen.pop("keys"))
    return replace(settings, log=log, network=replace(settings.network, **sockets), **chosen)
