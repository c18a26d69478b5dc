"""Devices that are plugged in, and the backend that plays on them; their clock is the test's."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import usb.core

import pacinian as pc
from pacinian_plugins.backends.usb_autd import UsbAutd
from pacinian_plugins.backends.usb_autd.link import DEVICES

from .plugged import Plugged

if TYPE_CHECKING:
    from collections.abc import Callable

LONG = 300.0  # [s]: only ends what hangs; the guest has no processor of its own
TIMEOUT = 1.0  # [s] of a transfer: the most there is, as the guest may stand still
ROW = 1 / 2000  # [s]
usb.core._DEFAULT_TIMEOUT = round(1e3 * LONG)
AGAIN = "reset the server, or open the backend again"
GONE = (
    "usb-autd PUA-1: it is gone: unplugged, reset or without power. It is silent until it is armed: plug it in, "
    f"then {AGAIN}"
)


def until(so: Callable[[], Any], seconds: float = LONG) -> Any:
    """What `so` returns once that is true."""
    due = time.monotonic() + seconds
    while not (value := so()):
        assert time.monotonic() < due, f"not within {seconds:g} s"
        time.sleep(0.01)
    return value


class Clock:
    """Moved by the test."""

    time = 0.0

    def now(self) -> float:
        return self.time


class Playing:
    """A context manager, at whose end nothing is plugged in. kind: of devices, as `Plugged` has it."""

    def __init__(self, *serials: str, kind: dict[str, Any] | None = None, **options: Any) -> None:
        self.clock = Clock()
        self.plugged = [Plugged(s, now=self.clock.now, **(kind or {})) for s in serials]
        self.device = self.plugged[0]
        self.model = self.device.model
        settings: dict[str, Any] = {"timeout": TIMEOUT, **options}
        self.backend = UsbAutd(**settings)
        self.array = pc.autd(sum(one.model.can.units for one in self.plugged))
        self.sent = 0

    def __enter__(self) -> Playing:
        for one in self.plugged:
            one.plug()
        self.places()
        return self

    def __exit__(self, *_: object) -> None:
        self.backend.close()
        for one in self.plugged:
            one.unplug()
        until(lambda: not DEVICES.list_devices())

    def places(self) -> list[str]:
        """Where they are, by serial, once the system has found them all."""
        serials = sorted(one.serial for one in self.plugged)
        until(lambda: [one.serial for one in DEVICES.list_devices()] == serials)
        return [one.address for one in DEVICES.list_devices()]

    def open(self) -> Playing:
        """Silent until something is played."""
        self.backend.open(self.array)
        return self

    def play(self, ticks: int = 4) -> None:
        """Send so many ticks of 1 ms, which the devices play; all of one level."""
        for _ in range(ticks):
            level = np.full((2, len(self.array)), 200, np.uint16)
            self.backend.send(pc.Frame(self.sent, 0.0, level, level))
            self.sent += 1
            self.clock.time += 2 * ROW

    @property
    def sounding(self) -> bool:
        """Whether any of them does."""
        return any(bool(one.model.levels()[1].any()) for one in self.plugged)

    def refused(self, act: Callable[[], Any], message: str) -> None:
        with pytest.raises(pc.BackendError) as caught:
            act()
        told = str(caught.value)
        assert told == message, told
