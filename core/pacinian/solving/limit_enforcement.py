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
    from pacinian.types import Complexes

MAX_CLIPPED_EXCESS = 1e-5  # relative excess up to which only the gains over the limit are clipped
MAX_PROJECTIONS = 32  # largest number of steps that free gains of quiet zones within the limits
MAX_QUIET_STEPS = 4  # largest number of corrections of gains for quiet points
# Largest number of quiet points for which gains are corrected. For more, they are only scaled down.
MAX_QUIET_ROWS = 512
# Regularisation of the correction of gains for quiet points, relative to the mean power of the points' rows.
QUIET_MU = 1e-6
# Regularisation of the correction of pressures that quiet zones have changed, relative to the mean power of rows.
CORRECTION_MU = 0.5
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


def enforce_joined_limits(
    g: Complexes, limits: Limits, propagator: Propagator, budget: Budget, late: bool
) -> bool:
    """Change gains, (N,), in place, so that zones and quiet points are quiet, and limits of gain and power still hold.

    propagator: of the samples. late: whether the solver ran out of time, so that it may not have kept quiet points.
    Returns whether the gains were scaled down.
    """
    nulls, quiet = propagator.nulls, propagator.quiet
    if nulls is not None:
        enforce_zones(g, limits, nulls, propagator, budget)
    if quiet is not None and limits.quiet is not None and (late or nulls is not None):
        enforce_quiet(g, limits, quiet)
    if nulls is None:
        return False
    over = max(nulls.bound_excess(g), _compute_overdrive(g, limits))
    if over > 1.0:
        g /= over
        kernels.limit_gains(g, 1.0, _find_top(limits))
    return over > 1.0 + TOLERANCE


def enforce_quiet(g: Complexes, limits: Limits, quiet: Propagator) -> None:
    """Remove from gains, (N,), in place, what exceeds the limits of quiet points; scale them down if needed.

    quiet: propagator of the quiet points. This changes the gains of solves that had too little time, or that quiet
    zones have changed.
    """
    assert limits.quiet is not None
    limit = np.asarray(limits.quiet[1], np.float64)  # (K,) [Pa]
    if not len(limit):
        return
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
        if (over := _compute_overdrive(g, limits)) > 1.0:
            kernels.limit_gains(g, 1.0 / over, _find_top(limits))
    over = float((np.abs(quiet.apply(g)) / np.maximum(most, 1e-30)).max())
    if not math.isfinite(over):
        g[:] = 0.0
    elif over > 1.0:
        g /= over


def enforce_zones(
    g: Complexes, limits: Limits, nulls: QuietSubspace, propagator: Propagator, budget: Budget
) -> None:
    """Remove `nulls` from gains, (N,), in place, up to rounding, and bring them near the limits of gain and power.

    Finds the gains without `nulls` and within these limits whose pressures are nearest to those of g, by ADMM
    (alternating direction method of multipliers, Boyd et al. 2011): it alternates between shortening the gains and
    moving them to the nearest ones outside `nulls` with about these pressures; `debt` sums up what was shortened.
    propagator: of the samples.
    """
    p, debt = propagator.apply(g), np.zeros_like(g)
    for turn in range(MAX_PROJECTIONS):
        rounding = SINGLE_LEAK * math.sqrt(kernels.power(g))
        left = nulls.loudest * max(0.0, nulls.estimate_leak(g) - rounding)
        near = _compute_overdrive(g, limits) <= 1.0 + (0.5 * TOLERANCE if turn else 0.0)
        if (left <= MAX_LEAK and near) or (turn and budget.spent):
            break
        debt += g
        g[:] = debt
        kernels.limit_gains(g, 1.0, _find_top(limits))
        if (over := _compute_overdrive(g, limits)) > 1.0:
            g /= over
        debt -= g
        g -= debt
        nulls.remove(g)
        factor = propagator.factor(CORRECTION_MU * propagator.power)
        if factor.definite:
            g += propagator.adjoint(factor.solve(p - propagator.apply(g)))
    if not math.isfinite(kernels.peak(g)):
        g[:] = 0.0


def _find_top(limits: Limits) -> float:
    """Return the highest gain that rounding cannot push over the limit; infinity for no limit."""
    return math.inf if limits.gain is None else limits.gain * (1.0 - 2.0**-21)


def _compute_overdrive(g: Complexes, limits: Limits) -> float:
    """Return the factor by which gains, (N,), must be divided to keep the limits of gain and power, if above 1."""
    over = math.sqrt(kernels.peak(g)) / _find_top(limits)
    if limits.power is not None:
        over = max(over, math.sqrt(kernels.power(g) / limits.power) / (1.0 - 2.0**-21))
    return over
