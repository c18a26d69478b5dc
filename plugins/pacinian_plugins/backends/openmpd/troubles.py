"""What went wrong on USB, and what the user should do about it."""

from __future__ import annotations

import errno
from contextlib import suppress
from pathlib import Path

import pacinian as pc

NAME = "openmpd"
PERMISSION = (
    "this user may not open it: install the udev rule that `pacinian devices udev` prints, "
    "then unplug it and plug it in again"
)
DRIVER = "it has no driver that programs may use: give it WinUSB with Zadig (https://zadig.akeo.ie)"
UNREADABLE = "it does not answer: unplug it and plug it in again"
ANONYMOUS = (
    "it has no serial number: write one to its EEPROM, with FTDI's FT_PROG or pyftdi's ftconf.py"
)
LIBRARY = "libusb is not installed: `apt install libusb-1.0-0`, or `pip install libusb-package`"
UNPLUGGED = (
    "it is gone: unplugged or reset. While it has power it PLAYS ITS LAST FRAME: switch it off, or plug it in "
    "and reset the server, or open the backend again"
)


def has_gone(error: Exception) -> bool:
    """Whether it says that the device is not there any more."""
    return getattr(error, "errno", None) in (errno.ENODEV, errno.ESHUTDOWN, errno.ENXIO)


def explained(
    error: Exception, name: str, doing: str, place: tuple[int, int] = (0, 0)
) -> pc.BackendError:
    """What to raise for an error of pyusb.

    name: of the board. doing: what failed. place: its bus and address.
    """
    what = UNPLUGGED if has_gone(error) else f"{doing}: {advice(error, place)}"
    return pc.BackendError(f"{name}: {what}")


def advice(error: Exception, place: tuple[int, int] = (0, 0)) -> str:
    """What to do about an error of pyusb. place: bus and address of the device."""
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        return PERMISSION
    if isinstance(error, NotImplementedError) or number == errno.ENOSYS:
        return DRIVER
    if number == errno.EBUSY:
        return f"it is in use by {holders(*place) or 'another program'}: end that first"
    if number == errno.EPIPE:
        return "it refuses (stall)"
    if number == errno.ETIMEDOUT:
        return "it takes nothing: the board hangs, has no power, or the bus is overloaded"
    return str(error) or type(error).__name__


def holders(bus: int, address: int, proc: Path = Path("/proc")) -> str:
    """Which other programs have the device open, as `name (pid)`, as far as this user may know; Linux only."""
    node = f"/dev/bus/usb/{bus:03d}/{address:03d}"
    found: list[str] = []
    for process in sorted(proc.glob("[0-9]*"), key=lambda p: int(p.name)):
        with suppress(OSError):  # other users' are closed to us, and some have ended since
            if any(str(fd.readlink()) == node for fd in (process / "fd").iterdir()):
                found.append(f"{(process / 'comm').read_text().strip()} ({process.name})")
    return ", ".join(found)
