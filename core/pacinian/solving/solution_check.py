"""Evidence computed from the gains themselves: violated limits, error, objective and a proven bound."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.native import solving as kernels
from pacinian.solving.solution_status import TOLERANCE

if TYPE_CHECKING:
    from pacinian.solving.limits import Limits
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes, Floats, Gains

ROUNDING_TOLERANCE = 1e-5  # excess over a limit, relative to it, that counts as rounding
# Share of full drive. The excess over a limit below this share is given relative to this share instead of the limit,
# because rounding would dominate it.
MIN_LIMIT_SHARE = 1e-2


def measure_violations(
    propagator: Propagator,
    limits: Limits,
    targets: Targets,
    p: Complexes,
    g: Complexes,
    at_quiet: Complexes | None = None,
) -> dict[str, float]:
    """Return by how much gains g, (N,), with pressures p, (M,), break limits; see `Solution.violations`.

    at_quiet: pressures at the quiet points, (K,) [Pa], if they are known.
    """
    found: dict[str, float] = {}
    for name, top, value in (
        ("gain", limits.gain, float(np.abs(g).max())),
        ("power", limits.power, float(np.linalg.norm(g.astype(np.complex128)) ** 2)),
    ):
        if top is not None and value > (1.0 + ROUNDING_TOLERANCE) * top:
            found[name] = value / top - 1.0
    if propagator.quiet is not None and limits.quiet is not None:
        limit = np.asarray(limits.quiet[1], np.float64)  # (K,) [Pa]
        loud = np.abs(propagator.quiet.apply(g) if at_quiet is None else at_quiet)
        over = (loud - limit) / compute_excess_unit(propagator.quiet, limit)
        if len(over) and over.max() > TOLERANCE:
            found["quiet"] = float(over.max())
    if limits.zones and (above := _compute_zone_excess(propagator, limits, targets)) > TOLERANCE:
        found["zones"] = above
    if limits.exact is not None:
        chosen = limits.make_exact_mask(len(p))
        asked = targets.complex(np.angle(p))[chosen]
        size = float(np.linalg.norm(asked)) or targets.norm or 1.0
        missed = float(np.linalg.norm(asked - p[chosen])) / size
        if missed > TOLERANCE:
            found["exact"] = missed
    return found


def compute_excess_unit(quiet: Propagator, limit: Floats) -> Floats:
    """Return the pressures to which the excess over the limits of quiet points is relative, (K,) [Pa].

    quiet: of these points. limit: (K,) [Pa]. An excess of `TOLERANCE` of these counts as kept.
    """
    full = np.sqrt(max(len(quiet.array) * quiet.power, 1e-60))  # about full drive [Pa]
    return np.asarray(np.maximum(limit, MIN_LIMIT_SHARE * full))


def _compute_zone_excess(propagator: Propagator, limits: Limits, targets: Targets) -> float:
    """Return the largest excess of a target over the limit of the quiet zone that it is in, relative to the limit."""
    return max(
        float(targets.amplitudes[zone.holds(propagator.points)].max(initial=0.0)) / zone.pressure
        - 1.0
        for zone in limits.zones
    )


def measure_pressures(propagator: Propagator, g: Complexes) -> Complexes:
    """Return the sound pressures of gains, (N,), at the points, (M,) [Pa], also at those in quiet zones.

    The propagator has rows of 0 for these, so that solvers ask for nothing there.
    """
    p, quiet_subspace, points = propagator.apply(g), propagator.quiet_subspace, propagator.points
    inside = (
        np.zeros(0, np.intp)
        if quiet_subspace is None
        else np.flatnonzero(quiet_subspace.holds(points))
    )
    if len(inside):
        p[inside] = propagator.compute_rows(inside) @ g
    return p


def compute_objective(
    targets: Targets,
    p: Complexes,
    g: Complexes,
    mu: float,
    quiet_weight: float,
    error: float | None = None,
) -> float:
    """Return 1/2 sum_m w_m |t_m - p_m|^2 + mu/2 ||g||^2 for targets t of fixed phases [Pa^2].

    p: pressures, (M,) [Pa], of gains g, (N,). quiet_weight: w_m of points beside regions; other points have 1. error:
    relative error of p, if known.
    """
    rest = (targets.relative_error(p) if error is None else error) * targets.norm
    quiet = p[targets.beside]
    rest = rest * rest + quiet_weight * float(np.vdot(quiet, quiet).real)
    return float(rest + mu * kernels.power(cast("Gains", g))) / 2.0


def compute_bound(
    B: Complexes, p: Complexes, y: Complexes, mu: float, gain: float | None, weights: Floats
) -> float:
    """Return a lower bound [Pa^2] of 1/2 sum_m w_m |p - B g|_m^2 + mu/2 ||g||^2 over gains with |g_n| <= gain.

    B: (M, N). p: targets, (M,). weights: w, (M,). y: multipliers, (M,); any y gives a valid bound. The bound is the
    dual function of `lagrange`, D(y) = Re(y^H p) - sum_m |y_m|^2 / (2 w_m) - sum_n c(|B^H y|_n), with
    c(s) = s^2 / (2 mu) if s <= mu gain, and gain s - mu gain^2 / 2 otherwise.
    """
    s = np.abs(B.conj().T @ y)
    cost = s * s / (2.0 * mu)
    if gain is not None:
        cost = np.where(s <= mu * gain, cost, gain * s - mu * gain * gain / 2.0)
    return float(np.vdot(y, p).real - np.vdot(y, y / weights).real / 2.0 - cost.sum())


def relative_error(targets: Targets, p: Complexes) -> float:
    """Return ||t - p|| / ||t|| for targets t; with `scale="max"`, p, (M,) [Pa], is first scaled to their strength."""
    if targets.scale == "exact" or not targets.norm:
        return targets.relative_error(p)
    return targets.relative_error(p / (compute_reached_multiple(targets, p) or 1.0))


def compute_reached_multiple(targets: Targets, p: Complexes) -> float:
    """Return ||p|| / ||targets||, without points beside regions, for pressures p, (M,) [Pa]."""
    return float(np.linalg.norm(p[~targets.beside])) / targets.norm
