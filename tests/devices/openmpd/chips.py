"""FT232H chips on USB in memory, each with an FPGA behind it; and a backend that is open to them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock, UsbBus, UsbDevice
from pacinian_plugins.backends.openmpd import OpenMpd

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
TIMEOUT = "it does not answer in time: the board hangs, has no power, or the bus is overloaded"


class Chip(UsbDevice):
    """A chip, and its board, which has power of its own. requests: what it was set up with."""

    vendor, product, interface = 0x0403, 0x6014, (0xFF, 0xFF, 0xFF)
    endpoints = 0x81, 0x02

    def __init__(self, serial: str, clock: ManualClock) -> None:
        super().__init__(serial)
        self.clock, self.model = clock, Fpga(clock.now)
        self.requests: list[tuple[int, int]] = []

    def control(self, setup: tuple[int, int, int, int], data: bytes) -> bytes:
        kind, request, value, index = setup
        assert (kind, index) == (0x40, 1)
        assert self.holder, "a chip is set up before it is claimed"
        self.requests.append((request, value))
        if request == RESET:
            self.model.purge()
        return b""

    def take(self, data: bytes, timeout: float) -> int:
        taken, due = 0, self.clock.now() + timeout
        while True:
            taken += self.model.take(data[taken:])
            if taken == len(data) or self.clock.now() >= due:
                return taken
            self.clock.advance(STEP)


class Setup:
    """Boards, plugged in, a backend that names them, and a clock that the test moves."""

    def __init__(self, *serials: str, **options: Any) -> None:
        self.clock = ManualClock()
        serials = serials or ("FT1",)
        self.chips = [Chip(serial, self.clock) for serial in serials]
        self.chip = self.chips[0]
        self.fpga: Fpga = self.chip.model
        self.bus = UsbBus(*self.chips)
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
