"""The clock of the render loop. It is injected, so that tests run without sleeping."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """Tells the time and waits for it."""

    def now(self) -> float:
        """Return a monotonic time [s]."""
        ...

    def wait_until(self, due: float) -> None:
        """Return at `due` [s], or as soon after as possible; at once if `due` is past."""
        ...


class SystemClock:
    """The computer's monotonic clock."""

    def now(self) -> float:
        """Return a monotonic time [s]."""
        return time.perf_counter()

    def wait_until(self, due: float) -> None:
        """Return at `due` [s], or as soon after as the operating system wakes the thread."""
        left = due - time.perf_counter()
        if left > 0.0:
            time.sleep(left)
