"""OpenMPD boards, each of 256 transducers behind an FT232H: docs/openmpd.md.

backend.py   the backend: which boards, a frame for each
board.py     one board: frames, resynchronising after a cut one
link.py      its FT232H: FIFO, requests
protocol.py  bytes: phases, amplitudes, divider of the frame rate
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
