"""AUTD units on USB in memory: the reference device behind the bus."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from pacinian.testing import UsbDevice
from pacinian_plugins.backends.usb_autd.model import Device, Stalled
from pacinian_plugins.backends.usb_autd.protocol import ENDPOINT, INTERFACE, PRODUCT, VENDOR
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport

if TYPE_CHECKING:
    from collections.abc import Callable


class Units(UsbDevice):
    """A device of so many units. can: what else its capability says."""

    vendor, product, interface, endpoints = VENDOR, PRODUCT, INTERFACE, (ENDPOINT,)

    def __init__(
        self,
        serial: str = "PUA-1",
        units: int = 1,
        now: Callable[[], float] = time.perf_counter,
        **can: Any,
    ) -> None:
        super().__init__(serial)
        told = CapabilityReport(units=units, serial=serial, firmware="model 1.0", **can)
        self.model = Device(told, now)

    def take(self, data: bytes, timeout: float) -> int:
        self.model.write(data)
        return len(data)

    def control(self, setup: tuple[int, int, int, int], data: bytes) -> bytes | None:
        kind, request = setup[:2]
        try:
            if kind == 0xC1:
                return self.model.ask(request)
            self.model.tell(request, data)
        except Stalled:
            return None
        return b""

    def reset(self) -> None:
        self.model.reset()

    def unplug(self) -> None:
        super().unplug()
        self.model.reset()
