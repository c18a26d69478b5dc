"""Errors of a run for which a plug-in is to blame, and exits by which it would end the program."""

from __future__ import annotations

from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

from pacinian.errors import PacinianError, PluginError, describe_error

if TYPE_CHECKING:
    from collections.abc import Generator

    from pacinian.rendering.renderer import Renderer


@contextmanager
def forbid_exit() -> Generator[None]:
    """Take SystemExit for an error of a plug-in, which must not end the program. Raises PluginError."""
    try:
        yield
    except SystemExit as error:
        raise PluginError(
            f"the solver or the backend ended the run by SystemExit({error.code!r}): it must raise another error"
        ) from error


@contextmanager
def blame_plugin(plugins: str) -> Generator[None]:
    """Report an exception in the `with` block as an error of the plug-in, unless it is Pacinian's own.

    plugins: the plug-ins that may have raised it, as in "backend 'simulated'". Raises PluginError, which names them.
    """
    try:
        yield
    except PacinianError:
        raise
    except Exception as error:
        raise PluginError(f"{plugins} failed: {describe_error(error)}") from error


@contextmanager
def keep_renderer_open(renderer: Renderer) -> Generator[None]:
    """Open a renderer, and close it at the end of the `with` statement.

    Raises PluginError, which names the backend that cannot be opened. If the renderer is strict, it also tries the
    solver, and the error names both.
    """
    plugins = f"backend {renderer.backend.name!r}"
    if renderer.strict:
        plugins += f" or solver {renderer.session.solver.name!r}"
    with closing(renderer):
        with blame_plugin(plugins):
            renderer.open()
        yield
