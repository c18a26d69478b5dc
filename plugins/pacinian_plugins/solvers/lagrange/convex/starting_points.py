"""Starting points: regularised pseudo-inverses. The one with the best bound is used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.solving.linalg import lapack
from pacinian.solving.propagator import mean_square
from pacinian_plugins.native import lagrange as kernels
from pacinian_plugins.solvers.lagrange.convex.newton_step import State, factor
from pacinian_plugins.solvers.lagrange.newton_time import affords_newton_step

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags
    from pacinian_plugins.solvers.lagrange.convex.dual import Dual, Point

ENDLESS = pc.Budget()
RIDGE = 1e-13  # ridge relative to the mean square of the rows plus mu
LIMITED_SHARE = 0.25  # share of transducers at their limit from which other starts are tried
MU_FACTORS = (1e1, 1e2, 1e3, 1e4, 1e5)  # factors on mu for other starts
# values of mu, relative to the mean square of the rows, for problems that have none
PLAIN = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1e0)


def begin(
    dual: Dual, gram: Complexes, y: Complexes | None = None, budget: pc.Budget = ENDLESS
) -> State:
    """Return the best start: y, (R,), if given, or an unlimited solution, for several mu while there is time."""
    none = np.zeros(len(gram), np.bool_)
    best, mu = dual.at(solve_unlimited(dual, gram, dual.mu, none)), dual.mu
    promise = np.inf
    if y is not None:
        warm = dual.at(y)
        if warm.value > best.value:
            best, mu, promise = warm, dual.mu + warm.nu, 0.0  # start with the least smoothing
    made = dual.make(best.h)
    loud = dual.rows.quiet & (np.abs(made) > dual.rows.limit)
    if y is None and (
        best.nu > 0.0 or _compute_limited_share(dual, best) > LIMITED_SHARE or loud.any()
    ):
        for near in (none, loud) if loud.any() else (none,):
            for more in MU_FACTORS:
                if not affords_newton_step(budget, len(gram) ** 3):
                    break
                point = dual.at(solve_unlimited(dual, gram, more * dual.mu, near))
                if point.value > best.value:
                    best, mu = point, more * dual.mu
        made = dual.make(best.h)
    g = np.empty_like(best.h)
    kernels.clip(best.x, dual.weight, mu - dual.mu, dual.limit, g)
    return State(best, made, g, best.r, promise=promise)


def begin_strongest(
    dual: Dual, gram: Complexes, y: Complexes | None = None, budget: pc.Budget = ENDLESS
) -> State:
    """Return the best start when the strength is maximised: Re(y^H c) = 1."""
    assert dual.along is not None
    none, scale = np.zeros(len(gram), np.bool_), mean_square(gram) or 1.0
    points: list[Point] = []
    if y is not None and (whole := float(np.vdot(dual.along, y).real)) > 0.0:
        points.append(dual.at(y / whole))
    for mu in PLAIN:
        if points and not affords_newton_step(budget, len(gram) ** 3):
            break
        points.append(dual.at(solve_unlimited(dual, gram, mu * scale, none)))
    best = max(points, key=lambda point: point.value)
    g = np.empty_like(best.h)
    kernels.clip(best.x, dual.weight, float(np.abs(best.x).mean()), dual.limit, g)
    return State(best, dual.make(best.h), g, best.r)


def solve_unlimited(dual: Dual, gram: Complexes, mu: float, near: Flags) -> Complexes:
    """Return the multipliers, (R,), of the problem without limits, without quiet rows other than the `near` ones."""
    rows = dual.rows
    own = np.where(rows.soft | near, 1.0, np.where(rows.quiet, 1.0 / rows.weight, 0.0))
    ridge = RIDGE * (mean_square(gram) + mu)
    i = np.arange(len(gram))
    S = gram.copy()
    S[i, i] += mu * own + ridge
    L = factor(S, ridge, lapack.zpotrf)
    y = mu * lapack.zpotrs(L, rows.p if dual.along is None else dual.along)[0].reshape(-1)
    if dual.along is not None:
        y /= float(np.vdot(dual.along, y).real)
    return np.asarray(y)


def _compute_limited_share(dual: Dual, point: Point) -> float:
    return float(np.mean(np.abs(point.x) > dual.mu * dual.limit))
