"""The reference device on USB, and what can go wrong with it."""

from __future__ import annotations

import errno
import math
import struct
import threading
import time
from typing import TYPE_CHECKING

from pacinian_plugins.backends.usb_autd.model import Device, Stalled
from pacinian_plugins.backends.usb_autd.protocol import ENDPOINT, INTERFACE, PRODUCT, VENDOR
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport

from .port import Answer, Port

if TYPE_CHECKING:
    from collections.abc import Callable

    from .port import Transfer

IN = 0x80
ASK, TELL = 0xC1, 0x41  # of the vendor, to the interface
GET_DESCRIPTOR, SET_CONFIGURATION, CLEAR_HALT = (0x80, 6), (0x00, 9), (0x02, 1)
STALL = Answer(-errno.EPIPE)


class Plugged:
    """A device, to be plugged in.

    now: its model's clock [s]. fault: of bulk writes: "unplug", "stall", "timeout", "hang" (no answer to control
    requests either), or a number of bytes after which one ends. kill: called in the middle of the next write.
    """

    def __init__(
        self,
        serial: str,
        units: int = 1,
        *,
        now: Callable[[], float] = time.perf_counter,
        vendor: int = VENDOR,
        interface: tuple[int, int, int] = INTERFACE,
    ) -> None:
        self.serial, self._now = serial, now
        can = CapabilityReport(units=units, serial=serial, firmware="model 1.0")
        self._asked = 0.0  # [s]: what its clock said last
        self.model = Device(can, self._time)
        self.lock = threading.Lock()
        """Held while the model is told or asked something."""
        self.fault: str | int | None = None
        self.kill: Callable[[], None] | None = None
        self.told: list[tuple[float, int]] = []
        """When it was told what, but for frames."""
        self.written = -math.inf  # [s]: the last frame
        self._halted = False
        self._descriptors = descriptors(vendor, interface, serial)
        self._port: Port | None = None

    def plug(self) -> None:
        """Plug it in, or in again."""
        self.fault, self._halted = None, False
        self._port = Port(self._answer)

    def unplug(self) -> None:
        """Pull the cable, if it is plugged in."""
        if self._port is not None:
            self._port.close()
            self._port = None
        with self.lock:
            self.model.reset()

    def _time(self) -> float:
        self._asked = self._now()
        return self._asked

    def _answer(self, transfer: Transfer) -> Answer | None:
        if transfer.endpoint:
            return self._bulk(transfer.data)
        kind, request, value, index, length = transfer.setup
        if (kind, request) == GET_DESCRIPTOR:
            found = self._descriptors.get(value, b"")[:length]
            return Answer(0, len(found), found) if found else STALL
        if self.fault == "hang":
            return None
        with self.lock:
            if kind == ASK:
                report = self.model.ask(request)[:length]
                return Answer(0, len(report), report)
            if kind == TELL:
                return self._tell(request, transfer.data)
            if (kind, request) == SET_CONFIGURATION:
                self.model.reset()
            if (kind, request, index) == (*CLEAR_HALT, ENDPOINT):
                self._halted = False
        return Answer(0, length, bytes(length)) if kind & IN else Answer()

    def _tell(self, request: int, data: bytes) -> Answer:
        try:
            self.model.tell(request, data)
        except Stalled:
            return STALL
        self.told.append((self._asked, request))
        return Answer(0, len(data))

    def _bulk(self, data: bytes) -> Answer | None:
        fault = self.fault
        if fault in ("timeout", "hang"):
            return None
        self.fault = None
        self._halted |= fault == "stall"
        if self._halted:
            return STALL
        half, whole = len(data) // 2, len(data)
        taken = fault if isinstance(fault, int) else half if fault == "unplug" else whole
        with self.lock:
            self.model.write(data[:taken])
            self.written = self._asked
            if fault == "unplug" and self._port is not None:
                self._port.pull()
                self.model.reset()
        if self.kill is not None:
            self.kill()
            self.kill = None
        return Answer(0, taken)


def descriptors(vendor: int, interface: tuple[int, int, int], serial: str) -> dict[int, bytes]:
    """By kind and index, as they are asked for: one interface with a bulk OUT endpoint of 512 bytes."""
    device = struct.pack(
        "<BBHBBBBHHHBBBB", 18, 1, 0x200, 0, 0, 0, 64, vendor, PRODUCT, 0x100, 1, 2, 3, 1
    )
    parts = struct.pack("<9B", 9, 4, 0, 0, 1, *interface, 0)
    parts += struct.pack("<4BHB", 7, 5, ENDPOINT, 2, 512, 0)
    whole = struct.pack("<BBHBBBBB", 9, 2, 9 + len(parts), 1, 1, 0, 0xC0, 0) + parts
    texts = [t.encode("utf-16-le") for t in ("Pacinian", "AUTD units", serial)]
    strings = [b"\x09\x04", *texts]
    named = {0x300 + i: bytes([len(t) + 2, 3]) + t for i, t in enumerate(strings)}
    return {0x100: device, 0x200: whole, **named}
