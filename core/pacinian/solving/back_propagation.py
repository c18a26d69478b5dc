"""Back-propagation: gains for many points if the deadline leaves no time for the Gram matrix.

The Gram matrix costs M times as much as a product with B, so its time is found by computing a small part of it.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels
from pacinian.solving.phases import initial_phases
from pacinian.solving.propagator import TILE, gram_matrix

if TYPE_CHECKING:
    from pacinian.solving.budget import Budget
    from pacinian.solving.limits import Limits
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets
    from pacinian.types import Floats, Gains

NO_GRAM_MATRIX = "back-propagated: no time for the Gram matrix"
# Number of rows of B (of columns, if these are fewer) from which the time for the Gram matrix is estimated.
MIN_ROWS = 256
# Part of B whose Gram matrix is computed to estimate that of the whole.
TRIAL_ROWS, TRIAL_COLUMNS = 128, 256
# Largest number of estimates. During the first, another program may have used the core.
TRIALS = 2
MAX_STEPS = 100  # largest number of steps; more have little effect


def affords_gram(propagator: Propagator, budget: Budget) -> bool:
    """Return whether to compute the Gram matrix, B B^H or B^H B, whichever is smaller: if it fits into the time left.

    A second solve for the same points computes it even if it does not fit. Otherwise, solves for these points would
    never become exact.
    """
    few, many = sorted(propagator.B.shape)
    if budget.endless or few < MIN_ROWS or propagator.has_gram:
        return True
    if propagator.postponed == propagator.version:
        return True
    part = propagator.B[:TRIAL_ROWS, :TRIAL_COLUMNS]
    workers = min(os.cpu_count() or 1, 1 + many // TILE)
    multiple = (few / TRIAL_ROWS) ** 2 * many / TRIAL_COLUMNS / workers
    for _ in range(TRIALS):
        begin = budget.clock()
        gram_matrix(part)
        if budget.affords(multiple * (budget.clock() - begin)):
            return True
    propagator.postponed = propagator.version
    return False


def back_propagate(
    propagator: Propagator,
    targets: Targets,
    limits: Limits,
    start: Floats | None,
    budget: Budget,
    out: Gains,
) -> int:
    """Write gains by weighted Gerchberg-Saxton steps, as many as the deadline permits; return their number.

    One step is g = B^H D^-1 (w p), with D the diagonal of B B^H. Then p takes the phases of B g, and w is multiplied by
    the square root of |p| / |B g|. A step costs two products with B. The gains are scaled as a whole to the targets and
    clipped to the gain limit; `scale="max"` scales all of them to the limit.

    start: phases to start from [rad], (M,); spread ones if None. out: (N,). Targets that no sound reaches are left out.
    """
    first, _ = initial_phases(len(targets.amplitudes), start)
    power, t = propagator.powers, targets.amplitudes
    heard = (power > 0.0) & (t > 0.0)
    t = np.where(heard, t, 0.0)
    out[:] = 0.0
    if not heard.any():
        return 0
    w = np.where(heard, 1.0 / np.where(heard, power, 1.0), 0.0)
    phases = np.where(targets.free, first, targets.phases)
    step = 0
    while True:
        step += 1
        g = propagator.adjoint(np.asarray(w * t * np.exp(1j * phases), np.complex128))
        made = propagator.apply(g)
        size = np.abs(made)
        phases = np.where(targets.free & (size > 0.0), np.angle(made), phases)
        if step == MAX_STEPS or budget.spent:
            break
        mean = float(size @ t) / float(t @ t)
        w *= np.where(size > 0.0, np.sqrt(mean * t / np.where(size > 0.0, size, 1.0)), 1.0)
    best = np.vdot(made, t * np.exp(1j * phases)) / (float(np.vdot(made, made).real) or 1.0)
    largest = float(np.abs(g).max())
    if targets.scale == "max":
        best *= (limits.gain or 1.0) / (largest * abs(best) or 1.0)
    out[:] = g * complex(best)
    if limits.gain is not None:
        kernels.limit_gains(out, 1.0, limits.gain)
    return step
