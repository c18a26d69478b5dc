"""How long a call takes and how much memory: standard library only, for it runs in the peers' Pythons too."""

from __future__ import annotations

import math
import sys
import time
import tracemalloc
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

MOST = 10_000  # calls of one measurement


class Times(NamedTuple):
    """Quantiles of `samples` run times [s], by nearest rank: below 100 samples p99 is the largest."""

    p50: float
    p99: float
    samples: int


def long(seconds: float) -> float:
    """What takes longer [s] is called once, and its memory not traced."""
    return max(10.0 * seconds, 0.1)


def measure(call: Callable[[], Any], seconds: float) -> tuple[Any, Times]:
    """Call once untimed, then again and again for `seconds`, at least once; return the last result too."""
    begin = time.perf_counter()
    result = call()
    end = time.perf_counter()
    if end - begin > long(seconds):
        return result, Times(end - begin, end - begin, 1)
    times: list[float] = []
    due = end + seconds
    while end < due or not times:
        begin = time.perf_counter()
        result = call()
        end = time.perf_counter()
        times.append(end - begin)
        if len(times) == MOST:
            break
    times.sort()
    return result, Times(quantile(times, 0.5), quantile(times, 0.99), len(times))


def quantile(ascending: list[float], share: float) -> float:
    """The smallest element that at least `share` of them do not exceed."""
    return ascending[max(0, math.ceil(share * len(ascending)) - 1)]


def traced(call: Callable[[], Any]) -> int:
    """The most bytes that one call holds beyond what was held before, of memory that Python knows of."""
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        call()
        return max(0, tracemalloc.get_traced_memory()[1] - before)
    finally:
        tracemalloc.stop()


def resident() -> float:
    """The most memory that this process has had [bytes]; NaN where the system does not tell (Windows)."""
    status = Path("/proc/self/status")
    if status.exists():  # Linux, where the other way counts what the parent had, too
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024.0 * float(line.split()[1])
    if sys.platform == "win32":
        return math.nan
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
