"""When the ticks of a loop are due, and which it skips when it is late."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.rendering.clock import Clock

MAX_LAG = 0.1  # lag up to which a loop catches up; with more, it skips ticks [s]


def pace(
    clock: Clock, period: float, duration: float | None = None, max_lag: float = MAX_LAG
) -> Iterator[tuple[float, int]]:
    """Wait for each tick of a loop; yield its due time [s] and the number of ticks skipped just before it.

    period: from tick to tick [s]. duration: [s], None for ever. max_lag: lag above which the loop skips the ticks whose
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
        lost = int(min(lag / period, max(last - k, 0))) if lag > max_lag else 0
        k += lost
