"""FT232H chips on USB in memory, each with an FPGA behind it; and a backend that is open to them."""

from __future__ import annotations

import array as arrays
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_plugins.backends.openmpd import OpenMpd

from ..usb_in_memory import Bus, Plugged, error
from .fpga import Fpga

ARRAY = pc.lattice(0.16, 0.16, 0.0105)
RESET, BITMODE, LATENCY = 0, 11, 9  # requests of FTDI
STEP = 1e-4  # [s] in which a full chip is looked at again
GONE = (
    "openmpd FT1: it is gone: unplugged or reset. While it has power it PLAYS ITS LAST FRAME: switch it off, or plug "
    "it in and reset the server, or open the backend again"
)
UDEV = (
    "this user may not open it: install the udev rule that `pacinian devices udev` prints, "
    "then unplug it and plug it in again"
)
TIMEOUT = "it takes nothing: the board hangs, has no power, or the bus is overloaded"


class Chip(Plugged):
    """A chip, and its board, which has power of its own."""

    def __init__(self, serial: str, clock: ManualClock) -> None:
        super().__init__(serial, now=clock.now)
        self.clock, self.model = clock, Fpga(clock.now)
        self.interface = 0xFF, 0xFF, 0xFF
        self.requests: list[tuple[int, int]] = []

    def unplug(self) -> None:
        self.gone = True


class ChipBus(Bus):
    """The bus that they are on."""

    def get_device_descriptor(self, dev: Any) -> Any:
        made = super().get_device_descriptor(dev)
        made.idVendor, made.idProduct = 0x0403, 0x6014
        return made

    def get_interface_descriptor(self, dev: Any, intf: int, alt: int, config: int) -> Any:
        made = super().get_interface_descriptor(dev, intf, alt, config)
        made.bNumEndpoints = 2
        return made

    def get_endpoint_descriptor(self, dev: Any, ep: int, intf: int, alt: int, config: int) -> Any:
        made = super().get_endpoint_descriptor(dev, 0, intf, alt, config)
        made.bEndpointAddress = (0x81, 0x02)[ep]
        return made

    def open_device(self, dev: Any) -> Any:
        handle = super().open_device(dev)
        handle.address = dev.address
        return handle

    def set_configuration(self, handle: Any, value: int) -> None:
        self._free(handle)
        self.calls.append("set_configuration")
        handle.dev.configured = True

    def ctrl_transfer(
        self, handle: Any, kind: int, request: int, value: int, index: int, data: Any, timeout: int
    ) -> int:
        dev = handle.dev
        if kind != 0x40:
            return super().ctrl_transfer(handle, kind, request, value, index, data, timeout)
        self._there(dev)
        assert dev.holder is handle, "a chip is set up before it is claimed"
        assert index == 1
        dev.requests.append((request, value))
        if request == RESET:
            dev.model.purge()
        return 0

    def bulk_write(self, handle: Any, ep: int, intf: int, data: Any, timeout: int) -> int:
        dev, fault = handle.dev, handle.dev.fault
        self._there(dev)
        if handle.address != dev.address:  # it was plugged in again since
            raise error(19)
        assert dev.holder is handle
        assert ep == 0x02
        assert isinstance(data, arrays.array)
        dev.writes.append((len(data), timeout))
        if fault in ("timeout", "hang"):
            raise error(110)
        dev.fault = None
        if fault == "unplug":  # after some of it has arrived
            dev.model.take(bytes(data[: len(data) // 3]))
            dev.unplug()
            raise error(19)
        if fault == "stall":
            dev.halted = True
        if dev.halted:
            raise error(32)
        if isinstance(fault, int):
            return int(dev.model.take(bytes(data[:fault])))
        taken, due = 0, dev.clock.now() + 1e-3 * timeout
        while True:
            taken += dev.model.take(bytes(data[taken:]))
            if taken == len(data) or dev.clock.now() >= due:
                break
            dev.clock.advance(STEP)
        if not taken:
            raise error(110)
        return taken


class Setup:
    """Boards, plugged in, a backend that names them, and a clock that the test moves."""

    def __init__(self, *serials: str, **options: Any) -> None:
        self.clock = ManualClock()
        serials = serials or ("FT1",)
        self.chips = [Chip(serial, self.clock) for serial in serials]
        self.chip = self.chips[0]
        self.fpga: Fpga = self.chip.model
        self.bus = ChipBus(*self.chips)
        options = {"serials": list(serials), **options}
        self.backend = OpenMpd(
            library=self.bus, wait=self.clock.advance, clock=self.clock.now, **options
        )
        places = [ARRAY.positions + np.array([0.17 * k, 0.0, 0.0]) for k in range(len(serials))]
        self.array = pc.Array(np.concatenate(places), np.tile(ARRAY.normals, (len(serials), 1)))

    def open(self) -> Setup:
        self.backend.open(self.array)
        return self

    def frame(self, level: int = 40, rows: int = 2, phase: int = 0) -> pc.Frame:
        shape = rows, len(self.array)
        return pc.Frame(0, 0.0, np.full(shape, phase, np.uint16), np.full(shape, level, np.uint16))

    def play(self, ticks: int = 5, level: int = 40) -> None:
        for _ in range(ticks):
            self.backend.send(self.frame(level))
            self.clock.advance(1e-3)

    def sounding(self, after: float = 0.0) -> bool:
        self.clock.advance(after)
        return any(bool(chip.model.pulses().any()) for chip in self.chips)

    def refused(self, act: Any, message: str) -> None:
        with pytest.raises(pc.BackendError) as caught:
            act()
        assert str(caught.value) == message
