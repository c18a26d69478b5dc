"""Newton steps on the multipliers, towards pressures whose sizes, or values where fixed, are as asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np
from numba import complex64 as c8
from numba import complex128 as c16
from numba import float64 as f8
from numba import int64 as i8
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled
from pacinian.solving.kernels import SEALED
from pacinian_plugins.solvers.lagrange.small import factor, substitute, turned
from pacinian_plugins.solvers.lagrange.sweeps import curvature, evaluate

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats, Gains, Indices, Singles

FEW = (
    0.4  # share of the transducers at their limit up to which they are taken out of the Gram matrix
)
STALLED = 0.7  # of the last error: less progress than this twice in a row is none


@compiled("i8(c16[::1], b1[::1], f8[:, ::1], c16[::1], f4[:, ::1], i8[::1], f8[::1], f8[::1])")
def equations(
    p: Complexes, free: Flags, made: Floats, y: Complexes, u: Singles, sample: Indices, F: Floats,
    found: Floats,
) -> int:  # fmt: skip
    """Write each equation's phasor u, (2, K), its sample, and what it lacks, F; return K.

    found[0]: ||asked - made|| [Pa], free phases being as made.
    """
    K, miss = 0, 0.0
    for m in range(len(p)):
        q, t = complex(made[0, m], made[1, m]), abs(p[m])
        a = abs(q)
        v = p[m] / t if t > 0.0 else 1.0 + 0.0j
        if free[m] and a > 0.0:
            v = q / a
        rest = t * v - q
        miss += rest.real**2 + rest.imag**2
        rest -= y[m]
        sample[K], u[0, K], u[1, K] = m, v.real, v.imag
        F[K] = rest.real * v.real + rest.imag * v.imag
        K += 1
        if not free[m]:
            sample[K], u[0, K], u[1, K] = m, -v.imag, v.real
            F[K] = rest.imag * v.real - rest.real * v.imag
            K += 1
    found[0] = np.sqrt(miss)
    return K


@compiled(
    numba.int64(
        c8[:, ::1], SEALED, c16[::1], numba.boolean[::1], f8, i8, f8,
        c16[::1], numba.float32[:, ::1], f8[:, ::1], f8[:, ::1], numba.float32[:, :, ::1],
        numba.float32[:, ::1], i8[::1], f8[::1],
    )
)  # fmt: skip
def descend(
    B: Gains, G: Complexes, p: Complexes, free: Flags, mu: float, steps: int, enough: float,
    y: Complexes, h: Singles, made: Floats, A: Floats, tile: Singles, V: Singles, which: Indices,
    found: Floats,
) -> int:  # fmt: skip
    """Solve Re(conj(u_k) (B h(B^H y) + y)) = t_k by Newton steps on the multipliers y.

    One equation per sample where its phase is `free`, along the phasor of the pressure made, two where it
    is fixed. G: B B^H, (M, M). p: targets, (M,) [Pa]. y: multipliers to start from, (M,), in place. h, made, tile,
    V, which: as in `sweeps`. A: room, (2M + 4, 2M + 4). found: ||asked - made|| / ||p||, the sum of
    c(x_n), the number at their limit; ||F|| / ||p|| and how many steps in a row did little, to go on with.
    Returns the number of steps, negative if they came to nothing.
    """
    M, N = B.shape
    most = A.shape[0]
    u, sample = np.zeros((2, most), f4), np.zeros(most, np.int64)
    F, ys = np.zeros(most), np.zeros((2, tile.shape[1]), f4)
    size = 0.0
    for m in range(M):
        size += p[m].real ** 2 + p[m].imag ** 2
    size = np.sqrt(size)
    step = 0
    while True:
        for m in range(M):
            ys[0, m], ys[1, m] = y[m].real, y[m].imag
        found[1] = evaluate(B, ys, f4(mu), h, made, tile)
        K = equations(p, free, made, y, u, sample, F, found)
        short = 0.0
        for k in range(K):
            short += F[k] * F[k]
        found[0] /= size
        short = np.sqrt(short) / size
        if short <= enough:
            return step
        if step > 0 or found[4] < 0.0:  # not where the last call ended
            found[4] = max(found[4], 0.0) + 1.0 if short > STALLED * found[3] else 0.0
        if found[4] > 1.0 or step >= steps:
            return -step - 1
        found[3] = short
        held = 0
        for n in range(N):
            held += 1 if h[2, n] > f4(mu) else 0
        found[2] = held
        few = held <= FEW * N
        if few:
            turned(G, sample[:K], u, 1.0 / mu, A)
        else:
            A[:K, :K] = 0.0
        curvature(B, sample[:K], u, h, f4(mu), few, A, V, which)
        for k in range(K):
            A[k, k] += 1.0
        factor(A, K, K)
        substitute(A, K, K, F)
        for k in range(K):
            y[sample[k]] += complex(u[0, k], u[1, k]) * F[k]
        step += 1
