"""Median times, for ratios within one run."""

import time
from collections.abc import Callable

import numpy as np


def measure_medians(*functions: Callable[[], object], repeats: int) -> list[float]:
    """Return the median times of functions called in turn, so that all see the same machine [s]."""
    times: list[list[float]] = [[] for _ in functions]
    for _ in range(repeats):
        for function, own in zip(functions, times, strict=True):
            begin = time.perf_counter()
            function()
            own.append(time.perf_counter() - begin)
    return [float(np.median(own)) for own in times]
