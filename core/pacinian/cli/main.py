"""The command `pacinian`: its subcommands, errors and exit codes."""

from __future__ import annotations

import contextlib
import signal
import sys
from typing import TYPE_CHECKING, NoReturn

import click

from pacinian.cli.demo import demo
from pacinian.cli.devices import devices
from pacinian.cli.doctor import doctor
from pacinian.cli.keys import keys
from pacinian.cli.plugins import plugins
from pacinian.cli.render import render
from pacinian.cli.replay import replay
from pacinian.cli.schema import schema
from pacinian.cli.serve import serve
from pacinian.cli.status import status
from pacinian.cli.stop import stop
from pacinian.cli.view import view
from pacinian.cli.watch import watch
from pacinian.cli.wire import wire
from pacinian.errors import PacinianError

if TYPE_CHECKING:
    from types import FrameType

EPILOG = """
Start with `pacinian demo`: it needs no hardware.

Exit codes: 0 done; 1 the run met a fault; 2 a bad argument, file or plug-in; 130 interrupted.
"""


class Commands(click.Group):
    """The commands of the core and of plug-ins.

    Plug-ins are imported only for help, and for a name that the core does not have. A plug-in cannot replace a command
    of the core.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands of the core, then those of plug-ins, sorted by name."""
        from pacinian.plugins.registry import discover_plugins

        discover_plugins().load(kind="command")
        return [*self.commands, *sorted(set(discover_plugins().commands) - set(self.commands))]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of that name. Raises UsageError if there is none and a plug-in did not load."""
        if command := self.commands.get(cmd_name):
            return command
        from pacinian.plugins.registry import discover_plugins

        discover_plugins().load(kind="command")
        if offer := discover_plugins().commands.get(cmd_name):
            return offer.command
        if failed := discover_plugins().failed:
            problems = "; ".join(map(str, failed.values()))
            raise click.UsageError(f"No such command {cmd_name!r}. {problems}")
        return None


@click.group(cls=Commands, epilog=EPILOG, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="pacinian")
def cli() -> None:
    """Mid-air haptics: a scene goes in, gains for an ultrasound transducer array come out."""


COMMANDS = (
    *(demo, render, replay, schema),
    *(serve, status, watch, view, stop, keys, doctor),
    *(devices, plugins, wire),
)
for command in COMMANDS:
    cli.add_command(command)


def main() -> NoReturn:
    """Run the command line. This is the entry point."""
    signal.signal(signal.SIGTERM, _interrupt)
    if sys.platform == "win32":  # sent when the console is closed
        signal.signal(signal.SIGBREAK, _interrupt)
    try:
        cli(standalone_mode=False)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        sys.exit(130)
    except PacinianError as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(2)
    except OSError as error:  # such as a full disk or a closed pipe
        _quietly(f"error: {error}")
        sys.exit(1)
    sys.exit(0)


def _quietly(message: str) -> None:
    with contextlib.suppress(OSError):
        click.echo(message, err=True)
    sys.stdout = None  # otherwise the interpreter would try to flush it again


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Handle SIGTERM like Ctrl-C, so that the run ends in silence."""
    raise KeyboardInterrupt
