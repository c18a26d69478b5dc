"""A claimed USB device: control requests, and frames to its bulk OUT endpoint."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from pacinian.devices.usb_errors import has_gone, read_configuration
from pacinian.errors import BackendError

if TYPE_CHECKING:
    from array import array
    from collections.abc import Callable

    from pacinian.devices.usb import ListedDevice, UsbKind

INTO = 0x80  # direction bit of endpoints and requests: device to host
BULK = 2  # transfer type of bulk endpoints


class UsbLink:
    """A USB device, claimed until it is closed. A kernel driver that holds it is detached for that time.

    kind: kind of the device. one: device from `kind.list_devices`. Raises BackendError after releasing the device.
    Nothing is ever sent again automatically.
    """

    def __init__(self, kind: UsbKind, one: ListedDevice) -> None:
        import usb.core
        import usb.util

        self.serial, self.name = one.serial, f"{kind.name} {one.serial}".rstrip()
        self.gone = False
        """Whether an error has shown that the device is gone."""
        self.interface = 0
        """Number of its interface, for control requests."""
        self._kind, self._device = kind, one.device
        self._detached = self._closed = False
        try:
            interface = kind.find_interface(self._device)
            endpoint = next((e for e in interface or () if _takes_frames(e)), None)
            if endpoint is None:
                raise BackendError(
                    f"{self.name}: opening it: it has no endpoint for frames (bulk OUT)"
                )
            self._endpoint, self.interface = endpoint, int(interface.bInterfaceNumber)
            self._detach()
            if read_configuration(self._device) is None:  # setting it again would reset the device
                self._device.set_configuration()
            usb.util.claim_interface(self._device, self.interface)
        except BaseException as error:
            self.close()
            if isinstance(error, (usb.core.USBError, NotImplementedError)):
                raise self._convert_error(error, "opening it") from error
            raise

    def write(self, data: array[int] | bytes, timeout: float) -> None:
        """Send all of `data` within `timeout` [s]. data: bytes; an `array("B")` is not copied.

        Raises BackendError. The caller then does not know how much of the data has arrived.
        """
        milliseconds, doing = _milliseconds(timeout), "sending a frame"
        taken = self._call(doing, self._endpoint.write, data, milliseconds)
        if taken != len(data):
            raise BackendError(
                f"{self.name}: {doing}: it took {taken} of {len(data)} bytes in {milliseconds} ms: "
                f"{self._kind.hangs}"
            )

    def control(
        self, setup: tuple[int, int, int, int], data: bytes | int, timeout: float, doing: str
    ) -> bytes:
        """Send a control request and return its answer, within `timeout` [s].

        setup: bmRequestType, bRequest, wValue, wIndex. data: bytes to send, or the largest size of the answer [bytes].
        doing: description of the action, for error messages. Raises BackendError.
        """
        request = *setup, data, _milliseconds(timeout)
        answer = self._call(doing, self._device.ctrl_transfer, *request)
        return bytes(answer) if isinstance(data, int) else b""

    def clear_halt(self) -> None:
        """Clear a stall after a failed `write`, so that the next one can succeed. Raises BackendError.

        With a device that hangs this may block for seconds, so send it another request first.
        """
        self._call("ending a stall", self._endpoint.clear_halt)

    def close(self) -> None:
        """Release the device and attach its kernel driver again. May be called twice; never raises."""
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
        """Detach a kernel driver from the interface, on systems that support this."""
        with suppress(NotImplementedError):
            if self._device.is_kernel_driver_active(self.interface):
                self._device.detach_kernel_driver(self.interface)
                self._detached = True

    def _call(self, doing: str, act: Callable[..., Any], *given: Any) -> Any:
        """Call pyusb. Refuses a closed device, because pyusb would open it again. Raises BackendError."""
        import usb.core

        if self._closed:
            raise BackendError(f"{self.name}: {doing}: it is closed")
        try:
            return act(*given)
        except (usb.core.USBError, NotImplementedError) as error:
            raise self._convert_error(error, doing) from error

    def _convert_error(self, error: Exception, doing: str) -> BackendError:
        self.gone = self.gone or has_gone(error)
        address = self._device.bus or 0, self._device.address or 0
        return self._kind.convert_error(error, doing, self.serial, address)


def _takes_frames(endpoint: Any) -> bool:
    return not endpoint.bEndpointAddress & INTO and endpoint.bmAttributes & 3 == BULK


def _milliseconds(timeout: float) -> int:
    return max(1, round(1e3 * timeout))  # 0 would mean no timeout
