"""The backend keeps what every backend promises."""

from __future__ import annotations

from typing import Any

from pacinian.testing import check_backend
from pacinian_plugins.backends.openmpd import OpenMpd

from ...waiting import PATIENCE
from .chips import ARRAY, Setup


def test_on_usb_in_memory() -> None:
    it = Setup("FT1")

    def make() -> OpenMpd:
        return OpenMpd(
            library=it.bus, wait=it.clock.advance, clock=it.clock.now, serials=["FT1"], rate=2000.0
        )

    def measure_gains(backend: Any) -> Any:
        it.clock.advance(1e-3)
        return it.fpga.gains()

    check_backend(
        make,
        ARRAY,
        measure_gains=measure_gains,
        lose=lambda backend: it.chip.unplug(),
        limit=PATIENCE,
    )
    assert it.bus.open == 0
