"""The strongest even distribution: the largest multiple of a region's targets that is about as even as a weak one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.solving.solution_status import REGION_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Callable

    import pacinian as pc
    from pacinian.types import Complexes, Floats

# factor by which the weak reference is below full drive; relative tolerance of the multiple
WEAK_DIVISOR, MULTIPLE_TOLERANCE = 1e3, 0.005
MAX_ERROR_RATIO = 1.5  # largest error allowed, as a multiple of the error of the weak reference


def find_strongest_uniform(
    p: Complexes, reach: Floats, attempt: Callable[[Complexes], Complexes], budget: pc.Budget
) -> None:
    """Attempt multiples of targets p, (M,), and end with the largest that is even enough.

    Even enough is an error of at most `REGION_TOLERANCE`, or `MAX_ERROR_RATIO` times the least error.
    reach: the most that gains can make at each sample, (M,); samples where it is 0 get no target and do not count.
    attempt: solves for targets, (M,), and returns the pressures made, (M,).
    """
    counts = reach > 0.0
    p = np.where(counts, p, 0.0)
    size = np.abs(p)
    asked = size > 0.0
    if not asked.any():
        return
    high = math.log(float((reach[asked] / size[asked]).min()))  # full drive towards one sample
    low = high - math.log(WEAK_DIVISOR)
    enough, at, best = 0.0, low, low
    while True:
        multiple = math.exp(at)
        error = compute_unevenness(multiple * size[counts], attempt(multiple * p)[counts])
        enough = enough or max(REGION_TOLERANCE, MAX_ERROR_RATIO * error)
        best, high = (at, high) if error <= enough else (best, at)
        if budget.spent or (high - best < MULTIPLE_TOLERANCE and best == at):
            return
        at = best if high - best < MULTIPLE_TOLERANCE else (best + high) / 2.0


def compute_unevenness(amplitudes: Floats, made: Complexes) -> float:
    """Return || amplitudes - |made| || / ||amplitudes||."""
    return float(np.linalg.norm(amplitudes - np.abs(made)) / np.linalg.norm(amplitudes))
