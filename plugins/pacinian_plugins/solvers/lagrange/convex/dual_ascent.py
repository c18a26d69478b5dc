"""Newton ascent on the dual until the duality gap is closed. Its smoothing decreases as the ascent proceeds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.solving.propagator import mean_square
from pacinian_plugins.native import lagrange as kernels
from pacinian_plugins.solvers.lagrange.convex.answer import Answer
from pacinian_plugins.solvers.lagrange.newton_time import affords_newton_step

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Complexes
    from pacinian_plugins.solvers.lagrange.convex.dual import Dual
    from pacinian_plugins.solvers.lagrange.convex.newton_step import Newton, State

# Stop after MAX_IDLE_STEPS steps in a row that promise less than MIN_PROMISE of the tolerance.
MIN_PROMISE, MAX_IDLE_STEPS = 1e-4, 4
# Strength, relative to a row of A and the tolerance, up to which it counts as 0.
MAX_ZERO_STRENGTH = 0.1
FIRST_COST_SHARE = 0.1  # cost of the smoothing at first, as a share of D
COST_SHARE = 0.01  # its cost later, as a share of the ascent that the last step promised
LAST_COST_SHARE = 0.1  # its least cost, as a share of the tolerance
MIN_REMAINING_SHARE = 0.1  # least factor by which the smoothing of the gains decreases in one step


class Smoothing(NamedTuple):
    """Allowed cost of smoothing, as a share of D, for quiet rows, and for gains when the strength is maximised."""

    rows: float = FIRST_COST_SHARE
    gains: float = FIRST_COST_SHARE

    def next(self, promised: float, tolerance: float) -> Smoothing:
        """Return the smoothing of the next step. promised: ascent promised by the last step, as a share of D."""
        least, share = LAST_COST_SHARE * tolerance, COST_SHARE * promised
        return Smoothing(
            max(min(self.rows, share), least),
            max(min(self.gains, max(share, MIN_REMAINING_SHARE * self.gains)), least),
        )


class Trial(NamedTuple):
    """Gains within their limits, and their outcome."""

    excess: float  # largest excess over the limit of a row, or 0 [Pa]
    objective: float
    h: Complexes  # (N,)
    made: Complexes  # (R,) [Pa]
    r: Complexes  # (R,) [Pa]

    @classmethod
    def of(cls, dual: Dual, h: Complexes, made: Complexes) -> Trial:
        """Scale gains h into the limits, and evaluate them."""
        rows, c = dual.rows, dual.along
        power = float(np.vdot(h, h).real)
        shorter = math.sqrt(dual.power / power) if power > dual.power else 1.0
        if rows.quiet.any() and not rows.hard:
            shorter = min(shorter, rows.shorter(made))
        if shorter < 1.0:
            h, made, power = shorter * h, shorter * made, shorter * shorter * power
        s = 1.0 if c is None else float(np.vdot(c, made).real) / float(np.vdot(c, c).real)
        r = np.empty_like(made)
        target = rows.p if c is None else c
        excess, square = kernels.measure_excess(target, made, rows.limit, rows.slack, s, r)
        objective = (square + dual.mu * power) / 2.0 if c is None else -s
        return cls(excess, objective, h, made, r)

    def or_better(self, other: Trial | None) -> Trial:
        """Return the better of two: the smaller excess, then the smaller objective."""
        return self if other is None or self[:2] <= other[:2] else other

    def proves(self, bound: float, tolerance: float) -> bool:
        """Return whether it keeps the limits and is optimal within the relative `tolerance`."""
        return self.excess == 0.0 and self.objective - bound <= tolerance * abs(self.objective)


def ascend_dual(
    newton: Newton, dual: Dual, state: State, budget: pc.Budget, tolerance: float, steps: int
) -> Answer:
    """Ascend from `state` to a relative gap of `tolerance`, in at most `steps` steps."""
    c, scale = dual.along, mean_square(newton.gram)
    work = dual.A.shape[0] * dual.A.size
    best: Trial | None = None
    bound, smooth, idle = -math.inf, Smoothing(), 0
    late = impossible = False
    step = 0
    while True:
        point = state.point
        bound = max(bound, point.value - dual.spare(point.y))
        best = Trial.of(dual, point.h, state.made).or_better(best)
        if not best.proves(bound, tolerance):
            best = Trial.of(dual, state.g, dual.make(state.g)).or_better(best)
        if best.proves(bound, tolerance):
            break
        if c is not None and -bound <= MAX_ZERO_STRENGTH * tolerance:
            break  # no gains can make these proportions
        if budget.spent or not affords_newton_step(budget, work):
            late = True
            break
        if best.excess > 0.0 and c is None and dual.impossible(point.y, scale):
            impossible = True
            break
        slow = state.promise <= MIN_PROMISE * tolerance * abs(point.value) or state.length == 0.0
        idle = idle + 1 if slow else 0
        if step == steps or idle == MAX_IDLE_STEPS:
            break
        if idle == MAX_IDLE_STEPS - 2 and not newton.fine:
            newton, idle = newton.finer(), 0
        if dual.rows.quiet.any() or c is not None:
            size = abs(point.value)
            smooth = smooth.next(state.promise / max(size, 1e-300), tolerance)
            dual = dual.smooth(smooth.rows * size, smooth.gains * size)
            point = dual.at(point.y, point.x)
            state = state._replace(point=point, made=dual.make(point.h))
        state = newton.step(dual, state)
        step += 1
    if best.excess > 0.0 and not dual.rows.hard:
        best = Trial.of(dual, np.zeros_like(best.h), np.zeros_like(best.made))
    return Answer(
        best.h, state.point.y, best.made, best.objective, min(bound, best.objective), dual.rows.violation(best.r),
        step, late, best.excess == 0.0, impossible, -best.objective if c is not None else math.nan,
    )  # fmt: skip
