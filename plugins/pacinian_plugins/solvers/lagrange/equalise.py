"""Weighted Gerchberg-Saxton steps at full drive: phases, and multipliers, to start anew from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled
from pacinian_plugins.solvers.lagrange.sweeps import evaluate

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Gains, Singles

ROOT = (
    0.5  # of asked / made, by which a multiplier grows: the whole of it makes two samples oscillate
)
AHEAD = 1.5  # of the way to the phases made: 1 takes twice as many steps
CLOSE = 1e-4


@compiled("i8(c8[:, ::1], c16[::1], i8, c16[::1], f4[:, ::1], f8[:, ::1], f4[:, :, ::1], f8[::1])")
def equalise(
    B: Gains, p: Complexes, steps: int, y: Complexes, h: Singles, made: Floats, tile: Singles,
    found: Floats,
) -> int:  # fmt: skip
    """Make |B h| proportional to |p| with every |h_n| = 1, from multipliers y, (M,), in place.

    h, made, tile: as in `sweeps`. All targets are above 0 and their phases free (Di Leonardo et al.,
    Opt. Express 15, 2007, here over-relaxed). found[0]: the multiple of |p| that is nearest to what is made.
    Returns the number of steps, negative if more may help.
    """
    M = len(p)
    ys, a = np.zeros((2, tile.shape[1]), f4), np.zeros(M)
    for taken in range(steps + 1):
        largest = 0.0
        for m in range(M):
            largest = max(largest, abs(y[m]))
        for m in range(M):
            y[m] = y[m] / largest if abs(y[m]) > 1e-6 * largest else 1e-6 * p[m] / abs(p[m])
            ys[0, m], ys[1, m] = y[m].real, y[m].imag
        evaluate(B, ys, f4(0.0), h, made, tile)
        top, below, all_made = 0.0, 0.0, 0.0
        for m in range(M):
            a[m] = np.hypot(made[0, m], made[1, m])
            top += a[m] * abs(p[m])
            below += abs(p[m]) ** 2
            all_made += a[m] ** 2
        found[0] = top / below
        if not top > 0.0 or all_made * below / top**2 - 1.0 < CLOSE**2:
            return taken
        if taken == steps:
            break
        level = np.sqrt(all_made / below)
        for m in range(M):
            if a[m] > 0.0:
                ratio = min(max(level * abs(p[m]) / a[m], 0.1), 10.0) ** ROOT
                turn = np.angle(complex(made[0, m], made[1, m]) * np.conj(y[m])) * AHEAD
                y[m] *= ratio * complex(np.cos(turn), np.sin(turn))
    return -steps
