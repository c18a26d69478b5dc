"""AUTD3 arrays, through the AUTD3 project's own packages: docs/autd3.md.

backend.py                     the backend: units, levels, rows
units.py, levels.py            poses and channels of units; their levels
stream.py, repeat_detector.py, commands.py   rows as commands; rows that repeat, which units play by themselves
transport_interface.py, open_transport.py, udp_transport.py, emulated.py   ways to units, and to their emulator
packages.py, error_advice.py   the AUTD3 project's packages; what their errors mean
"""

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
