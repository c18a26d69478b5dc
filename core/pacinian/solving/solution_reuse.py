"""Reuse the last solution for a multiple of its targets: scale its gains, rather than solve again."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.native import solving as kernels
from pacinian.solving.limit_enforcement import MAX_CLIPPED_EXCESS
from pacinian.solving.solution import Solution
from pacinian.solving.solution_status import Status

if TYPE_CHECKING:
    from pacinian.solving.limits import Limits
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes

MAX_MULTIPLE = 1e6  # largest factor by which a solution is scaled instead of solved again


def find_multiple(
    last: Solution, g: Complexes, targets: Targets, limits: Limits, *, linear: bool
) -> float | None:
    """Return the c for which c times the gains of the last solution are the solution; None if there is none.

    last: for the same points, limits and solver. g: its gains, (N,). linear: whether the solver's gains are
    proportional to the targets, see `Solver.linear`.
    """
    c = targets.multiple(last.targets)  # NaN for none
    if c == 1.0:
        return c if not last.late and last.status is not Status.failed else None
    met = last.status in (Status.ok, Status.approximate) and targets.scale == "exact"
    met = met and not (last.late and last.targets.regions is not None)
    if (
        not (met and linear)
        or limits.couples_gains
        or (limits.zones and c > 1.0)  # the residual sound in the zones would be louder, too
        or not c > 0.0
    ):
        return None
    top = limits.top_gain * (1.0 - MAX_CLIPPED_EXCESS)
    strongest = math.sqrt(kernels.peak(g))
    held = strongest >= top or c * strongest >= top
    return c if not held and 1.0 / MAX_MULTIPLE < c < MAX_MULTIPLE else None


def scale_solution(
    last: Solution, c: float, g: Complexes, targets: Targets, seconds: float
) -> Solution:
    """Return the last solution, scaled by c.

    g: its gains, scaled, (N,). targets: c times its targets. seconds: duration of the solve [s].
    """
    y = last.multipliers
    return Solution(
        g, last.array, last.medium, last.points, targets, last.limits,
        c * last.sound_pressure, last.status, last.solver, 0,
        c * c * last.bound, c * c * last.objective, None if y is None else c * y, last.mu,
        last.violations, seconds, last.note, last.gain_limit,
        asked_phases=last.asked_phases, quiet_weight=last.quiet_weight, facing=last.facing,
    )  # fmt: skip
