"""The clock of the render loop. It is injected, so that tests run without sleeping."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator

BEHIND = 0.1  # lag up to which a loop catches up; with more, it skips ticks [s]


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


def pace(
    clock: Clock, period: float, duration: float | None = None, behind: float = BEHIND
) -> Iterator[tuple[float, int]]:
    """Wait for each tick of a loop; yield its due time [s] and the number of ticks skipped just before it.

    period: from tick to tick [s]. duration: [s], None for ever. behind: lag above which the loop skips the ticks whose
    period is over [s], but never the last tick.
    """
    begin = clock.now()
    last = math.inf if duration is None else math.ceil(duration / period - 0.5) - 1
    k = lost = 0
    while k <= last:
        due = begin + k * period
        clock.wait_until(due)
        yield due, lost
        k += 1
        lag = clock.now() - (begin + k * period)
        lost = int(min(lag / period, max(last - k, 0))) if lag > behind else 0
        k += lost
