"""SonicSurface, an open array on a serial port: docs/sonicsurface.md.

backend.py          the backend: its options and defaults; as many frames as the line takes
ports.py            serial ports: list, open, errors
serial_writer.py    writes in a thread
write_scheduler.py  what is written next: always the newest pattern
protocol.py         bytes: 230,400 baud, phases
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
