"""The devices that are plugged in, whether they can be used or not."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian_plugins.backends.usb_autd.protocol import INTERFACE
from pacinian_plugins.backends.usb_autd.troubles import (
    LIBRARY,
    UNREADABLE,
    advice,
    explained,
    has_gone,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

NAME = "usb-autd"


@dataclass(frozen=True)
class Seen:
    """A device that is listed. problem: why its serial number cannot be read; empty if it can."""

    device: Any
    serial: str
    problem: str

    @property
    def place(self) -> str:
        """Where it is plugged in."""
        return f"bus {self.device.bus}, address {self.device.address}"


def seen(library: Any = None) -> list[Seen]:
    """The devices there are, less those that have just gone.

    library: a backend of pyusb; that of libusb unless given. Raises BackendError.
    """
    import usb.core
    import usb.util

    try:
        every: Any = usb.core.find(find_all=True, backend=library, custom_match=_ours)
        listed = list(every)
    except usb.core.NoBackendError as error:
        raise pc.BackendError(f"{NAME}: {LIBRARY}") from error
    except usb.core.USBError as error:
        raise explained(error, NAME, "looking for devices") from error
    found: list[Seen] = []
    for device in listed:
        if (one := _read(device)) is not None:
            found.append(one)
        usb.util.dispose_resources(device)
    return sorted(found, key=lambda one: one.serial)


def _ours(device: Any) -> bool:
    """Whether it has our interface; a device that cannot be read is none of ours."""
    with suppress(Exception):
        return interface_of(device) is not None
    return False


def interface_of(device: Any) -> Any:
    """Its interface of this format; None if it has none."""
    for configuration in device:
        for one in configuration:
            if (one.bInterfaceClass, one.bInterfaceSubClass, one.bInterfaceProtocol) == INTERFACE:
                return one
    return None


def _read(device: Any) -> Seen | None:
    """None if it has gone."""
    import usb.core

    try:
        configured(
            device
        )  # opens it, and so tells why it cannot be read, which the next line does not
        return Seen(device, str(device.serial_number), "")
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
    """The device of that serial number; the only one, if it is empty. Raises BackendError."""
    readable = [one for one in listed if not one.problem]
    found = [one for one in readable if serial in ("", one.serial)]
    if len(found) == 1:
        return found[0]
    which = f"{NAME} {serial}".rstrip()
    if found and serial:
        where = " and ".join(one.place for one in found)
        raise pc.BackendError(f"{which}: {len(found)} devices have this serial number, at {where}")
    there = ", ".join(one.serial for one in readable) or "none"
    problems = "".join(f"; {one.place}: {one.problem}" for one in listed if one.problem)
    raise pc.BackendError(f"{which}: is not connected; there are: {there}{problems}")
