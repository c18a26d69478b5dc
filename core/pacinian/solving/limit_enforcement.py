"""Keep gains within the limits, whatever a solver has written."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from pacinian.solving.problem import Limits
    from pacinian.types import Complexes

ROUNDING = 1e-5  # relative excess up to which only the gains over the limit are clipped


def enforce_limits(g: Complexes, limits: Limits, scale: str) -> tuple[bool, bool]:
    """Scale all gains, (N,), in place by one factor, down to the limits, or for scale "max" also up to them.

    Returns whether the gains were finite (if not, they are set to zero), and whether they exceeded the limits. After
    rounding, no gain exceeds the limit, not even in exact arithmetic.
    """
    strongest = math.sqrt(kernels.peak(g))
    if math.isnan(strongest):
        g[:] = 0.0
        return False, False
    if not strongest:
        return True, False
    factor, most = math.inf if scale == "max" else 1.0, 1.0
    if limits.gain is not None:
        factor = min(factor, limits.gain / strongest)
    if limits.power is not None:
        share = np.abs(g) / strongest  # 0..1, so that squares neither underflow nor overflow
        root = strongest * math.sqrt(float((share.astype(np.float64) ** 2).sum()))
        power = math.sqrt(limits.power) * (1.0 - 2.0**-21) / root
        most = min(power, 1.0)
        factor = min(factor, power)
    over = factor < 1.0 - ROUNDING
    if not over and scale != "max":
        factor = most
    # rounding cannot push a gain of this size over the limit
    rounding = 2.0**-21 if g.dtype == np.complex64 else 2.0**-50
    highest = math.inf if limits.gain is None else limits.gain * (1.0 - rounding)
    if factor != 1.0 or strongest > highest:
        kernels.restrain(g, factor, highest)
    return True, over
