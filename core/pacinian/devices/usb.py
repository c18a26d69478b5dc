"""USB devices of one kind: those that are plugged in, and the one that is meant.

For backends: `UsbKind` finds a device, `pacinian.devices.usb_link.UsbLink` claims it. docs/plugins.md shows both.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pacinian.devices.usb_errors import HANGS, LIBRARY, UNREADABLE, advice, configured, has_gone
from pacinian.errors import BackendError

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class ListedDevice:
    """A device that is listed.

    device: of pyusb. serial: its number; empty where it has none, or it cannot be read. problem: why it cannot be
    chosen by it, and what to do; empty if it can.
    """

    device: Any
    serial: str
    problem: str = ""

    @property
    def place(self) -> str:
        """Where it is plugged in."""
        return f"bus {self.device.bus}, address {self.device.address}"


@dataclass(frozen=True)
class UsbKind:
    """Devices that one backend drives, and what its user is told of them.

    name: the backend's; messages begin with it. usb: as `Backend.usb`. gone: of one that is not there any more:
    whether it still sounds, and what to do. hangs: why one may not answer in time. anonymous: of one without a
    serial number.
    """

    name: str
    usb: tuple[tuple[int, int] | tuple[int, int, int], ...]
    gone: str = (
        "it is gone: unplugged, reset or without power: plug it in, and open the backend again"
    )
    hangs: str = HANGS
    anonymous: str = "it has no serial number, by which it could be chosen"

    def list_devices(self, library: Any = None) -> list[ListedDevice]:
        """Those that are plugged in, by serial, less those that have just gone; none of them stays open.

        library: a backend of pyusb; that of libusb unless given. Raises BackendError.
        """
        import usb.core
        import usb.util

        try:
            every: Any = usb.core.find(find_all=True, backend=library, custom_match=self._ours)
            listed = list(every)
        except usb.core.NoBackendError as error:
            raise BackendError(f"{self.name}: {LIBRARY}") from error
        except usb.core.USBError as error:
            raise self.explained(error, "looking for devices") from error
        found: list[ListedDevice] = []
        for device in listed:
            if (one := self._read(device)) is not None:
                found.append(one)
            usb.util.dispose_resources(device)
        return sorted(found, key=lambda one: one.serial)

    def describe(self, title: str, library: Any = None) -> list[tuple[str, str, str]]:
        """Serial, title and problem of each, for `Found`; a problem alone, where they cannot be looked for."""
        try:
            return [
                (one.serial, f"{title}, {one.place}", one.problem)
                for one in self.list_devices(library)
            ]
        except BackendError as error:
            return [("", "", str(error).removeprefix(f"{self.name}: "))]

    def select(self, listed: Sequence[ListedDevice], serial: str = "") -> ListedDevice:
        """The one of that serial number; the only one, if it is empty.

        Raises BackendError, which says which there are and why others cannot be picked.
        """
        readable = [one for one in listed if not one.problem]
        found = [one for one in readable if serial in ("", one.serial)]
        if len(found) == 1:
            return found[0]
        which = f"{self.name} {serial}".rstrip()
        if found and serial:
            where = " and ".join(one.place for one in found)
            raise BackendError(
                f"{which}: {len(found)} devices have this serial number, at {where}: unplug one"
            )
        there = ", ".join(one.serial for one in readable) or "none"
        problems = "".join(f"; {one.place}: {one.problem}" for one in listed if one.problem)
        trouble = "there are several: say which" if found else "is not connected"
        raise BackendError(f"{which}: {trouble}; there are: {there}{problems}")

    def interface(self, device: Any) -> Any:
        """The interface by which a device of pyusb is of this kind; None if it is not.

        Only descriptors are read. Where vendor and product are enough, it is the first one.
        """
        whole = (device.idVendor, device.idProduct) in self.usb
        for configuration in device:
            for one in configuration:
                told = one.bInterfaceClass, one.bInterfaceSubClass, one.bInterfaceProtocol
                if whole or told in self.usb:
                    return one
        return None

    def explained(
        self, error: Exception, doing: str, serial: str = "", place: tuple[int, int] = (0, 0)
    ) -> BackendError:
        """What to raise for an error of pyusb.

        doing: what failed. serial: of the device. place: its bus and address.
        """
        told = self.gone if has_gone(error) else f"{doing}: {advice(error, place, self.hangs)}"
        return BackendError(f"{self.name} {serial}".rstrip() + f": {told}")

    def _ours(self, device: Any) -> bool:
        whole = (device.idVendor, device.idProduct) in self.usb
        with suppress(Exception):  # one whose interfaces cannot be read has none of ours
            return whole or self.interface(device) is not None
        return False

    def _read(self, device: Any) -> ListedDevice | None:
        """None if it has gone."""
        import usb.core

        try:
            configured(device)  # tells why it cannot be read, which the next line does not
            serial = str(device.serial_number or "")
            return ListedDevice(device, serial, "" if serial else self.anonymous)
        except (usb.core.USBError, NotImplementedError) as error:
            return (
                None
                if has_gone(error)
                else ListedDevice(device, "", advice(error, hangs=self.hangs))
            )
        except ValueError:  # it had strings when it was plugged in
            return ListedDevice(device, "", UNREADABLE)
