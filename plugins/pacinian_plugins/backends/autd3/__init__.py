"""AUTD3 arrays, through the AUTD3 project's own packages: docs/autd3.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.autd3.backend import Autd3

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Autd3", "register_backends"]


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return this plug-in's backend."""
    return [Autd3]
