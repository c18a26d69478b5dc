"""A USB device in memory, for `UsbBus`; and errors as pyusb raises them."""

from __future__ import annotations

import errno

ERRORS = {  # errno: libusb's number, text
    errno.ENODEV: (-4, "No such device (it may have been disconnected)"),
    errno.EIO: (-1, "Input/Output Error"),
    errno.EPIPE: (-9, "Pipe error"),
    errno.EBUSY: (-6, "Resource busy"),
    errno.EACCES: (-3, "Access denied (insufficient permissions)"),
    errno.ETIMEDOUT: (-7, "Operation timed out"),
}


def error(number: int) -> Exception:
    """As pyusb raises it. number: an errno."""
    import usb.core

    code, text = ERRORS[number]
    kind = usb.core.USBTimeoutError if number == errno.ETIMEDOUT else usb.core.USBError
    raised: Exception = kind(text, code, number)
    return raised


class UsbDevice:
    """A device that is plugged in. What it does with what it gets is a derived class's: `take` and `control`.

    serial: None for one that has none. fault: of the next bulk write: "unplug", "stall", "timeout", "hang" (time-outs
    of control requests too), or a number of bytes after which it ends: with an exception nowhere, as pyusb reports
    neither a short write nor a time-out after some bytes. denied: nobody may open it. driverless: no driver lets
    programs use it (Windows). driver: one of the system has it. mute: it answers no control request. writes: bytes
    and time-out [ms] of each.
    """

    vendor, product = 0x1209, 0x0001
    interface = 0xFF, 0x00, 0x00
    """Class, subclass, protocol."""
    endpoints: tuple[int, ...] = (0x01,)
    """Addresses of its bulk endpoints."""

    def __init__(self, serial: str | None = "A1") -> None:
        self.serial = serial
        self.address = 0  # given by the bus
        self.fault: str | int | None = None
        self.halted = self.gone = self.configured = False
        self.denied = self.driverless = self.driver = self.mute = False
        self.holder: object = None  # who has claimed it
        self.writes: list[tuple[int, int]] = []

    def take(self, data: bytes, timeout: float) -> int:
        """Bytes of a bulk write; returns how many it takes within `timeout` [s]."""
        return len(data)

    def control(self, setup: tuple[int, int, int, int], data: bytes) -> bytes | None:
        """A control request: bmRequestType, bRequest, wValue, wIndex; returns the answer, or None to refuse."""
        return None

    def reset(self) -> None:
        """It is told its configuration."""

    def unplug(self) -> None:
        """Pull it out."""
        self.gone = True
