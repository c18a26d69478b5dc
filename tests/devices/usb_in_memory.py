"""USB in memory: a backend for pyusb whose devices are models, and which fails as real ones were seen to."""

from __future__ import annotations

import array
import errno
import time
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import usb.backend
import usb.core

from pacinian_plugins.backends.usb_autd.model import Device, Stalled
from pacinian_plugins.backends.usb_autd.protocol import ENDPOINT, INTERFACE, PRODUCT, VENDOR
from pacinian_plugins.backends.usb_autd.reports import Capability

if TYPE_CHECKING:
    from collections.abc import Callable

ERRORS = {  # errno: libusb's number, text
    errno.ENODEV: (-4, "No such device (it may have been disconnected)"),
    errno.EIO: (-1, "Input/Output Error"),
    errno.EPIPE: (-9, "Pipe error"),
    errno.EBUSY: (-6, "Resource busy"),
    errno.EACCES: (-3, "Access denied (insufficient permissions)"),
    errno.ETIMEDOUT: (-7, "Operation timed out"),
}


def error(number: int) -> usb.core.USBError:
    """As pyusb raises it."""
    code, text = ERRORS[number]
    kind = usb.core.USBTimeoutError if number == errno.ETIMEDOUT else usb.core.USBError
    return kind(text, code, number)


class Plugged:
    """A device model, plugged in.

    fault: of the next bulk write: "unplug", "stall", "timeout", "hang" (time-outs of control requests too), or a
    number of bytes after which it ends: with an exception nowhere, as pyusb reports neither a short write nor a
    time-out after some bytes.
    """

    def __init__(
        self,
        serial: str = "PUA-1",
        units: int = 1,
        now: Callable[[], float] = time.perf_counter,
        **can: Any,
    ) -> None:
        self.serial = serial
        told = Capability(units=units, serial=serial, firmware="model 1.0", **can)
        self.model = Device(told, now)
        self.address = 0  # given by the bus
        self.interface = INTERFACE
        self.fault: str | int | None = None
        self.halted = self.gone = self.configured = self.denied = self.driver = self.mute = False
        self.driverless = False  # Windows
        self.holder: object = None  # who has claimed it
        self.writes: list[tuple[int, int]] = []  # bytes, time-out [ms]

    def unplug(self) -> None:
        self.gone = True
        self.model.reset()


class Bus(usb.backend.IBackend):
    """The backend. stale: gone devices stay listed."""

    def __init__(self, *plugged: Plugged) -> None:
        self.devices: list[Plugged] = []
        self.stale = False
        self.open = 0  # handles
        self.calls: list[str] = []
        self._addresses = 1
        for one in plugged:
            self.plug(one)

    def plug(self, one: Plugged) -> None:
        """Plug in, or in again: at another address, silent."""
        self._addresses += 1
        one.address, one.gone, one.halted, one.configured = self._addresses, False, False, False
        one.holder, one.fault = None, None
        if one not in self.devices:
            self.devices.append(one)

    def enumerate_devices(self) -> Any:
        return iter([one for one in self.devices if self.stale or not one.gone])

    def get_parent(self, dev: Plugged) -> None:
        return None

    def get_device_descriptor(self, dev: Plugged) -> Any:
        return SimpleNamespace(
            bLength=18, bDescriptorType=1, bcdUSB=0x200, bDeviceClass=0, bDeviceSubClass=0, bDeviceProtocol=0,
            bMaxPacketSize0=64, idVendor=VENDOR, idProduct=PRODUCT, bcdDevice=0x100, iManufacturer=1, iProduct=2,
            iSerialNumber=3, bNumConfigurations=1, address=dev.address, bus=1, port_number=1, port_numbers=(1,),
            speed=3,
        )  # fmt: skip

    def get_configuration_descriptor(self, dev: Plugged, config: int) -> Any:
        if config:
            raise IndexError
        return SimpleNamespace(
            bLength=9, bDescriptorType=2, wTotalLength=25, bNumInterfaces=1, bConfigurationValue=1, iConfiguration=0,
            bmAttributes=0xC0, bMaxPower=50, extra_descriptors=[],
        )  # fmt: skip

    def get_interface_descriptor(self, dev: Plugged, intf: int, alt: int, config: int) -> Any:
        if intf or alt:
            raise IndexError
        kind, subclass, protocol = dev.interface
        return SimpleNamespace(
            bLength=9, bDescriptorType=4, bInterfaceNumber=0, bAlternateSetting=0, bNumEndpoints=1,
            bInterfaceClass=kind, bInterfaceSubClass=subclass, bInterfaceProtocol=protocol, iInterface=0,
            extra_descriptors=[],
        )  # fmt: skip

    def get_endpoint_descriptor(
        self, dev: Plugged, ep: int, intf: int, alt: int, config: int
    ) -> Any:
        if ep:
            raise IndexError
        return SimpleNamespace(
            bLength=7, bDescriptorType=5, bEndpointAddress=ENDPOINT, bmAttributes=2, wMaxPacketSize=512, bInterval=0,
            bRefresh=0, bSynchAddress=0, extra_descriptors=[],
        )  # fmt: skip

    def open_device(self, dev: Plugged) -> Any:
        if dev.driverless:
            raise NotImplementedError("Operation not supported or unimplemented on this platform")
        if dev.denied:
            raise error(errno.EACCES)
        self._there(dev)
        self.open += 1
        return SimpleNamespace(dev=dev)

    def close_device(self, handle: Any) -> None:
        self.open -= 1
        if handle.dev.holder is handle:
            handle.dev.holder = None

    def set_configuration(self, handle: Any, value: int) -> None:
        self._free(handle)
        self.calls.append("set_configuration")
        handle.dev.configured = True
        handle.dev.model.reset()

    def get_configuration(self, handle: Any) -> int:
        self._there(handle.dev)
        return int(handle.dev.configured)

    def claim_interface(self, handle: Any, intf: int) -> None:
        self._free(handle)
        handle.dev.holder = handle

    def release_interface(self, handle: Any, intf: int) -> None:
        self._there(handle.dev)
        handle.dev.holder = None

    def is_kernel_driver_active(self, handle: Any, intf: int) -> bool:
        return bool(handle.dev.driver)

    def detach_kernel_driver(self, handle: Any, intf: int) -> None:
        self.calls.append("detach")
        handle.dev.driver = False

    def attach_kernel_driver(self, handle: Any, intf: int) -> None:
        self.calls.append("attach")
        handle.dev.driver = True

    def clear_halt(self, handle: Any, ep: int) -> None:
        self._there(handle.dev)
        handle.dev.halted = False

    def ctrl_transfer(
        self, handle: Any, kind: int, request: int, value: int, index: int, data: Any, timeout: int
    ) -> int:
        dev = handle.dev
        self._there(dev)
        if dev.mute:
            raise error(errno.EIO)
        if dev.fault == "hang":
            raise error(errno.ETIMEDOUT)
        if (kind, request, value >> 8) == (0x80, 6, 3):
            return _fill(data, self._string(dev, value & 255))
        try:
            if kind == 0xC1:
                return _fill(data, dev.model.ask(request))
            dev.model.tell(request, bytes(data))
        except Stalled:
            raise error(errno.EPIPE) from None
        return len(data)

    def bulk_write(self, handle: Any, ep: int, intf: int, data: Any, timeout: int) -> int:
        dev, fault = handle.dev, handle.dev.fault
        self._there(dev)
        assert handle.dev.holder is handle
        assert ep == ENDPOINT
        dev.writes.append((len(data), timeout))
        if fault in ("timeout", "hang"):
            raise error(errno.ETIMEDOUT)
        dev.fault = None
        if fault == "unplug":  # after some of it has arrived
            dev.model.write(bytes(data[: len(data) // 2]))
            dev.unplug()
            raise error(errno.ENODEV)
        if fault == "stall":
            dev.halted = True
        if dev.halted:
            raise error(errno.EPIPE)
        taken = fault if isinstance(fault, int) else len(data)
        dev.model.write(bytes(data[:taken]))
        return taken

    def _there(self, dev: Plugged) -> None:
        if dev.gone:
            raise error(errno.ENODEV)

    def _free(self, handle: Any) -> None:
        self._there(handle.dev)
        holder = handle.dev.holder
        if handle.dev.driver or (holder is not None and holder is not handle):
            raise error(errno.EBUSY)

    @staticmethod
    def _string(dev: Plugged, index: int) -> bytes:
        if not index:
            return bytes([4, 3, 9, 4])
        text = ("Pacinian", "AUTD units", dev.serial)[index - 1].encode("utf-16-le")
        return bytes([len(text) + 2, 3]) + text


def _fill(data: array.array[int], report: bytes) -> int:
    count = min(len(report), len(data))
    data[:count] = array.array("B", report[:count])
    return count
