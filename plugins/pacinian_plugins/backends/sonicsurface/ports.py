"""Serial ports: lists them, opens the chosen one, and explains its errors."""

from __future__ import annotations

import errno
import os
from typing import Any

import pacinian as pc
from pacinian.devices.device_users import find_users
from pacinian.devices.usb_errors import RESET_ADVICE
from pacinian_plugins.backends.sonicsurface.protocol import BAUD

NAME = "sonicsurface"
PERMISSION = "this user may not open it: `sudo usermod -aG dialout $USER` (`uucp` on some systems), then log in again"
STUCK = (
    "it takes nothing: the adapter hangs: unplug it, plug it in again, and open the backend again"
)
UNPLUGGED = (
    "it is gone: unplugged or reset. While the array has power it PLAYS ITS LAST PATTERN: switch it off, or plug "
    f"the adapter in and {RESET_ADVICE}"
)


def list_ports() -> list[Any]:
    """Return the ports of USB adapters from pyserial, sorted by serial number. Raises MissingExtra."""
    try:
        from serial.tools.list_ports import comports
    except ImportError as error:
        raise pc.MissingExtra("pyserial", "devices") from error
    every: Any = comports()
    return sorted(
        (one for one in every if one.vid is not None),
        key=lambda one: (one.serial_number or "", one.device),
    )


def find_boards() -> list[pc.FoundDevice]:
    """Return these ports, and whether this user may open them."""
    devices: list[pc.FoundDevice] = []
    for one in list_ports():
        problem = "" if os.name == "nt" or os.access(one.device, os.R_OK | os.W_OK) else PERMISSION
        title = f"serial adapter, of a SonicSurface or anything else, at {one.device}"
        devices.append(pc.FoundDevice(NAME, one.serial_number or "", title, problem))
    return devices


def check_port(name: str) -> str:
    """Resolve a port's name, or the serial number of its adapter, to the name. Raises BackendError."""
    same = [one.device for one in list_ports() if one.serial_number == name]
    if not name:
        raise pc.BackendError(
            f"{NAME}: name the port: `port`, or the serial number in the `description`; {_there()}"
        )
    if len(same) > 1:
        where = " and ".join(same)
        raise pc.BackendError(
            f"{NAME} {name}: {len(same)} adapters have this serial number, at {where}: name one of these"
        )
    return str(same[0]) if same else name


def open_port(name: str, timeout: float) -> Any:
    """Open the port exclusively at the array's baud rate. Raises BackendError, MissingExtra."""
    device = check_port(name)
    import serial

    try:
        return serial.Serial(device, BAUD, timeout=0, write_timeout=timeout, exclusive=True)
    except (OSError, ValueError) as error:  # SerialException is an OSError
        raise pc.BackendError(explain(error, device)) from error


def explain(error: Exception, device: str) -> str:
    """Return the message for an error of pyserial. device: name of the port."""
    number = getattr(error, "errno", None) or getattr(error.__context__, "errno", None)
    if number in (errno.EIO, errno.ENODEV, errno.ENXIO, errno.EBADF):
        what = UNPLUGGED
    elif number == errno.ENOENT:
        what = f"is not connected; {_there()}"
    elif number in (errno.EACCES, errno.EPERM):
        what = PERMISSION
    elif number in (errno.EBUSY, errno.EAGAIN):
        what = f"it is in use by {find_users(device) or 'another program'}: end that first"
    elif type(error).__name__ == "SerialTimeoutException":
        what = STUCK
    else:
        what = str(error) or type(error).__name__
    return f"{NAME} {device}: {what}"


def _there() -> str:
    names = [f"{one.device} ({one.serial_number or 'no serial'})" for one in list_ports()]
    return f"there are: {', '.join(names) or 'none'}"
