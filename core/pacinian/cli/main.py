"""The command `pacinian`: its subcommands, errors and exit codes."""

from __future__ import annotations

import contextlib
import io
import sys
from typing import TYPE_CHECKING, NoReturn

import click

from pacinian.cli.demo import demo
from pacinian.cli.devices import devices
from pacinian.cli.doctor import doctor
from pacinian.cli.engines import unity, unreal
from pacinian.cli.interrupts import catch_signals, interrupt
from pacinian.cli.keys import keys
from pacinian.cli.new import new
from pacinian.cli.plugins import plugins
from pacinian.cli.render import render
from pacinian.cli.replay import replay
from pacinian.cli.rerender import rerender
from pacinian.cli.schema import schema
from pacinian.cli.serve import serve
from pacinian.cli.status import status
from pacinian.cli.stop import stop
from pacinian.cli.view import view
from pacinian.cli.watch import watch
from pacinian.cli.wire import wire
from pacinian.errors import PacinianError, replace_unprintable

if TYPE_CHECKING:
    from pacinian.plugins.hookspecs import CommandGroup

EPILOG = """
`pacinian COMMAND --help` explains a command.

Exit codes: 0 done; 1 the run met a fault; 2 a bad argument, file or plug-in; 130 interrupted.
"""


GROUPS: dict[CommandGroup, str] = {
    "start": "Start (no hardware needed)",
    "run": "Run",
    "inspect": "Inspect",
    "develop": "Develop",
}
"""The groups of commands in the order of help, and their headings."""
COMMANDS: dict[CommandGroup, tuple[click.Command, ...]] = {
    "start": (demo, doctor, unity, unreal),
    "run": (serve, stop, render, replay, rerender, keys),
    "inspect": (status, watch, view, devices, plugins),
    "develop": (new, schema, wire),
}
"""The commands of the core."""


class Commands(click.Group):
    """The commands of the core and of plug-ins, which help lists in groups.

    Plug-ins are imported only for help, and for a name that the core does not have. A plug-in cannot replace a command
    of the core.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands of the core, then those of plug-ins, sorted by name."""
        from pacinian.plugins.registry import discover_plugins

        discover_plugins().load(kind="command")
        return [*self.commands, *sorted(set(discover_plugins().commands) - set(self.commands))]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands of each group under its heading."""
        from pacinian.plugins.registry import discover_plugins

        names = self.list_commands(ctx)
        groups = {command.name: group for group, several in COMMANDS.items() for command in several}
        for name in names:
            if name not in groups:
                groups[name] = discover_plugins().commands[name].group
        room = formatter.width - 6 - max(map(len, names))
        for group, heading in GROUPS.items():
            found = [(name, self.get_command(ctx, name)) for name in names if groups[name] == group]
            with formatter.section(heading):
                formatter.write_dl(
                    [(name, c.get_short_help_str(room)) for name, c in found if c and not c.hidden]
                )

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
    """Let a bare hand feel virtual objects in mid-air, with an array of ultrasound transducers."""


for several in COMMANDS.values():
    for command in several:
        cli.add_command(command)


def main() -> NoReturn:
    """Run the command line."""
    try:
        catch_signals()
        if isinstance(sys.stdout, io.TextIOWrapper):  # which may lack characters of a name
            sys.stdout.reconfigure(errors="replace")
        try:
            cli(standalone_mode=False)
        finally:
            interrupt.raise_deferred()
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        sys.exit(130)
    except PacinianError as error:
        lines = f"error: {error}".splitlines()  # with names that files and servers have chosen
        click.echo("\n".join(map(replace_unprintable, lines)), err=True)
        sys.exit(2)
    except OSError as error:  # such as a full disk or a closed pipe
        _quietly(f"error: {error}")
        sys.exit(1)
    sys.exit(0)


def _quietly(message: str) -> None:
    with contextlib.suppress(OSError):
        click.echo(message, err=True)
    sys.stdout = None  # otherwise the interpreter would try to flush it again
