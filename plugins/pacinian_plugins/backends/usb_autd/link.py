"""One device on USB, claimed."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol

import pacinian as pc
from pacinian_plugins.backends.usb_autd.discovery import NAME, configured, interface_of
from pacinian_plugins.backends.usb_autd.protocol import Request
from pacinian_plugins.backends.usb_autd.troubles import explained

if TYPE_CHECKING:
    from array import array

    from pacinian_plugins.backends.usb_autd.discovery import Seen

IN, OUT = 0xC1, 0x41  # requests of the vendor, to the interface
REPORT = 255  # [bytes] at most


class Link(Protocol):
    """What the backend needs of a device."""

    serial: str

    def ask(self, request: int) -> bytes:
        """A report. Raises BackendError."""
        ...

    def tell(self, request: int, data: bytes = b"") -> None:
        """A request. Raises BackendError."""
        ...

    def write(self, message: array[int]) -> None:
        """One whole message. Raises BackendError; the message is then lost, and not sent again."""
        ...

    def mend(self) -> None:
        """After a failed write: let the next message be taken. Raises BackendError."""
        ...

    def close(self) -> None:
        """Give the device back. Never raises."""
        ...


class UsbLink:
    """A device of ours, claimed.

    one: as `seen` found it. timeout: how long a transfer may take [s]. Raises BackendError.
    """

    def __init__(self, one: Seen, timeout: float) -> None:
        import usb.core
        import usb.util

        self.serial, self._device = one.serial, one.device
        self._name, self._timeout = f"{NAME} {one.serial}", max(1, round(1e3 * timeout))
        self._detached = False
        try:
            interface = interface_of(self._device)
            self._interface = int(interface.bInterfaceNumber)
            self._endpoint = next(e for e in interface if not e.bEndpointAddress & 0x80)
            self._detach()
            if configured(self._device) is None:  # to set it again is a reset
                self._device.set_configuration()
            usb.util.claim_interface(self._device, self._interface)
        except (usb.core.USBError, NotImplementedError, StopIteration) as error:
            self.close()
            raise self._explained(error, "opening it") from error

    def ask(self, request: int) -> bytes:
        """A report. Raises BackendError."""
        return bytes(self._control(IN, request, REPORT))

    def tell(self, request: int, data: bytes = b"") -> None:
        """A request. Raises BackendError."""
        self._control(OUT, request, data)

    def write(self, message: array[int]) -> None:
        """One whole message. Raises BackendError; what of it has arrived is not known then."""
        import usb.core

        try:
            taken = self._endpoint.write(message, self._timeout)
        except usb.core.USBError as error:
            raise self._explained(error, "sending a frame") from error
        if taken != len(message):
            raise pc.BackendError(
                f"{self._name}: sending a frame: it took {taken} of {len(message)} bytes in "
                f"{self._timeout} ms: it hangs, or the bus is overloaded"
            )

    def mend(self) -> None:
        """Let the next message be taken after a stall. Raises BackendError."""
        import usb.core

        try:
            self._endpoint.clear_halt()
        except usb.core.USBError as error:
            raise self._explained(error, "ending a stall") from error

    def close(self) -> None:
        """Give the device back, and the driver that it had. Never raises."""
        import usb.util

        device = self._device
        with suppress(Exception):
            usb.util.release_interface(device, self._interface)
        if self._detached:
            self._detached = False
            with suppress(Exception):
                device.attach_kernel_driver(self._interface)
        with suppress(Exception):
            usb.util.dispose_resources(device)

    def _detach(self) -> None:
        """Take the interface from a driver that has it; not all systems know of such."""
        with suppress(NotImplementedError):
            if self._device.is_kernel_driver_active(self._interface):
                self._device.detach_kernel_driver(self._interface)
                self._detached = True

    def _control(self, kind: int, request: int, data: bytes | int) -> Any:
        import usb.core

        try:
            return self._device.ctrl_transfer(
                kind, request, 0, self._interface, data, self._timeout
            )
        except usb.core.USBError as error:
            name = Request(request).name.lower()
            raise self._explained(error, f"asking for {name}") from error

    def _explained(self, error: Exception, doing: str) -> pc.BackendError:
        place = self._device.bus or 0, self._device.address or 0
        return explained(error, self._name, doing, place)
