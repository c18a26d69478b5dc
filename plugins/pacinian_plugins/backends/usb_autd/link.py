"""One claimed USB device: queries, requests and messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.devices.usb import UsbKind
from pacinian.devices.usb_errors import RESET_ADVICE
from pacinian.devices.usb_link import UsbLink
from pacinian_plugins.backends.usb_autd.protocol import INTERFACE, Request

if TYPE_CHECKING:
    from array import array

    from pacinian.devices.usb import ListedDevice

IN, OUT = 0xC1, 0x41  # bmRequestType of vendor requests to the interface
MAX_REPORT_BYTES = 255  # maximum length of a report [bytes]

DEVICES = UsbKind(
    name="usb-autd",
    usb=(INTERFACE,),
    gone=(
        "it is gone: unplugged, reset or without power. It is silent until it is armed: plug it in, "
        f"then {RESET_ADVICE}"
    ),
    anonymous="it has no serial number: its firmware must give it one",
)


class Link:
    """A claimed device of this format.

    one: from `DEVICES.list_devices`. timeout: of a transfer [s]. Raises BackendError.
    """

    def __init__(self, one: ListedDevice, timeout: float) -> None:
        self._usb, self._timeout = UsbLink(DEVICES, one), timeout
        self.serial, self.clear_halt, self.close = one.serial, self._usb.clear_halt, self._usb.close

    @property
    def gone(self) -> bool:
        """Whether an error showed that the device has gone."""
        return self._usb.gone

    def ask(self, request: Request) -> bytes:
        """Read a report. Raises BackendError."""
        return self._control(IN, request, MAX_REPORT_BYTES)

    def tell(self, request: Request, data: bytes = b"") -> None:
        """Send a request. Raises BackendError."""
        self._control(OUT, request, data)

    def write(self, message: array[int]) -> None:
        """Write one whole message. Raises BackendError; then it is unknown how much has arrived."""
        self._usb.write(message, self._timeout)

    def _control(self, kind: int, request: Request, data: bytes | int) -> bytes:
        setup = kind, request, 0, self._usb.interface
        return self._usb.control(setup, data, self._timeout, f"asking for {request.name.lower()}")
