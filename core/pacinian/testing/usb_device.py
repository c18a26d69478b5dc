"""A simulated USB device for `UsbBus`, and errors as pyusb raises them."""

from __future__ import annotations

import errno

ERRORS = {  # errno: libusb's error code and text
    errno.ENODEV: (-4, "No such device (it may have been disconnected)"),
    errno.EIO: (-1, "Input/Output Error"),
    errno.EPIPE: (-9, "Pipe error"),
    errno.EBUSY: (-6, "Resource busy"),
    errno.EACCES: (-3, "Access denied (insufficient permissions)"),
    errno.ETIMEDOUT: (-7, "Operation timed out"),
}


def error(number: int) -> Exception:
    """Return the error that pyusb raises for `number`, an errno."""
    import usb.core

    code, text = ERRORS[number]
    kind = usb.core.USBTimeoutError if number == errno.ETIMEDOUT else usb.core.USBError
    raised: Exception = kind(text, code, number)
    return raised


class UsbDevice:
    """A simulated device. Derived classes override `take` and `control`.

    serial: serial number; None if it has none. fault: fault of the next bulk write: "unplug", "stall", "timeout",
    "hang" (control requests also time out), or a number of bytes after which the write ends. A write that ends early
    raises nothing, because pyusb reports neither a short write nor a timeout after some bytes. denied: whether users
    lack the permission to open the device. no_user_driver: whether it lacks a driver that lets programs use it
    (Windows). kernel_driver_bound: whether a kernel driver holds it. mute: whether it answers no control request.
    writes: size [bytes] and timeout [ms] of each bulk write.
    """

    vendor, product = 0x1209, 0x0001
    interface = 0xFF, 0x00, 0x00
    """Class, subclass, protocol."""
    endpoints: tuple[int, ...] = (0x01,)
    """Addresses of its bulk endpoints."""

    def __init__(self, serial: str | None = "A1") -> None:
        self.serial = serial
        self.address = 0  # assigned by the bus
        self.fault: str | int | None = None
        self.halted = self.gone = self.configured = False
        self.denied = self.no_user_driver = self.kernel_driver_bound = self.mute = False
        self.holder: object = None  # the handle that has claimed it
        self.writes: list[tuple[int, int]] = []

    def take(self, data: bytes, timeout: float) -> int:
        """Receive a bulk write. Return the number of bytes that the device takes within `timeout` [s]."""
        return len(data)

    def control(self, setup: tuple[int, int, int, int], data: bytes) -> bytes | None:
        """Answer a control request, or return None to refuse. setup: bmRequestType, bRequest, wValue, wIndex."""
        return None

    def reset(self) -> None:
        """React to a new configuration, which resets the device."""

    def unplug(self) -> None:
        """Unplug the device."""
        self.gone = True
