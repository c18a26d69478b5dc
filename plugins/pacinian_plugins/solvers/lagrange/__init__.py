"""Least squares under limits, solved by its Lagrange dual (end of the paper's section 4), for free or given phases.

solver.py                      the solver's options and their defaults; which of the ways below solves a problem
problem.py                     the arguments of a solve
gain_limited.py                the gain limit alone: the stages; its kernels in dual_newton.hpp, primal_newton.hpp and
                               weighted_gs.hpp, with fused_passes.hpp, which keeps the limit
regions.py, strongest_uniform.py   regions: region_newton.hpp; their strongest even distribution
constrained.py, convex/        all other limits: one convex problem for each choice of phases
strongest_phases.py            phases for the strongest solution
reference.py, newton_time.py   the same steps in double precision; whether there is time for one
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.solvers.lagrange.solver import Lagrange

if TYPE_CHECKING:
    from collections.abc import Iterable


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [Lagrange]
