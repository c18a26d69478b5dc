"""The FT232H chips that are plugged in: boards, or anything else that is built with one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian_plugins.backends.openmpd.troubles import (
    ANONYMOUS,
    LIBRARY,
    NAME,
    UNREADABLE,
    advice,
    explained,
    has_gone,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

VENDOR, PRODUCT = 0x0403, 0x6014  # FTDI's FT232H, whatever it is built into


@dataclass(frozen=True)
class Seen:
    """A chip that is listed. problem: why it cannot be told from others; empty if it can."""

    device: Any
    serial: str
    problem: str

    @property
    def place(self) -> str:
        """Where it is plugged in."""
        return f"bus {self.device.bus}, address {self.device.address}"


def seen(library: Any = None) -> list[Seen]:
    """The chips there are, less those that have just gone.

    library: a backend of pyusb; that of libusb unless given. Raises BackendError.
    """
    import usb.core
    import usb.util

    try:
        every: Any = usb.core.find(
            find_all=True, backend=library, idVendor=VENDOR, idProduct=PRODUCT
        )
        listed = list(every)
    except usb.core.NoBackendError as error:
        raise pc.BackendError(f"{NAME}: {LIBRARY}") from error
    except usb.core.USBError as error:
        raise explained(error, NAME, "looking for boards") from error
    found: list[Seen] = []
    for device in listed:
        if (one := _read(device)) is not None:
            found.append(one)
        usb.util.dispose_resources(device)
    return sorted(found, key=lambda one: one.serial)


def _read(device: Any) -> Seen | None:
    """None if it has gone."""
    import usb.core

    try:
        configured(device)  # opens it, and so tells why it cannot be read; the next line does not
        serial = str(device.serial_number or "")
        return Seen(device, serial, "" if serial else ANONYMOUS)
    except (usb.core.USBError, NotImplementedError) as error:
        return None if has_gone(error) else Seen(device, "", advice(error))
    except ValueError:  # it had strings when it was plugged in
        return Seen(device, "", UNREADABLE)


def configured(device: Any) -> Any:
    """The configuration it has; None if it has none. Raises USBError."""
    import usb.core

    try:
        return device.get_active_configuration()
    except usb.core.USBError as error:
        if error.errno is None:  # "Configuration not set"
            return None
        raise


def picked(listed: Sequence[Seen], serial: str) -> Seen:
    """The chip of that serial number. Raises BackendError."""
    readable = [one for one in listed if not one.problem]
    found = [one for one in readable if one.serial == serial]
    if len(found) == 1:
        return found[0]
    if found:
        where = " and ".join(one.place for one in found)
        raise pc.BackendError(
            f"{NAME} {serial}: {len(found)} have this serial number, at {where}: unplug one"
        )
    there = ", ".join(one.serial for one in readable) or "none"
    problems = "".join(f"; {one.place}: {one.problem}" for one in listed if one.problem)
    raise pc.BackendError(f"{NAME} {serial}: is not connected; there are: {there}{problems}")
