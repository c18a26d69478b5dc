"""OpenMPD boards, each of 256 transducers behind an FT232H: docs/openmpd.md.

backend.py    the backend: which boards, and a frame for each
board.py      one board: its frames
link.py       its claimed USB chip
protocol.py   bytes
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.openmpd.backend import OpenMpd

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["OpenMpd", "register_backends"]


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return this plug-in's backend."""
    return [OpenMpd]
