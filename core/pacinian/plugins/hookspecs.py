"""The hook specifications. Each hook is called once, when its plug-in loads, and returns the plug-in's offers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from collections.abc import Iterable

    import click

    from pacinian.plugins.backend import Backend
    from pacinian.plugins.solver import Solver

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
def register_commands() -> Iterable[click.Command]:
    """Return the subcommands of `pacinian` that this plug-in offers.

    Pacinian imports them when a user calls a subcommand that the core lacks, or asks for help. Therefore import heavy
    libraries in the bodies of the commands.
    """
    return ()
