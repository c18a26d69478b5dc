"""The strongest even distribution: the largest multiple of a region's targets that is made as evenly as a weak one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.solving.evidence import EVEN

if TYPE_CHECKING:
    from collections.abc import Callable

    import pacinian as pc
    from pacinian.types import Complexes, Floats

WEAK, CLOSE = 1e3, 0.005  # under full drive towards one sample; relative, of the strongest
AS_EVEN = 1.5  # times the error of a weak field: the strongest's


def climb(
    p: Complexes, reach: Floats, attempt: Callable[[Complexes], Complexes], budget: pc.Budget
) -> None:
    """Attempt multiples of targets p, (M,), the last of them the largest that is even enough: `EVEN`, or `AS_EVEN`.

    reach: the most that gains can make at each sample, (M,); where that is 0, nothing is attempted and nothing counts.
    attempt: makes targets, (M,), and returns what it made.
    """
    counts = reach > 0.0
    p = np.where(counts, p, 0.0)
    size = np.abs(p)
    asked = size > 0.0
    if not asked.any():
        return
    high = math.log(float((reach[asked] / size[asked]).min()))  # all towards one sample
    low = high - math.log(WEAK)
    enough, at, best = 0.0, low, low
    while True:
        multiple = math.exp(at)
        error = uneven(multiple * size[counts], attempt(multiple * p)[counts])
        enough = enough or max(EVEN, AS_EVEN * error)
        best, high = (at, high) if error <= enough else (best, at)
        if budget.spent or (high - best < CLOSE and best == at):
            return
        at = best if high - best < CLOSE else (best + high) / 2.0


def uneven(amplitudes: Floats, made: Complexes) -> float:
    """|| amplitudes - |made| || / ||amplitudes||."""
    return float(np.linalg.norm(amplitudes - np.abs(made)) / np.linalg.norm(amplitudes))
