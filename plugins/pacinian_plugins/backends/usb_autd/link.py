"""One device on USB, claimed: what it is asked, told and sent."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.devices.usb import UsbKind
from pacinian.devices.usb_link import UsbLink
from pacinian_plugins.backends.usb_autd.protocol import INTERFACE, Request

if TYPE_CHECKING:
    from array import array

    from pacinian.devices.usb import ListedDevice

IN, OUT = 0xC1, 0x41  # requests of the vendor, to the interface
REPORT = 255  # [bytes] at most
AGAIN = "reset the server, or open the backend again"
DEVICES = UsbKind(
    name="usb-autd",
    usb=(INTERFACE,),
    gone=(
        "it is gone: unplugged, reset or without power. It is silent until it is armed: plug it in, "
        f"then {AGAIN}"
    ),
    anonymous="it has no serial number: its firmware must give it one",
)


class Link:
    """A device of ours, claimed.

    one: as `DEVICES.seen` found it. timeout: how long a transfer may take [s]. Raises BackendError.
    """

    def __init__(self, one: ListedDevice, timeout: float) -> None:
        self._usb, self._timeout = UsbLink(DEVICES, one), timeout
        self.serial, self.mend, self.close = one.serial, self._usb.mend, self._usb.close

    @property
    def gone(self) -> bool:
        """Whether an error has said that it is not there any more."""
        return self._usb.gone

    def ask(self, request: Request) -> bytes:
        """A report. Raises BackendError."""
        return self._control(IN, request, REPORT)

    def tell(self, request: Request, data: bytes = b"") -> None:
        """A request. Raises BackendError."""
        self._control(OUT, request, data)

    def write(self, message: array[int]) -> None:
        """One whole message. Raises BackendError; what of it has arrived is not known then."""
        self._usb.write(message, self._timeout)

    def _control(self, kind: int, request: Request, data: bytes | int) -> bytes:
        setup = kind, request, 0, self._usb.interface
        return self._usb.control(setup, data, self._timeout, f"asking for {request.name.lower()}")
