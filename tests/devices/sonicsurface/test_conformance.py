"""The backend keeps what every backend promises, on a real terminal."""

from __future__ import annotations

import os
import threading
from typing import TYPE_CHECKING

import pytest

from pacinian.testing import check_backend
from pacinian_plugins.backends.sonicsurface import SonicSurface

from ...waiting import PATIENCE
from .adapters import ARRAY, Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has no pseudo-terminals")


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    made = Terminal()
    yield made
    made.close()
    assert not [t for t in threading.enumerate() if t.name == "sonicsurface"]


def test_on_a_terminal(terminal: Terminal) -> None:
    def measure_gains(backend: SonicSurface) -> object:
        terminal.pump()
        return terminal.board.gains()

    check_backend(
        lambda: SonicSurface(port=terminal.name, timeout=1.0),
        ARRAY,
        measure_gains=measure_gains,
        lose=lambda backend: terminal.unplug(),
        limit=PATIENCE,
    )
