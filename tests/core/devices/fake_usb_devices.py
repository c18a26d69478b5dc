"""Fake USB devices that record what they receive."""

from __future__ import annotations

from typing import Any

import pytest

import pacinian as pc
from pacinian.devices.usb import UsbKind
from pacinian.testing import UsbBus, UsbDevice

PADS = UsbKind("pads", ((0x1209, 0x0002),), gone="it is gone: push it in")
KIND = UsbKind("pads", ((0xFF, 0x41, 0x01),))
UDEV = (
    "this user may not open it: install the udev rule that `pacinian devices udev` prints, "
    "then unplug it and plug it in again"
)
HANGS = "it hangs, or the bus is overloaded"


class Pad(UsbDevice):
    """A device that accepts frames, answers request 1 with its bytes, accepts 2, and stalls all others."""

    vendor, product = 0x1209, 0x0002
    endpoints = 0x81, 0x02

    def __init__(self, serial: str | None = "A") -> None:
        super().__init__(serial)
        self.took, self.told, self.resets = b"", list[Any](), 0

    def take(self, data: bytes, timeout: float) -> int:
        self.took += data
        return len(data)

    def control(self, setup: tuple[int, int, int, int], data: bytes) -> bytes | None:
        self.told.append((setup, data))
        return {1: self.took, 2: b""}.get(setup[1])

    def reset(self) -> None:
        self.resets += 1


def plugged(*serials: str | None) -> tuple[UsbBus, list[Pad]]:
    pads = [Pad(serial) for serial in serials]
    return UsbBus(*pads), pads


def refused(act: Any, message: str) -> None:
    with pytest.raises(pc.BackendError) as caught:
        act()
    assert str(caught.value) == message
