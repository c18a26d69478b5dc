"""The hook specifications. Each hook is called when its plug-in loads, and returns the plug-in's offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import pluggy

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import click

    from pacinian.plugins.backend import Backend
    from pacinian.plugins.solver import Solver

CommandGroup = Literal["start", "run", "inspect", "develop"]
"""The groups of commands in `pacinian --help`."""

hookspec = pluggy.HookspecMarker("pacinian")
hookimpl = pluggy.HookimplMarker("pacinian")


@hookspec
def register_solvers() -> Iterable[type[Solver]]:
    """Return the solver classes that this plug-in offers."""
    return ()


@hookspec
def register_backends() -> Iterable[type[Backend]]:
    """Return the backend classes that this plug-in offers."""
    return ()


@hookspec
def register_commands() -> Iterable[click.Command] | Mapping[CommandGroup, Iterable[click.Command]]:
    """Return the subcommands of `pacinian` that this plug-in offers.

    `pacinian --help` lists them under "develop". To choose another group, return a mapping from groups to commands, as
    in `{"run": [play]}`; the groups are "start", "run", "inspect" and "develop".

    Pacinian imports them when a user calls a subcommand that the core lacks, or asks for help. Therefore import heavy
    libraries in the bodies of the commands.
    """
    return ()
