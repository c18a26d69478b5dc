"""Every hook. A hook is called once, when its plug-in is loaded, and returns what the plug-in offers."""

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
    """Solver classes that this plug-in offers."""
    return ()


@hookspec
def register_backends() -> Iterable[type[Backend]]:
    """Backend classes that this plug-in offers."""
    return ()


@hookspec
def register_commands() -> Iterable[click.Command]:
    """Subcommands of `pacinian` that this plug-in offers.

    They are imported when a user calls one of them or asks for help, so import heavy libraries in their bodies.
    """
    return ()
