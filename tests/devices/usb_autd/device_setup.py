"""A device that is plugged in and plays, for tests of what can go wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock, UsbBus
from pacinian_plugins.backends.usb_autd import UsbAutd

from .units import Units

ARRAY = pc.autd()
AGAIN = "reset the server, or open the backend again"
GONE = (
    "usb-autd PUA-1: it is gone: unplugged, reset or without power. It is silent until it is armed: plug it in, "
    f"then {AGAIN}"
)
UDEV = (
    "this user may not open it: install the udev rule that `pacinian devices udev` prints, "
    "then unplug it and plug it in again"
)


def frame(sequence: int = 0, level: int = 200, N: int = 249, rows: int = 2) -> pc.Frame:
    shape = rows, N
    return pc.Frame(sequence, 0.0, np.zeros(shape, np.uint16), np.full(shape, level, np.uint16))


class Setup:
    """A device, plugged in and open, and a clock that the test moves."""

    def __init__(self, *serials: str, **options: Any) -> None:
        self.clock = ManualClock()
        self.plugged = [Units(s, now=self.clock.now) for s in serials or ("PUA-1",)]
        self.device = self.plugged[0]
        self.bus = UsbBus(*self.plugged)
        self.backend = UsbAutd(library=self.bus, **options)
        self.array = pc.autd(len(self.plugged))

    def open(self) -> Setup:
        self.backend.open(self.array)
        return self

    def play(self, ticks: int = 5) -> None:
        for k in range(ticks):
            self.backend.send(frame(k, N=len(self.array)))
            self.clock.advance(1e-3)

    def sounding(self) -> bool:
        return any(bool(one.model.levels()[1].any()) for one in self.plugged)

    def refused(self, act: Any, message: str) -> None:
        with pytest.raises(pc.BackendError) as caught:
            act()
        assert str(caught.value) == message
