"""Other starting phases for few samples: what they are, and which are worth continuing.

How many are continued at most: `Lagrange.starts` in solver.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats

MAX_MULTISTART_SAMPLES = 16  # most samples for which other starts are tried
MAX_STARTS_PER_SAMPLE = 2  # largest number of other starts, over the number of samples
CANDIDATES_PER_START = 3  # number of starts that are rated for each one that is continued
# Phase increment of the starts [turns]: the golden ratio minus 1. More digits would change the last bits of solutions.
GOLDEN_FRACTION = 0.6180339887


def count_other_starts(starts: int, free: Flags) -> int:
    """Return the number of other starts: at most `starts`, and 2 for each sample; 0 for many samples or fixed phases.

    free: whether the phase of each sample is free, (M,).
    """
    M = len(free)
    return (
        min(starts, MAX_STARTS_PER_SAMPLE * M) if M <= MAX_MULTISTART_SAMPLES and free.all() else 0
    )


def make_start(amplitudes: Floats, k: int) -> Complexes:
    """Return the targets, (M,), with the k-th set of phases. The sets differ widely; 0 is that of `weighted-gs`.

    amplitudes: of the targets, (M,).
    """
    M = len(amplitudes)
    m = np.arange(M)
    turns = GOLDEN_FRACTION * k * m * (m + k) if k else 0.5 * m * m / M
    return np.asarray(amplitudes * np.exp(2j * np.pi * turns), np.complex128)


def rate_starts(
    amplitudes: Floats, count: int, rate: Callable[[Complexes], float], budget: pc.Budget
) -> list[tuple[float, int]]:
    """Rate the first `count` starts, fewer if the time runs out; return the rating and the number k of each.

    amplitudes: of the targets, (M,). rate: returns the rating of targets, (M,).
    """
    rated = list[tuple[float, int]]()
    for k in range(count):
        if budget.spent:
            break
        rated.append((rate(make_start(amplitudes, k)), k))
    return rated
