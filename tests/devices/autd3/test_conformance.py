"""The backend keeps what every backend promises."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import check_backend
from pacinian_plugins.backends.autd3 import Autd3


def test_on_the_emulator() -> None:
    check_backend(lambda: Autd3(link="emulator"), heard=lambda backend: backend.line.gains())


@pytest.mark.usefixtures("loopback")
def test_on_the_units_own_software() -> None:
    def lose(backend: Any) -> None:
        """End it; that it is gone is known when it has not answered for long enough."""
        backend.line.units = None
        due = time.monotonic() + 30.0
        zero = np.zeros((1, 249), np.uint16)
        for sequence in range(1 << 20):
            try:
                backend.send(pc.Frame(sequence, 1e-3 * sequence, zero + sequence % 2, zero))
            except pc.BackendError:
                return
            assert time.monotonic() < due, "a loss must be noticed"

    check_backend(lambda: Autd3(link="loopback", watchdog=5.0, timeout=0.5), lose=lose)
