"""One USB device, claimed: control requests, and frames to its bulk OUT endpoint."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from pacinian.devices.usb_errors import configured, has_gone
from pacinian.errors import BackendError

if TYPE_CHECKING:
    from array import array
    from collections.abc import Callable

    from pacinian.devices.usb import ListedDevice, UsbKind

INTO = 0x80  # the bit of an endpoint or request towards the host
BULK = 2


class UsbLink:
    """A device, claimed until it is closed; a driver of the system that has it gives way for so long.

    kind: of what it is one. one: as `kind.seen` found it. Raises BackendError, and has then given it back. Nothing
    is ever sent again by itself.
    """

    def __init__(self, kind: UsbKind, one: ListedDevice) -> None:
        import usb.core
        import usb.util

        self.serial, self.name = one.serial, f"{kind.name} {one.serial}".rstrip()
        self.gone = False
        """Whether an error has said that it is not there any more."""
        self.interface = 0
        """Its number, for requests to it."""
        self._kind, self._device = kind, one.device
        self._detached = self._closed = False
        try:
            interface = kind.interface(self._device)
            endpoint = next((e for e in interface or () if _takes_frames(e)), None)
            if endpoint is None:
                raise BackendError(
                    f"{self.name}: opening it: it has no endpoint for frames (bulk OUT)"
                )
            self._endpoint, self.interface = endpoint, int(interface.bInterfaceNumber)
            self._detach()
            if configured(self._device) is None:  # to set it again is a reset
                self._device.set_configuration()
            usb.util.claim_interface(self._device, self.interface)
        except BaseException as error:
            self.close()
            if isinstance(error, (usb.core.USBError, NotImplementedError)):
                raise self._explained(error, "opening it") from error
            raise

    def write(self, data: array[int] | bytes, timeout: float) -> None:
        """Send all of it, within `timeout` [s]. data: bytes; an `array("B")` is not copied.

        Raises BackendError; what of it has arrived is not known then, but to the device.
        """
        milliseconds, doing = _milliseconds(timeout), "sending a frame"
        taken = self._called(doing, self._endpoint.write, data, milliseconds)
        if taken != len(data):
            raise BackendError(
                f"{self.name}: {doing}: it took {taken} of {len(data)} bytes in {milliseconds} ms: "
                f"{self._kind.hangs}"
            )

    def control(
        self, setup: tuple[int, int, int, int], data: bytes | int, timeout: float, doing: str
    ) -> bytes:
        """A control request, within `timeout` [s], and what it answers.

        setup: bmRequestType, bRequest, wValue, wIndex. data: to send; or how many bytes it may answer. doing: what
        the user is told has failed. Raises BackendError.
        """
        request = *setup, data, _milliseconds(timeout)
        answer = self._called(doing, self._device.ctrl_transfer, *request)
        return bytes(answer) if isinstance(data, int) else b""

    def mend(self) -> None:
        """After a failed `write`: end a stall, and let the next be taken. Raises BackendError.

        The system may wait seconds for a device that hangs: ask it something else before.
        """
        self._called("ending a stall", self._endpoint.clear_halt)

    def close(self) -> None:
        """Give the device back, and the driver that it had. May be called twice; never raises."""
        import usb.util

        device, self._closed = self._device, True
        with suppress(Exception):
            usb.util.release_interface(device, self.interface)
        if self._detached:
            self._detached = False
            with suppress(Exception):
                device.attach_kernel_driver(self.interface)
        with suppress(Exception):
            usb.util.dispose_resources(device)

    def _detach(self) -> None:
        """Take the interface from a driver that has it; not all systems know of such."""
        with suppress(NotImplementedError):
            if self._device.is_kernel_driver_active(self.interface):
                self._device.detach_kernel_driver(self.interface)
                self._detached = True

    def _called(self, doing: str, act: Callable[..., Any], *given: Any) -> Any:
        """What pyusb returns; it would open a device that is closed again."""
        import usb.core

        if self._closed:
            raise BackendError(f"{self.name}: {doing}: it is closed")
        try:
            return act(*given)
        except (usb.core.USBError, NotImplementedError) as error:
            raise self._explained(error, doing) from error

    def _explained(self, error: Exception, doing: str) -> BackendError:
        self.gone = self.gone or has_gone(error)
        place = self._device.bus or 0, self._device.address or 0
        return self._kind.explained(error, doing, self.serial, place)


def _takes_frames(endpoint: Any) -> bool:
    return not endpoint.bEndpointAddress & INTO and endpoint.bmAttributes & 3 == BULK


def _milliseconds(timeout: float) -> int:
    return max(1, round(1e3 * timeout))  # 0 would be for ever
