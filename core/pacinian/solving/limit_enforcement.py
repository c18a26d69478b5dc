"""Gains kept within the limits, whatever a solver has written."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from pacinian.solving.problem import Limits
    from pacinian.types import Complexes

ROUNDING = 1e-5  # a gain this little over the limit is shortened, the others left as they are


def enforce_limits(g: Complexes, limits: Limits, scale: str) -> tuple[bool, bool]:
    """Scale gains (N,) as a whole, in place, down to the limits, or for "max" up to them too.

    Returns whether they were finite (if not, they are zero now) and whether they were over. Rounding
    cannot leave a gain above the limit, in exact arithmetic.
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
        share = np.abs(g) / strongest  # 0..1, so that squares neither vanish nor overflow
        root = strongest * math.sqrt(float((share.astype(np.float64) ** 2).sum()))
        power = math.sqrt(limits.power) * (1.0 - 2.0**-21) / root
        most = min(power, 1.0)
        factor = min(factor, power)
    over = factor < 1.0 - ROUNDING
    if not over and scale != "max":
        factor = most
    # what rounding cannot push over
    rounding = 2.0**-21 if g.dtype == np.complex64 else 2.0**-50
    highest = math.inf if limits.gain is None else limits.gain * (1.0 - rounding)
    if factor != 1.0 or strongest > highest:
        kernels.restrain(g, factor, highest)
    return True, over
