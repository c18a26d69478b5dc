"""Wait for events that are certain to come, however slow the machine is.

How long a test waits for a server to be ready is `READY_TIMEOUT` in `pacinian.testing.server`.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")
PATIENCE = 120.0  # [s]; ends only a test that hangs
LOOK = 0.002  # [s] between two polls


def eventually(seen: Callable[[], T], each: Callable[[], object] = lambda: None) -> T:
    """Return the value of `seen` once it is true. each: called between two polls."""
    due = time.monotonic() + PATIENCE
    while not (value := seen()):
        assert time.monotonic() < due, f"not within {PATIENCE:g} s"
        each()
        time.sleep(LOOK)
    return value
