"""Keep gains within the limits of limits.py, whatever a solver has written."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels
from pacinian.solving.solution_check import compute_excess_unit
from pacinian.solving.solution_status import TOLERANCE

if TYPE_CHECKING:
    from pacinian.solving.budget import Budget
    from pacinian.solving.limits import Limits
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.quiet_subspace import QuietSubspace
    from pacinian.types import Complexes

MAX_CLIPPED_EXCESS = 1e-5  # relative excess up to which only the gains over the limit are clipped
# Relative distance from a limit within which rounding could push a number over it, in single and double precision.
SINGLE_ROUNDING, DOUBLE_ROUNDING = 2.0**-21, 2.0**-50
MAX_ADMM_STEPS = 32  # largest number of ADMM steps of `enforce_zones`
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
    factor = math.inf if scale == "max" else 1.0
    power_factor = 1.0  # keeps the limit of power
    if limits.gain is not None:
        factor = min(factor, limits.gain / strongest)
    if limits.power is not None:
        share = np.abs(g) / strongest  # 0..1, so that squares neither underflow nor overflow
        root = strongest * math.sqrt(float((share.astype(np.float64) ** 2).sum()))
        power = math.sqrt(limits.power) * (1.0 - SINGLE_ROUNDING) / root
        power_factor = min(power, 1.0)
        factor = min(factor, power)
    over = factor < 1.0 - MAX_CLIPPED_EXCESS
    if not over and scale != "max":
        factor = power_factor
    highest = _find_top(limits, SINGLE_ROUNDING if g.dtype == np.complex64 else DOUBLE_ROUNDING)
    if factor != 1.0 or strongest > highest:
        kernels.limit_gains(g, factor, highest)
    return True, over


def enforce_pressure_limits(
    g: Complexes, limits: Limits, propagator: Propagator, budget: Budget, late: bool
) -> bool:
    """Change gains, (N,), in place, so that zones and quiet points are quiet, and limits of gain and power still hold.

    propagator: of the samples. late: whether the solver ran out of time, so that it may not have kept quiet points.
    Returns whether the gains were scaled down, by more than TOLERANCE.
    """
    scaled = False
    quiet_subspace, quiet = propagator.quiet_subspace, propagator.quiet
    if quiet_subspace is not None:
        enforce_zones(g, limits, quiet_subspace, propagator, budget)
    if quiet is not None and limits.quiet is not None and (late or quiet_subspace is not None):
        scaled = enforce_quiet(g, limits, quiet)
    if quiet_subspace is None:
        return scaled
    over = max(quiet_subspace.bound_excess(g), _compute_overdrive(g, limits))
    if over > 1.0:
        g /= over
        kernels.limit_gains(g, 1.0, _find_top(limits))
    return scaled or over > 1.0 + TOLERANCE


def enforce_quiet(g: Complexes, limits: Limits, quiet: Propagator) -> bool:
    """Remove from gains, (N,), in place, what exceeds the limits of quiet points; scale them down if needed.

    quiet: propagator of the quiet points. This changes the gains of solves that had too little time, or that quiet
    zones have changed. Returns whether the gains were scaled down, by more than TOLERANCE.
    """
    assert limits.quiet is not None
    limit = np.asarray(limits.quiet[1], np.float64)  # (K,) [Pa]
    if not len(limit):
        return False
    limits_with_tolerance = limit + 0.5 * TOLERANCE * compute_excess_unit(quiet, limit)
    divisor = 1.0  # of the gains, in all steps together
    for _ in range(MAX_QUIET_STEPS):
        p = quiet.apply(g)
        loud = np.abs(p)
        if (loud <= limits_with_tolerance).all():
            return divisor > 1.0 + TOLERANCE
        factor = quiet.factor(QUIET_MU * quiet.power) if len(p) <= MAX_QUIET_ROWS else None
        if factor is None or not factor.definite:
            break
        excess = p * (1.0 - np.minimum(limit / np.maximum(loud, 1e-30), 1.0))
        g -= quiet.adjoint(factor.solve(excess))
        if (over := _compute_overdrive(g, limits)) > 1.0:
            kernels.limit_gains(g, 1.0 / over, _find_top(limits))
            divisor *= over
    over = float((np.abs(quiet.apply(g)) / np.maximum(limits_with_tolerance, 1e-30)).max())
    if not math.isfinite(over):
        g[:] = 0.0
        return True
    if over > 1.0:
        g /= over
        divisor *= over
    return divisor > 1.0 + TOLERANCE


def enforce_zones(
    g: Complexes,
    limits: Limits,
    quiet_subspace: QuietSubspace,
    propagator: Propagator,
    budget: Budget,
) -> None:
    """Make gains, (N,), orthogonal to V of `quiet_subspace`, in place.

    ADMM (alternating direction method of multipliers, Boyd et al. 2011) finds those within the gain and power limits
    whose pressures are nearest to those of g. Each step clips the gains, then projects them; `dual` accumulates what
    was clipped. propagator: of the samples.
    """
    p, dual = propagator.apply(g), np.zeros_like(g)
    for step in range(MAX_ADMM_STEPS):
        rounding = SINGLE_LEAK * math.sqrt(kernels.power(g))
        left = quiet_subspace.loudest * max(0.0, quiet_subspace.estimate_leak(g) - rounding)
        near = _compute_overdrive(g, limits) <= 1.0 + (0.5 * TOLERANCE if step else 0.0)
        if (left <= MAX_LEAK and near) or (step and budget.spent):
            break
        dual += g
        g[:] = dual
        kernels.limit_gains(g, 1.0, _find_top(limits))
        if (over := _compute_overdrive(g, limits)) > 1.0:
            g /= over
        dual -= g
        g -= dual
        quiet_subspace.remove(g)
        factor = propagator.factor(CORRECTION_MU * propagator.power)
        if factor.definite:
            g += propagator.adjoint(factor.solve(p - propagator.apply(g)))
    if not math.isfinite(kernels.peak(g)):
        g[:] = 0.0


def _find_top(limits: Limits, rounding: float = SINGLE_ROUNDING) -> float:
    """Return the highest gain that rounding cannot push over the limit; infinity for no limit."""
    return limits.top_gain * (1.0 - rounding)


def _compute_overdrive(g: Complexes, limits: Limits) -> float:
    """Return the factor by which gains, (N,), must be divided to keep the limits of gain and power, if above 1."""
    over = math.sqrt(kernels.peak(g)) / _find_top(limits)
    if limits.power is not None:
        over = max(over, math.sqrt(kernels.power(g) / limits.power) / (1.0 - SINGLE_ROUNDING))
    return over
