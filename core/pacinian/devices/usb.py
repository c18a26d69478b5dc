"""Discovery and selection of USB devices of one kind.

For backends: `UsbKind` finds a device, and `pacinian.devices.usb_link.UsbLink` claims it. docs/plugins.md shows both.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pacinian.devices.usb_errors import (
    HANGS,
    LIBRARY,
    UNREADABLE,
    advice,
    has_gone,
    read_configuration,
)
from pacinian.errors import BackendError

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class ListedDevice:
    """A device that is plugged in.

    device: device of pyusb. serial: serial number; empty if it has none or cannot be read. problem: why the serial
    number cannot select the device, and the remedy; empty if it can.
    """

    device: Any
    serial: str
    problem: str = ""

    @property
    def address(self) -> str:
        """Bus and address of the device."""
        return f"bus {self.device.bus}, address {self.device.address}"


@dataclass(frozen=True)
class UsbKind:
    """The devices that one backend drives, and its messages about them.

    name: name of the backend, with which all messages begin. usb: as `Backend.usb`. gone: message about a device that
    is gone: whether it still sounds, and the remedy. hangs: possible reasons for a timeout. anonymous: message about a
    device without a serial number.
    """

    name: str
    usb: tuple[tuple[int, int] | tuple[int, int, int], ...]
    gone: str = (
        "it is gone (unplugged, reset or without power): plug it in, and open the backend again"
    )
    hangs: str = HANGS
    anonymous: str = "it has no serial number, by which it could be chosen"

    def list_devices(self, library: Any = None) -> list[ListedDevice]:
        """List the devices that are plugged in, sorted by serial. None of them stays open.

        library: backend of pyusb; by default libusb. Devices that disappear during the call are left out. Raises
        BackendError.
        """
        import usb.core
        import usb.util

        try:
            every: Any = usb.core.find(find_all=True, backend=library, custom_match=self._ours)
            listed = list(every)
        except usb.core.NoBackendError as error:
            raise BackendError(f"{self.name}: {LIBRARY}") from error
        except usb.core.USBError as error:
            raise self.convert_error(error, "looking for devices") from error
        found: list[ListedDevice] = []
        for device in listed:
            if (one := self._read(device)) is not None:
                found.append(one)
            usb.util.dispose_resources(device)
        return sorted(found, key=lambda one: one.serial)

    def describe(self, title: str, library: Any = None) -> list[tuple[str, str, str]]:
        """Return serial, title and problem of each device, for `FoundDevice`; only a problem if the search fails."""
        try:
            return [
                (one.serial, f"{title}, {one.address}", one.problem)
                for one in self.list_devices(library)
            ]
        except BackendError as error:
            return [("", "", str(error).removeprefix(f"{self.name}: "))]

    def select(self, listed: Sequence[ListedDevice], serial: str = "") -> ListedDevice:
        """Return the device with that serial number, or the only device if `serial` is empty.

        Raises BackendError, which lists the devices and why some of them cannot be selected.
        """
        readable = [one for one in listed if not one.problem]
        found = [one for one in readable if serial in ("", one.serial)]
        if len(found) == 1:
            return found[0]
        which = f"{self.name} {serial}".rstrip()
        if found and serial:
            where = " and ".join(one.address for one in found)
            raise BackendError(
                f"{which}: {len(found)} devices have this serial number, at {where}: unplug one"
            )
        there = ", ".join(one.serial for one in readable) or "none"
        problems = "".join(f"; {one.address}: {one.problem}" for one in listed if one.problem)
        trouble = "there are several: say which" if found else "is not connected"
        raise BackendError(f"{which}: {trouble}; there are: {there}{problems}")

    def find_interface(self, device: Any) -> Any:
        """Return the interface by which a pyusb device is of this kind; None if it is not.

        Reads descriptors only. If vendor and product identify the device, this is its first interface.
        """
        whole = (device.idVendor, device.idProduct) in self.usb
        for configuration in device:
            for one in configuration:
                kind = one.bInterfaceClass, one.bInterfaceSubClass, one.bInterfaceProtocol
                if whole or kind in self.usb:
                    return one
        return None

    def convert_error(
        self, error: Exception, doing: str, serial: str = "", address: tuple[int, int] = (0, 0)
    ) -> BackendError:
        """Convert an error of pyusb to a BackendError, for the caller to raise.

        doing: description of the action that failed. serial: serial of the device. address: its bus and address.
        """
        text = self.gone if has_gone(error) else f"{doing}: {advice(error, address, self.hangs)}"
        return BackendError(f"{self.name} {serial}".rstrip() + f": {text}")

    def _ours(self, device: Any) -> bool:
        whole = (device.idVendor, device.idProduct) in self.usb
        with suppress(Exception):  # a device with unreadable interfaces is not of this kind
            return whole or self.find_interface(device) is not None
        return False

    def _read(self, device: Any) -> ListedDevice | None:
        """Read the serial number of a device. Returns None if the device is gone."""
        import usb.core

        try:
            read_configuration(
                device
            )  # raises the reason of a failure, which the next line would hide
            serial = str(device.serial_number or "")
            return ListedDevice(device, serial, "" if serial else self.anonymous)
        except (usb.core.USBError, NotImplementedError) as error:
            return (
                None
                if has_gone(error)
                else ListedDevice(device, "", advice(error, hangs=self.hangs))
            )
        except ValueError:  # pyusb cannot read the strings that the descriptor announces
            return ListedDevice(device, "", UNREADABLE)
