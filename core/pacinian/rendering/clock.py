"""Time for the loop: injected, so that tests run without sleeping."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator

BEHIND = 0.1  # [s] that a loop makes up for; if it lags by more (sleep, a debugger) it goes on from there


class Clock(Protocol):
    """Tells the time and waits for it."""

    def now(self) -> float:
        """Seconds, monotonic."""
        ...

    def wait_until(self, due: float) -> None:
        """Return at `due` [s] or as soon after as possible; at once if it is past."""
        ...


class SystemClock:
    """The computer's monotonic clock."""

    def now(self) -> float:
        """Seconds, monotonic."""
        return time.perf_counter()

    def wait_until(self, due: float) -> None:
        """Return at `due` [s] or as soon after as the operating system wakes us."""
        left = due - time.perf_counter()
        if left > 0.0:
            time.sleep(left)


def pace(
    clock: Clock, period: float, duration: float | None = None, behind: float = BEHIND
) -> Iterator[tuple[float, int]]:
    """When each tick of a loop is due [s], as soon as it is, for `duration` [s], or for ever.

    period: from tick to tick [s]. behind: by how much the loop may lag [s] before it leaves out the ticks whose
    whole time is over; never the last one. With each: how many were left out before it.
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
