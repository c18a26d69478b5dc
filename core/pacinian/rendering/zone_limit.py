"""Keep quiet zones quiet on devices that round: scale solutions down whose rounded gains would be too loud there.

The solver keeps the zones for the gains before rounding. A device with few levels adds sound of its own, which may be
hundreds of times as loud.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.solving.quiet_subspace import QuietSubspace
    from pacinian.types import Gains

TOO_COARSE = "the device's levels are too coarse for the quiet zones"
# Factors on all gains for which the rounded gains are evaluated: ramps and envelopes give gains any strength.
STRENGTHS = np.linspace(1.0, 0.04, 25, dtype=np.float32)
MAX_FACTORS = 6  # largest number of factors that are tried; then the output is silent
AIM = 0.9  # loudness for which a factor is chosen, relative to the limit


def keep_zones_quiet(
    made: CachedSolution, zones: QuietSubspace, round_gains: Callable[[Gains], Gains]
) -> CachedSolution:
    """Return a solution, scaled down if its rounded gains would be louder in the zones than their limits.

    round_gains: returns gains, (N,), as rounded by the device. The zones are searched for their loudest places, see
    `QuietSubspace.measure_excess`.
    """
    factor, scaled = 1.0, made
    for attempt in range(MAX_FACTORS):
        rounded = np.stack([round_gains(a * scaled.gains) for a in STRENGTHS])
        loudness = zones.measure_excess(rounded)
        if loudness <= 1.0:
            return scaled
        # The sound that rounding adds falls more slowly than the gains, unless only phases are rounded.
        factor *= (AIM / loudness) ** (2.0 if attempt else 1.0)
        scaled = _scale(made, factor)
    return _scale(made, 0.0)


def _scale(made: CachedSolution, factor: float) -> CachedSolution:
    note = f"{TOO_COARSE}: all pressures are {factor**2:.2g} times the solver's"
    return replace(made.scale(factor, note), limited_in_zones=True)
