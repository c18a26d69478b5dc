"""Meanings of pyusb errors, and advice for the user."""

from __future__ import annotations

import errno
from typing import Any

from pacinian.devices.device_users import find_users

PERMISSION = (
    "this user may not open it: install the udev rule that `pacinian devices udev` prints, "
    "then unplug it and plug it in again"
)
DRIVER = "it has no driver that programs may use: give it WinUSB with Zadig (https://zadig.akeo.ie)"
UNREADABLE = "it does not answer: unplug it and plug it in again"
LIBRARY = "libusb is not installed: `apt install libusb-1.0-0`, or `pip install libusb-package`"
HANGS = "it hangs, or the bus is overloaded"
RESET_ADVICE = "reset the server, or open the backend again"
"""What to do after the cause of a device's fault is removed."""


def has_gone(error: Exception) -> bool:
    """Return whether an error means that the device is gone."""
    return getattr(error, "errno", None) in (errno.ENODEV, errno.ESHUTDOWN, errno.ENXIO)


def advice(error: Exception, address: tuple[int, int] = (0, 0), hangs: str = HANGS) -> str:
    """Return an explanation of an error, for the user.

    address: bus and address of the device. hangs: possible reasons for a timeout.
    """
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        return PERMISSION
    if isinstance(error, NotImplementedError) or number == errno.ENOSYS:
        return DRIVER
    if number == errno.EBUSY:
        node = "/dev/bus/usb/{:03d}/{:03d}".format(*address)
        return f"it is in use by {find_users(node) or 'another program'}: end that first"
    if number == errno.EPIPE:
        return "it refuses (stall)"
    if number == errno.ETIMEDOUT:
        return f"it does not answer in time: {hangs}"
    return str(error) or type(error).__name__


def read_configuration(device: Any) -> Any:
    """Return the active configuration of a pyusb device, or None if none is set. Opens the device. Raises USBError."""
    import usb.core

    try:
        return device.get_active_configuration()
    except usb.core.USBError as error:
        if error.errno is None:  # "Configuration not set"
            return None
        raise
