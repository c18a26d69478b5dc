"""Keep gains within the limits, whatever a solver has written."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels
from pacinian.solving.solution_check import TOLERANCE, compute_excess_unit

if TYPE_CHECKING:
    from pacinian.solving.problem import Budget, Limits
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.quiet_subspace import QuietSubspace
    from pacinian.types import Complexes, Floats

MAX_CLIPPED_EXCESS = 1e-5  # relative excess up to which only the gains over the limit are clipped
MAX_PROJECTIONS = 32  # largest number of alternating projections of gains for quiet zones
MAX_QUIET_STEPS = 4  # largest number of corrections of gains for quiet points
# Largest number of quiet points for which gains are corrected. For more, they are only scaled down.
MAX_QUIET_ROWS = 512
# Regularisation of the correction of gains for quiet points, relative to the mean power of the points' rows.
QUIET_MU = 1e-6
UNCHECKED_FACTOR = 1.25  # safety factor for the places of a zone that are not checked
# Regularisation of the correction of pressures that quiet zones have changed, relative to the mean power of rows.
CORRECTION_MU = 0.1
# Largest pressure in a zone, relative to its limit, from the part of the excluded subspace that remains in the gains.
MAX_LEAK = 0.02
# Part of the excluded subspace that single precision leaves in gains g, relative to ||g||.
SINGLE_LEAK = 2e-6


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
    over = factor < 1.0 - MAX_CLIPPED_EXCESS
    if not over and scale != "max":
        factor = most
    # rounding cannot push a gain of this size over the limit
    rounding = 2.0**-21 if g.dtype == np.complex64 else 2.0**-50
    highest = math.inf if limits.gain is None else limits.gain * (1.0 - rounding)
    if factor != 1.0 or strongest > highest:
        kernels.limit_gains(g, factor, highest)
    return True, over


def enforce_quiet(g: Complexes, gain: float | None, quiet: Propagator, limit: Floats) -> None:
    """Remove from gains, (N,), in place, what exceeds the limits of quiet points; scale them down if needed.

    gain: limit of |g_n|. quiet: propagator of the quiet points. limit: their limits, (K,) [Pa]. This changes the gains
    of solves that had too little time.
    """
    most = limit + 0.5 * TOLERANCE * compute_excess_unit(quiet, limit)
    for _ in range(MAX_QUIET_STEPS):
        p = quiet.apply(g)
        loud = np.abs(p)
        if (loud <= most).all():
            return
        factor = quiet.factor(QUIET_MU * quiet.power) if len(p) <= MAX_QUIET_ROWS else None
        if factor is None or not factor.definite:
            break
        excess = p * (1.0 - np.minimum(limit / np.maximum(loud, 1e-30), 1.0))
        g -= quiet.adjoint(factor.solve(excess))
        strongest = math.sqrt(kernels.peak(g))
        if gain is not None and strongest > gain:
            kernels.limit_gains(g, gain / strongest, gain * (1.0 - 2.0**-21))
    over = float((np.abs(quiet.apply(g)) / np.maximum(most, 1e-30)).max())
    if not math.isfinite(over):
        g[:] = 0.0
    elif over > 1.0:
        g /= over


def enforce_zones(
    g: Complexes, gain: float | None, nulls: QuietSubspace, propagator: Propagator, budget: Budget
) -> None:
    """Remove `nulls` from gains, (N,), in place, and scale them down until the zones are quiet and |g_n| <= `gain`.

    Alternates (projections onto convex sets) between clipping the gains and moving them to the nearest ones outside
    `nulls` that produce the same pressures; then scales all gains down. propagator: of the samples.
    """
    p = propagator.apply(g)
    top = math.inf if gain is None else gain * (1.0 - 2.0**-21)
    for turn in range(MAX_PROJECTIONS):
        left = float(np.linalg.norm(nulls.sketch @ g.astype(np.complex64)))
        most = MAX_LEAK / nulls.loudest + SINGLE_LEAK * math.sqrt(kernels.power(g))
        if (left <= most and math.sqrt(kernels.peak(g)) <= top) or (turn and budget.spent):
            break
        kernels.limit_gains(g, 1.0, top)
        nulls.remove(g)
        factor = propagator.factor(CORRECTION_MU * propagator.power)
        if factor.definite:
            g += propagator.adjoint(factor.solve(p - propagator.apply(g)))
    if not math.isfinite(kernels.peak(g)):
        g[:] = 0.0
    over = max(1.0, UNCHECKED_FACTOR * nulls.heard(g), math.sqrt(kernels.peak(g)) / top)
    if over > 1.0:
        g /= over
        kernels.limit_gains(g, 1.0, top)
