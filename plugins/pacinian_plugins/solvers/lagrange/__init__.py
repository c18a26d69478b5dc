"""Least squares under limits, solved by its Lagrange dual (end of the paper's section 4), for free or given phases.

solver.py               options, defaults; which way below solves a problem; makes the result: bound, note
solve_arguments.py      `SolveArguments`: what its gains reach; the note on gains at their limit
gain_limited_newton.py  the gain limit alone: Newton steps, their largest numbers; full drive, for other phases
multistart.py           starting phases that it tries for few samples, if the first ones do not suffice
regions.py              regions: least squares with all phases given, by conjugate gradients
strongest_uniform.py    `scale="max"` for regions: the strongest even distribution
quiet_factor.py         what the quiet factor is, and how it adapts: called by regions.py
constrained.py          power limit, quiet points, exact samples, more samples than transducers: by convex/
lbfgs_phases.py         `scale="max"` for free phases: local search by L-BFGS, called by constrained.py
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

With `scale="max"`, solver.py calls for regions only `regions.solve` and, if that violates another limit than that of
gain, `Constrained.solve_strongest_uniform`. For other targets it calls, in this order:

1. If all phases are free and all targets above 0: `GainLimitedNewton.solve_strongest`, which finds the fraction of full
   drive that keeps the proportions.
2. If 1 does not apply, leaves too much of full drive unused, or violates another limit: `Constrained.solve_strongest`.
3. After 1, if the solution is hardly stronger than a focus: `GainLimitedNewton.run` for targets of several levels, then
   `Constrained.solve_strongest` from the phases of the strongest that it met. Not with quiet points or exact samples.
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
