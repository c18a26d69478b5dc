"""The backend keeps what every backend promises."""

from __future__ import annotations

from typing import Any

import pacinian as pc
from pacinian.testing import ManualClock, UsbBus, check_backend
from pacinian_plugins.backends.usb_autd import UsbAutd

from ...waiting import PATIENCE
from .units import Units


def test_on_usb_in_memory() -> None:
    clock = ManualClock()
    device = Units("PUA-1", now=clock.now)
    bus = UsbBus(device)

    def measure_gains(backend: Any) -> pc.Gains:
        clock.advance(1e-3)
        phase, amplitude = (levels[None] for levels in device.model.levels())
        return pc.Frame(0, 0.0, phase, amplitude).gains(backend.capability)[0]

    check_backend(
        lambda: UsbAutd(library=bus),
        measure_gains=measure_gains,
        lose=lambda backend: device.unplug(),
        limit=PATIENCE,
    )
    assert bus.open == 0


def test_pretended() -> None:
    check_backend(lambda: UsbAutd(pretend=True), pc.autd(2, 1), limit=PATIENCE)
