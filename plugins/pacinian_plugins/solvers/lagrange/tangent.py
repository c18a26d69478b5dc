"""The Newton step of gains: how pressures change with all that can move, and what mends them best.

A gain below its limit moves both ways, one at its limit, held there, along its phase only. The step d
solves (D + W^T S W) d = v: W, (2M, .), is how the pressures change with d, along the phasors u and across
them, S their signed weights, D the damping and, where held, the pull x conj(h) outwards, v the gradient.
W has few rows, so by Woodbury's identity d = D^-1 (v - W^T (S^-1 + W D^-1 W^T)^-1 W D^-1 v).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled
from pacinian.solving.passes import TILE, gather, load, spread
from pacinian_plugins.solvers.lagrange.small import factor, substitute
from pacinian_plugins.solvers.lagrange.sweeps import gramian

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats, Gains, Indices, Singles

AT_LIMIT = f4(1.0 - 1e-6)


@compiled("void(f4[:, ::1], f4, f8, f4[:, ::1], b1[::1], f4[::1])")
def movable(
    h: Singles, mu: np.float32, damping: float, x: Singles, held: Flags, D: Singles
) -> None:
    """Turn x = B^H y, (2, N), into the gradient v along what can move; write what is held, and D, (N,).

    damping: in units of the mean |x|.
    """
    N = x.shape[1]
    mean = 0.0
    for n in range(N):
        mean += np.sqrt(x[0, n] * x[0, n] + x[1, n] * x[1, n])
    floor = f4(damping * mean / N + 1e-30)
    for n in range(N):
        hr, hi = h[0, n], h[1, n]
        xr, xi = x[0, n] - mu * hr, x[1, n] - mu * hi
        outward = xr * hr + xi * hi
        held[n] = hr * hr + hi * hi >= AT_LIMIT * AT_LIMIT and outward > f4(0.0)
        D[n] = (outward if held[n] else mu) + floor
        if held[n]:
            along = xi * hr - xr * hi
            xr, xi = -along * hi, along * hr
        x[0, n], x[1, n] = xr, xi


@compiled("i8(f8[::1], i8[::1], f8[::1])")
def ordered(bend: Floats, order: Indices, share: Floats) -> int:
    """Write the 2M equations (along u: m, across: M + m) by sign of their weight, and its root.

    Returns how many have a positive one.
    """
    M = len(bend)
    count, negative = 0, 2 * M
    for k in range(2 * M):
        weight = 1.0 if k < M else bend[k - M]
        if weight >= 0.0:
            order[count], share[count] = k, np.sqrt(weight)
            count += 1
        else:
            negative -= 1
            order[negative], share[negative] = k, np.sqrt(-weight)
    return count


@compiled("UniTuple(f4, 2)(f4[:, ::1], i8, i8, f8)")
def phasor(u: Singles, equation: int, M: int, share: float) -> tuple[np.float32, np.float32]:
    """The phasor that an equation measures along, times its share."""
    m, s = equation % M, f4(share)
    if equation < M:
        return u[0, m] * s, u[1, m] * s
    return -u[1, m] * s, u[0, m] * s


@compiled(
    "void(c8[:, ::1], f4[:, ::1], f8[::1], i8[::1], f4[:, ::1], b1[::1], f4[::1], f8[:, ::1],"
    "f4[:, :, ::1], f4[:, ::1])"
)
def coupling(
    B: Gains, u: Singles, share: Floats, order: Indices, h: Singles, held: Flags, D: Singles,
    A: Floats, tile: Singles, V: Singles,
) -> None:  # fmt: skip
    """Write W D^-1 W^T, (2M, 2M), to the lower triangle of A.

    tile: as in `passes`. V: room, (2M rounded up to 4, 2 TILE): of each transducer one direction, then of
    those that are free the other.
    """
    M, N = B.shape
    K = 2 * M
    A[:K, :K] = 0.0
    cr, ci = np.empty(TILE, f4), np.empty(TILE, f4)
    which = np.empty(TILE, np.int64)
    for first in range(0, N, TILE):
        count = min(TILE, N - first)
        load(B, first, count, tile)
        free = 0
        for n in range(count):
            weight = f4(1.0) / np.sqrt(D[first + n])
            cr[n], ci[n] = weight, f4(0.0)
            if held[first + n]:
                cr[n], ci[n] = -h[1, first + n] * weight, h[0, first + n] * weight
            else:
                which[free] = n
                free += 1
        for k in range(K):
            ur, ui = phasor(u, order[k], M, share[k])
            row, a, b = V[k, : count + free], tile[0, order[k] % M], tile[1, order[k] % M]
            for n in range(count):
                row[n] = a[n] * (ur * cr[n] + ui * ci[n]) + b[n] * (ui * cr[n] - ur * ci[n])
            for f in range(free):
                n = which[f]
                row[count + f] = cr[n] * (a[n] * ui - b[n] * ur)
        gramian(V, K, count + free, f4(1.0), A)


@compiled(
    "void(c8[:, ::1], f4[:, ::1], f8[::1], f4[:, ::1], b1[::1], f4[::1], f4[:, ::1], f4[:, ::1],"
    "f8[:, ::1], f8[:, ::1], f4[:, :, ::1], f4[:, ::1], f4[:, ::1])"
)
def step(
    B: Gains, u: Singles, bend: Floats, h: Singles, held: Flags, D: Singles, v: Singles, d: Singles,
    p: Floats, A: Floats, tile: Singles, V: Singles, y: Singles,
) -> None:  # fmt: skip
    """Write the step d, (2, N), for the gradient v, (2, N).

    bend: the weight of what is across u, (M,). p, A, tile, V, y: room, (2, M), and as in `coupling`, `passes`.
    """
    M, N = B.shape
    K = 2 * M
    order, share, q = np.empty(K, np.int64), np.empty(K), np.empty(K)
    positive = ordered(bend, order, share)
    coupling(B, u, share, order, h, held, D, A, tile, V)
    for k in range(K):
        A[k, k] += 1.0 if k < positive else -1.0
    factor(A, K, positive)
    for n in range(N):
        d[0, n], d[1, n] = v[0, n] / D[n], v[1, n] / D[n]
    gather(B, d, p, tile)
    for k in range(K):
        ur, ui = phasor(u, order[k], M, share[k])
        q[k] = ur * p[0, order[k] % M] + ui * p[1, order[k] % M]
    substitute(A, K, positive, q)
    y[:] = f4(0.0)
    for k in range(K):
        ur, ui = phasor(u, order[k], M, share[k] * q[k])
        y[0, order[k] % M] += ur
        y[1, order[k] % M] += ui
    spread(B, y, d, tile)
    for n in range(N):
        dr, di = d[0, n], d[1, n]
        if held[n]:
            along = di * h[0, n] - dr * h[1, n]
            dr, di = -along * h[1, n], along * h[0, n]
        d[0, n], d[1, n] = (v[0, n] - dr) / D[n], (v[1, n] - di) / D[n]
