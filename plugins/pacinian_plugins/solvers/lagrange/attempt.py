"""One attempt: Newton steps, the proof of what they came to, and the gains, in one call."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np
from numba import complex64 as c8
from numba import complex128 as c16
from numba import float64 as f8
from numba import int64 as i8

from pacinian.acoustics.compiled import compiled
from pacinian.solving.kernels import SEALED
from pacinian_plugins.solvers.lagrange.descend import descend

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats, Gains, Indices, Singles


@compiled("void(c16[::1], b1[::1], f8, c16[::1], f4[:, ::1], f8[:, ::1], f8, f8[::1])")
def certify(
    p: Complexes, free: Flags, mu: float, y: Complexes, h: Singles, made: Floats, cost: float,
    proof: Floats,
) -> None:  # fmt: skip
    """Write D(y), 1/2 ||p - made||^2 + mu/2 ||h||^2 for the phases made, and how many are at their limit.

    proof: they are its elements 5 to 7. cost: the sum of c(x_n) at y.
    """
    value, miss, power, held = -cost, 0.0, 0.0, 0
    for m in range(len(p)):
        q, t = complex(made[0, m], made[1, m]), p[m]
        a = abs(q)
        if free[m] and a > 0.0:
            t = abs(t) / a * q
        value += (np.conj(y[m]) * t).real - 0.5 * abs(y[m]) ** 2
        miss += abs(t - q) ** 2
    for n in range(h.shape[1]):
        square = np.float64(h[0, n]) ** 2 + np.float64(h[1, n]) ** 2
        power += square
        held += 1 if square > (1.0 - 1e-5) ** 2 else 0
    proof[5], proof[6], proof[7] = value, 0.5 * (miss + mu * power), held


@compiled("void(f4[:, ::1], f8, c8[::1])")
def deliver(h: Singles, unit: float, out: Gains) -> None:
    """Write the gains, (N,), of those in units of the limit."""
    for n in range(len(out)):
        out[n] = complex(unit * np.float64(h[0, n]), unit * np.float64(h[1, n]))


@compiled(
    i8(
        c8[:, ::1], SEALED, c16[::1], numba.boolean[::1], f8, i8, f8,
        c16[::1], numba.float32[:, ::1], f8[:, ::1], f8[:, ::1], numba.float32[:, :, ::1],
        numba.float32[:, ::1], i8[::1], f8[::1], f8, c8[::1],
    )
)  # fmt: skip
def attempt(
    B: Gains, G: Complexes, p: Complexes, free: Flags, mu: float, steps: int, enough: float,
    y: Complexes, h: Singles, made: Floats, A: Floats, tile: Singles, V: Singles, which: Indices,
    found: Floats, unit: float, out: Gains,
) -> int:  # fmt: skip
    """As `descend`, then `certify` and `deliver`."""
    taken = descend(B, G, p, free, mu, steps, enough, y, h, made, A, tile, V, which, found)
    certify(p, free, mu, y, h, made, found[1], found)
    deliver(h, unit, out)
    return taken
