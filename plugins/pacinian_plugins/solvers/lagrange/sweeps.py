"""Passes over all transducers, fused: B is read once for each, tile by tile, in single precision.

Arguments shared by all: B [Pa], (M, N). y: multipliers, real and imaginary parts, (2, M). h: of each
transducer the real and imaginary part of h(x_n) and |x_n|, (3, N), with x = B^H y. p: B h, real and
imaginary parts, (2, M). tile: as in `pacinian.solving.passes`. Sums over a tile are single, over tiles double.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled
from pacinian.solving.passes import TILE, backward, forward, load

if TYPE_CHECKING:
    from pacinian.types import Floats, Gains, Indices, Singles


@compiled("f8(c8[:, ::1], f4[:, ::1], f4, f4[:, ::1], f8[:, ::1], f4[:, :, ::1])")
def evaluate(B: Gains, y: Singles, mu: np.float32, h: Singles, p: Floats, tile: Singles) -> float:
    """Write h(x), |x| and p for multipliers y, (2, rows of `tile`); return the sum of c(x_n).

    h = x / max(|x|, mu); c = |x|^2 / (2 mu) where |x| <= mu, else |x| - mu / 2. mu = 0: all at the limit.
    """
    N = B.shape[1]
    cost = np.float64(0.0)
    p[:] = 0.0
    half = f4(0.5) / mu if mu > f4(0.0) else f4(0.0)
    tiny = f4(1e-30)
    for first in range(0, N, TILE):
        count = min(TILE, N - first)
        load(B, first, count, tile)
        hr, hi = h[0, first : first + count], h[1, first : first + count]
        size = h[2, first : first + count]
        backward(tile, count, y, hr, hi)
        part = f4(0.0)
        for n in range(count):
            r = np.sqrt(hr[n] * hr[n] + hi[n] * hi[n])
            shorter = f4(1.0) / max(max(r, mu), tiny)
            size[n] = r
            hr[n] *= shorter
            hi[n] *= shorter
            part += r * r * half if r <= mu else r - f4(0.5) * mu
        cost += part
        forward(tile, count, hr, hi, p)
    return float(cost)


@compiled("void(f4[:, ::1], i8, i8, f4, f8[:, ::1])")
def gramian(V: Singles, K: int, count: int, sign: np.float32, A: Floats) -> None:
    """Add sign V V^T, of `count` columns, to the lower triangle of A; four rows by two at a time.

    V and A have room for K rounded up to 4.
    """
    for i in range(0, K, 4):
        v0, v1, v2, v3 = V[i, :count], V[i + 1, :count], V[i + 2, :count], V[i + 3, :count]
        for j in range(0, i + 4, 2):
            w0, w1 = V[j, :count], V[j + 1, :count]
            s00, s10, s20, s30 = f4(0.0), f4(0.0), f4(0.0), f4(0.0)
            s01, s11, s21, s31 = f4(0.0), f4(0.0), f4(0.0), f4(0.0)
            for n in range(count):
                s00 += v0[n] * w0[n]
                s10 += v1[n] * w0[n]
                s20 += v2[n] * w0[n]
                s30 += v3[n] * w0[n]
                s01 += v0[n] * w1[n]
                s11 += v1[n] * w1[n]
                s21 += v2[n] * w1[n]
                s31 += v3[n] * w1[n]
            A[i, j] += sign * s00
            A[i + 1, j] += sign * s10
            A[i + 2, j] += sign * s20
            A[i + 3, j] += sign * s30
            A[i, j + 1] += sign * s01
            A[i + 1, j + 1] += sign * s11
            A[i + 2, j + 1] += sign * s21
            A[i + 3, j + 1] += sign * s31


@compiled(
    "void(c8[:, ::1], i8[::1], i8[::1], i8, f4[:, ::1], f4[:, ::1], f4, b1, b1, f4[:, ::1], i8)"
)
def directions(
    B: Gains, sample: Indices, which: Indices, count: int, u: Singles, h: Singles, mu: np.float32,
    along: bool, lacking: bool, V: Singles, at: int,
) -> None:  # fmt: skip
    """Write the columns `at`.. of V: how Re(conj(u_m) p_m) changes as h_n moves along its size or its phase.

    Each is weighted by the root of how h moves with x, or of what that lacks against 1 / mu.
    """
    turn = np.empty((2, TILE), np.float32)
    for k in range(count):
        n = which[k]
        size = max(h[2, n], f4(1e-30))
        limited = size > mu
        weight = f4(1.0) / mu
        if lacking:
            weight = weight if along else weight - f4(1.0) / size
        elif limited:
            weight = f4(1.0) / size
        root = np.sqrt(weight)
        cr, ci = root, f4(0.0)  # any phase will do below the limit
        if limited:
            cr, ci = h[0, n] * root, h[1, n] * root
        turn[0, k] = cr if along else -ci
        turn[1, k] = ci if along else cr
    for i in range(len(sample)):
        row, b = V[i, at : at + count], B[sample[i]]
        ur, ui = u[0, i], u[1, i]
        for k in range(count):
            re, im = b[which[k]].real, b[which[k]].imag
            row[k] = re * (ur * turn[0, k] + ui * turn[1, k]) + im * (
                ui * turn[0, k] - ur * turn[1, k]
            )


@compiled(
    "void(c8[:, ::1], i8[::1], f4[:, ::1], f4[:, ::1], f4, b1, f8[:, ::1], f4[:, ::1], i8[::1])"
)
def curvature(
    B: Gains, sample: Indices, u: Singles, h: Singles, mu: np.float32, few: bool,
    A: Floats, V: Singles, which: Indices,
) -> None:  # fmt: skip
    """Add to A, (K, K), lower triangle, how Re(conj(u_i) p_i) changes with y_j = u_j.

    Where h is free it is 1 / mu in both directions, at the limit 1 / |x| along its phase. few: subtract
    instead, from 1 / mu for all, what those at their limit lack: cheap while they are few.
    sample: of each equation, (K,); u: its phasor, (2, K). V: room, (K rounded up to 4, 2 TILE);
    which: (TILE,).
    """
    N = B.shape[1]
    for first in range(0, N, TILE):
        last = min(first + TILE, N)
        limited = 0
        for n in range(first, last):
            if h[2, n] > mu:
                which[limited] = n
                limited += 1
        if few:
            if limited:
                directions(B, sample, which, limited, u, h, mu, True, True, V, 0)
                directions(B, sample, which, limited, u, h, mu, False, True, V, limited)
                gramian(V, len(sample), 2 * limited, f4(-1.0), A)
            continue
        directions(B, sample, which, limited, u, h, mu, False, False, V, 0)
        columns, free = limited, 0
        for n in range(first, last):
            if h[2, n] <= mu:
                which[free] = n
                free += 1
        directions(B, sample, which, free, u, h, mu, False, False, V, columns)
        directions(B, sample, which, free, u, h, mu, True, False, V, columns + free)
        gramian(V, len(sample), columns + 2 * free, f4(1.0), A)
