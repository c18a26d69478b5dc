"""SonicSurface, an open array on a serial port: docs/sonicsurface.md.

backend.py                     the backend
ports.py, serial_writer.py, write_scheduler.py   serial ports; writes in a thread; what is written next
protocol.py                    bytes
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.sonicsurface.backend import SonicSurface

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["SonicSurface", "register_backends"]


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return this plug-in's backend."""
    return [SonicSurface]
