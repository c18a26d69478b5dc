"""Arrays of AUTD units on USB, by Pacinian's own format: docs/usb-autd.md.

backend.py         the backend: options and defaults, such as the watchdog time; a part of each frame
board.py           one device: packs frames, checks its status, says what is wrong with it
link.py            its claimed USB interface: queries, requests
simulated_link.py  a link to the reference device
model.py           the reference device: what the firmware must do, such as the watchdog
decoder.py         how it reads bytes and resynchronises
protocol.py        constants: sizes, requests, states, verdicts
frames.py          frames: header, body, CRC
report_layout.py   reports of capability (with the limits of the watchdog) and status, 64 bytes
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
