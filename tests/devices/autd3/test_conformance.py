"""The backend keeps what every backend promises."""

from __future__ import annotations

from typing import Any

import pytest

from pacinian.testing import check_backend
from pacinian_plugins.backends.autd3 import Autd3

from ...waiting import PATIENCE
from .loopback import PATIENT, frame, lost

SHORT = 0.1  # [s]


def test_on_the_emulator() -> None:
    check_backend(
        lambda: Autd3(link="emulator"),
        measure_gains=lambda backend: backend.line.gains(),
        limit=PATIENCE,
    )


@pytest.mark.deep
@pytest.mark.usefixtures("loopback")
def test_on_the_units_own_software() -> None:
    def lose(backend: Any) -> None:
        """End it; that it is gone is known when it has not answered for long enough."""
        backend.line.units = None
        lost(backend, lambda: frame(next(sequence)))
        backend.line._timeout = SHORT  # it is silenced and closed without waiting for answers

    sequence = iter(range(1, 1 << 20))
    check_backend(lambda: Autd3(link="loopback", **PATIENT), lose=lose, limit=PATIENCE)
