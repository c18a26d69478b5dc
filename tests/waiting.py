"""Waiting for what is certain to come, however slow the machine is."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")
PATIENCE = 120.0  # [s] only ends a test that hangs
LOOK = 0.002  # [s] between two looks


def eventually(seen: Callable[[], T], each: Callable[[], object] = lambda: None) -> T:
    """What `seen` returns once that is true. each: done between two looks."""
    due = time.monotonic() + PATIENCE
    while not (value := seen()):
        assert time.monotonic() < due, f"not within {PATIENCE:g} s"
        each()
        time.sleep(LOOK)
    return value
