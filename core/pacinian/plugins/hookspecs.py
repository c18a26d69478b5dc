"""Every hook. They are called at start-up only and return classes; plain objects do the work."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from collections.abc import Iterable

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
