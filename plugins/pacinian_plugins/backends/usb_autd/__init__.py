"""Arrays of AUTD units on USB, by Pacinian's own format: docs/usb-autd.md.

backend.py, board.py           the backend: which devices, and a part of each frame for each; one device
link.py, simulated_link.py     its claimed USB interface; one to the reference device instead
model.py, decoder.py           the reference device; how it reads bytes
protocol.py, frames.py, reports.py   constants, frames and reports of the format
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.usb_autd.backend import UsbAutd

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["UsbAutd", "register_backends"]


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return this plug-in's backend."""
    return [UsbAutd]
