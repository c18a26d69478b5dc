"""Free phases for `scale="max"`: L-BFGS, a local search from given phases, for the strongest solution."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy import optimize

    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats
    from pacinian_plugins.solvers.lagrange.convex import Answer

# Maximum number of solves; relative gain of a step below which it ends.
MAX_TRIALS, MIN_STEP_GAIN = 30, 1e-5


def optimise_free_phases(
    solve: Callable[[Complexes, Complexes | None], Answer], c: Complexes, free: Flags,
    budget: pc.Budget,
) -> Answer:  # fmt: skip
    """Find the strongest multiple of c, (M,), over its `free` phases, by L-BFGS from the phases of c.

    solve: finds the strongest solution for given phases, starting from multipliers, (R,). By duality, its strength s
    is the minimum over multipliers y with Re(y^H c) = 1 of the most that gains within the limits give for y.
    Therefore d log s / d phi_m = -Re(y_m^* j c_m), the slope for L-BFGS.
    """
    from scipy import optimize

    M = len(c)
    best = solve(c, None)
    if not (best.strength > 0.0 and free.any()):
        return best
    latest = best

    def objective(angles: Floats) -> tuple[float, Floats]:
        nonlocal best, latest
        turned = c.copy()
        turned[free] *= np.exp(1j * angles)
        latest = solve(turned, latest.y)
        if not latest.strength > 0.0:
            return math.inf, np.zeros(len(angles))
        if latest.kept and latest.strength > best.strength:
            best = latest
        y = latest.y[:M] / float(np.vdot(latest.y[:M], turned).real)
        slope = np.asarray((y.conj() * 1j * turned).real[free], np.float64)
        return -math.log(latest.strength), slope

    def stop_if_out_of_time(intermediate_result: optimize.OptimizeResult) -> None:
        del intermediate_result
        if budget.spent:
            raise StopIteration

    optimize.minimize(
        objective, np.zeros(int(free.sum())), method="L-BFGS-B", jac=True, callback=stop_if_out_of_time,
        options={"maxfun": MAX_TRIALS, "ftol": MIN_STEP_GAIN},
    )  # fmt: skip
    return best
