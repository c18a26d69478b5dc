"""Simulated USB: a pyusb backend with model devices, which reproduces failures that were observed on real buses."""

# ruff: noqa: D102  `usb.backend.IBackend` documents the methods

from __future__ import annotations

import errno
from array import array
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from pacinian.testing.usb_device import error

if TYPE_CHECKING:
    from pacinian.testing.usb_device import UsbDevice


class UsbBus:
    """A bus with devices: `usb.core.find(backend=bus)`. Tests call `plug`, and pyusb calls all other methods."""

    intr_write = iso_write = None  # pyusb requires these attributes

    def __init__(self, *plugged: UsbDevice) -> None:
        self.devices: list[UsbDevice] = []
        self.stale = False
        """Whether devices that are gone stay listed."""
        self.open = 0
        """Number of open handles."""
        self.calls: list[str] = []
        """Calls that change a device, in order."""
        self._addresses = 1
        for one in plugged:
            self.plug(one)

    def plug(self, one: UsbDevice) -> None:
        """Plug in a device, or plug it in again. It gets a new address."""
        self._addresses += 1
        one.address, one.gone, one.halted, one.configured = self._addresses, False, False, False
        one.holder, one.fault = None, None
        if one not in self.devices:
            self.devices.append(one)

    def enumerate_devices(self) -> Any:
        return iter([one for one in self.devices if self.stale or not one.gone])

    def get_parent(self, dev: UsbDevice) -> None:
        return None

    def get_device_descriptor(self, dev: UsbDevice) -> Any:
        return SimpleNamespace(
            bLength=18, bDescriptorType=1, bcdUSB=0x200, bDeviceClass=0, bDeviceSubClass=0, bDeviceProtocol=0,
            bMaxPacketSize0=64, idVendor=dev.vendor, idProduct=dev.product, bcdDevice=0x100, iManufacturer=1,
            iProduct=2, iSerialNumber=0 if dev.serial is None else 3, bNumConfigurations=1, address=dev.address,
            bus=1, port_number=1, port_numbers=(1,), speed=3,
        )  # fmt: skip

    def get_configuration_descriptor(self, dev: UsbDevice, config: int) -> Any:
        if config:
            raise IndexError
        return SimpleNamespace(
            bLength=9, bDescriptorType=2, wTotalLength=25, bNumInterfaces=1, bConfigurationValue=1, iConfiguration=0,
            bmAttributes=0xC0, bMaxPower=50, extra_descriptors=[],
        )  # fmt: skip

    def get_interface_descriptor(self, dev: UsbDevice, intf: int, alt: int, config: int) -> Any:
        if intf or alt:
            raise IndexError
        kind, subclass, protocol = dev.interface
        return SimpleNamespace(
            bLength=9, bDescriptorType=4, bInterfaceNumber=0, bAlternateSetting=0, bNumEndpoints=len(dev.endpoints),
            bInterfaceClass=kind, bInterfaceSubClass=subclass, bInterfaceProtocol=protocol, iInterface=0,
            extra_descriptors=[],
        )  # fmt: skip

    def get_endpoint_descriptor(
        self, dev: UsbDevice, ep: int, intf: int, alt: int, config: int
    ) -> Any:
        return SimpleNamespace(
            bLength=7, bDescriptorType=5, bEndpointAddress=dev.endpoints[ep], bmAttributes=2, wMaxPacketSize=512,
            bInterval=0, bRefresh=0, bSynchAddress=0, extra_descriptors=[],
        )  # fmt: skip

    def open_device(self, dev: UsbDevice) -> Any:
        if dev.no_user_driver:
            raise NotImplementedError("Operation not supported or unimplemented on this platform")
        if dev.denied:
            raise error(errno.EACCES)
        if dev.gone:
            raise error(errno.ENODEV)
        self.open += 1
        return SimpleNamespace(dev=dev, address=dev.address)

    def close_device(self, handle: Any) -> None:
        self.open -= 1
        if handle.dev.holder is handle:
            handle.dev.holder = None

    def set_configuration(self, handle: Any, value: int) -> None:
        dev = self._free(handle)
        self.calls.append("set_configuration")
        dev.configured = True
        dev.reset()

    def get_configuration(self, handle: Any) -> int:
        return int(_there(handle).configured)

    def claim_interface(self, handle: Any, intf: int) -> None:
        self._free(handle).holder = handle

    def release_interface(self, handle: Any, intf: int) -> None:
        _there(handle).holder = None

    def is_kernel_driver_active(self, handle: Any, intf: int) -> bool:
        return bool(handle.dev.kernel_driver_bound)

    def detach_kernel_driver(self, handle: Any, intf: int) -> None:
        self.calls.append("detach")
        handle.dev.kernel_driver_bound = False

    def attach_kernel_driver(self, handle: Any, intf: int) -> None:
        self.calls.append("attach")
        handle.dev.kernel_driver_bound = True

    def clear_halt(self, handle: Any, ep: int) -> None:
        _there(handle).halted = False

    def ctrl_transfer(
        self, handle: Any, kind: int, request: int, value: int, index: int, data: Any, timeout: int
    ) -> int:
        dev = _there(handle)
        if dev.mute:
            raise error(errno.EIO)
        if dev.fault == "hang":
            raise error(errno.ETIMEDOUT)
        if (kind, request, value >> 8) == (0x80, 6, 3):
            return _fill(data, _string(dev, value & 255))
        answer = dev.control((kind, request, value, index), b"" if kind & 0x80 else bytes(data))
        if answer is None:
            raise error(errno.EPIPE)
        return _fill(data, answer) if kind & 0x80 else len(data)

    def bulk_write(self, handle: Any, ep: int, intf: int, data: Any, timeout: int) -> int:
        dev = _there(handle)
        fault, given = dev.fault, bytes(data)
        if dev.holder is not handle or ep not in dev.endpoints or ep & 0x80:
            raise AssertionError("a write to an interface that is not claimed, or to no endpoint")
        dev.writes.append((len(given), timeout))
        if fault in ("timeout", "hang"):
            raise error(errno.ETIMEDOUT)
        dev.fault = None
        if fault == "unplug":  # after a third of the data has arrived
            dev.take(given[: len(given) // 3], 1e-3 * timeout)
            dev.unplug()
            raise error(errno.ENODEV)
        if fault == "stall":
            dev.halted = True
        if dev.halted:
            raise error(errno.EPIPE)
        if isinstance(fault, int):
            return dev.take(given[:fault], 1e-3 * timeout)
        taken = dev.take(given, 1e-3 * timeout)
        if given and not taken:
            raise error(errno.ETIMEDOUT)
        return taken

    def _free(self, handle: Any) -> UsbDevice:
        dev = _there(handle)
        if dev.kernel_driver_bound or (dev.holder is not None and dev.holder is not handle):
            raise error(errno.EBUSY)
        return dev


def _there(handle: Any) -> UsbDevice:
    """Return the device of a handle. Raises USBError if it was unplugged, or plugged in again since."""
    dev: UsbDevice = handle.dev
    if dev.gone or handle.address != dev.address:
        raise error(errno.ENODEV)
    return dev


def _string(dev: UsbDevice, index: int) -> bytes:
    if not index:
        return bytes([4, 3, 9, 4])
    text = ("Pacinian", "a model", dev.serial or "")[index - 1].encode("utf-16-le")
    return bytes([len(text) + 2, 3]) + text


def _fill(data: Any, report: bytes) -> int:
    count = min(len(report), len(data))
    data[:count] = array("B", report[:count])
    return count
