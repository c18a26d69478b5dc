"""Arrays of AUTD units on USB, by Pacinian's own format: docs/usb-autd.md."""

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
