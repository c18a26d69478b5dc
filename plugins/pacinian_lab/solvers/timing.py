"""Measure the time and the memory of a call. Standard library only, because it also runs in the peers' Pythons."""

from __future__ import annotations

import math
import sys
import time
import tracemalloc
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

MAX_CALLS = 10_000  # maximum number of calls in one measurement


class Times(NamedTuple):
    """Quantiles of `samples` run times [s], by nearest rank. Below 100 samples, p99 is the maximum."""

    p50: float
    p99: float
    samples: int


def long(seconds: float) -> float:
    """Return the time [s] above which a call runs only once and its memory is not traced."""
    return max(10.0 * seconds, 0.1)


def measure(call: Callable[[], Any], seconds: float) -> tuple[Any, Times]:
    """Call once untimed, then repeatedly for `seconds`, at least once. Returns the last result and the times."""
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
        if len(times) == MAX_CALLS:
            break
    times.sort()
    return result, Times(quantile(times, 0.5), quantile(times, 0.99), len(times))


def calibrate(additions: int = 1_000_000) -> float:
    """Return the processor time of a fixed Python loop [s]. Compare times of two machines as ratios to it."""
    begin, total = time.process_time(), 0
    for i in range(additions):
        total += i
    return time.process_time() - begin


def quantile(ascending: list[float], share: float) -> float:
    """Return the smallest element that is not less than a fraction `share` of all elements."""
    return ascending[max(0, math.ceil(share * len(ascending)) - 1)]


def measure_memory(call: Callable[[], Any]) -> int:
    """Return the peak memory that one call adds [bytes], as far as Python tracks it."""
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        call()
        return max(0, tracemalloc.get_traced_memory()[1] - before)
    finally:
        tracemalloc.stop()


def resident() -> float:
    """Return the peak memory of this process [bytes], or NaN on Windows, which does not report it."""
    status = Path("/proc/self/status")
    if status.exists():  # Linux, where getrusage would include the parent's peak
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024.0 * float(line.split()[1])
    if sys.platform == "win32":
        return math.nan
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
