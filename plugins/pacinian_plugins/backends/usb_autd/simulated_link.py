"""A link to the reference device, to try everything except USB."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.usb_autd.model import Device, Stalled
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport

if TYPE_CHECKING:
    from array import array

    from pacinian_plugins.backends.usb_autd.protocol import Request


class SimulatedLink:
    """A link to a model of a device with `units` units of `transducers` each."""

    gone = False

    def __init__(self, units: int, transducers: int, serial: str = "PRETENDED") -> None:
        self.serial = serial
        self.device = Device(
            CapabilityReport(
                units=units, transducers=transducers, serial=serial, firmware="model 1.0"
            )
        )

    def ask(self, request: Request) -> bytes:
        """Read a report."""
        return self.device.ask(request)

    def tell(self, request: Request, data: bytes = b"") -> None:
        """Send a request. Raises BackendError."""
        try:
            self.device.tell(request, data)
        except Stalled:
            doing = f"asking for {request.name.lower()}"
            raise pc.BackendError(f"usb-autd {self.serial}: {doing}: it refuses") from None

    def write(self, message: array[int]) -> None:
        """Write one whole message."""
        self.device.write(message.tobytes())

    def clear_halt(self) -> None:
        """Do nothing: transfers never fail."""

    def close(self) -> None:
        """Unplug it."""
        self.device.reset()
