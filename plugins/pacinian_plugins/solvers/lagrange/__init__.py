"""Least squares under limits, solved by its Lagrange dual (end of the paper's section 4), for free or given phases.

solver.py               options, defaults; which way below solves a problem; makes the result: bound, note
problem.py              `Problem`: arguments of a solve; what its gains reach; the note on gains at their limit
gain_limited_newton.py  the gain limit alone: Newton steps, their largest numbers; weighted steps for other phases
regions.py              regions: least squares with all phases given, by conjugate gradients
strongest_uniform.py    the strongest even distribution on a region
constrained.py          power limit, quiet points, exact samples, more samples than transducers: by convex/
strongest_phases.py     phases for the strongest solution, by local search
reference.py            Newton steps in double precision, NumPy
newton_time.py          is there time for one more Newton step?
convex/                 convex problems of fixed phases, with certificates
workspace.hpp           memory of a problem: made by solver.py and regions.py
newton_start.hpp        first multipliers, without a limit: called by solver.py
dual_newton.hpp         Newton steps on multipliers, bound on the error: called by gain_limited_newton.py and regions.py
primal_newton.hpp       Newton steps on gains: called by gain_limited_newton.py
newton_step.hpp         one such step: used by primal_newton.hpp
weighted_gs.hpp         weighted Gerchberg-Saxton at full drive: called by gain_limited_newton.py
region_newton.hpp       Newton steps for regions, by conjugate gradients, their limits and bound: called by regions.py
fused_passes.hpp        passes over B that keep the gain limit: called by gain_limited_newton.py and in all steps above
dense_kernels.hpp       small dense systems, scaling to single precision: called by solver.py and regions.py
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
