"""Kernels in the small space of K equations, in double precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Indices, Singles

SEALED = numba.types.Array(numba.complex128, 2, "C", readonly=True)
LOST = 1e-14  # of the largest diagonal element: a pivot below it is rounding


@compiled("i8(f8[:, ::1], i8, i8)")
def factor(A: Floats, K: int, positive: int) -> int:
    """Factor the lower triangle of A, (K, K) or more, in place: A = L S L^T, S = +1 then -1.

    The first `positive` pivots are to be positive, the others negative. One of the wrong sign, or that
    is rounding, becomes so large that its unknown is left at 0. Returns how many did.
    """
    lost, largest = 0, 0.0
    for i in range(K):
        largest = max(largest, abs(A[i, i]))
    for i in range(K):
        row = A[i]
        for j in range(i):
            other = A[j]
            total = 0.0
            for k in range(min(j, positive)):
                total += row[k] * other[k]
            for k in range(positive, j):
                total -= row[k] * other[k]
            row[j] = (row[j] - total) / (other[j] if j < positive else -other[j])
        total = 0.0
        for k in range(min(i, positive)):
            total += row[k] * row[k]
        for k in range(positive, i):
            total -= row[k] * row[k]
        pivot = row[i] - total if i < positive else total - row[i]
        if not pivot > LOST * largest:
            lost += 1
            pivot = 1e30 * max(largest, 1e-270)
        row[i] = np.sqrt(pivot)
    return lost


@compiled("void(f8[:, ::1], i8, i8, f8[::1])")
def substitute(L: Floats, K: int, positive: int, b: Floats) -> None:
    """Solve L S L^T x = b in place."""
    for i in range(K):
        row = L[i]
        total = 0.0
        for k in range(i):
            total += row[k] * b[k]
        b[i] = (b[i] - total) / row[i]
    for i in range(positive, K):
        b[i] = -b[i]
    for i in range(K - 1, -1, -1):
        row = L[i]
        b[i] /= row[i]
        for k in range(i):
            b[k] -= row[k] * b[i]


@compiled(
    numba.void(
        SEALED, numba.int64[::1], numba.float32[:, ::1], numba.float64, numba.float64[:, ::1]
    )
)
def turned(G: Complexes, sample: Indices, u: Singles, scale: float, A: Floats) -> None:
    """Write the lower triangle of scale Re(conj(u_i) G_ij u_j) for equations of the given samples to A."""
    for i in range(len(sample)):
        row = G[sample[i]]
        ur, ui = np.float64(u[0, i]), np.float64(u[1, i])
        for j in range(i + 1):
            z = row[sample[j]]
            vr, vi = np.float64(u[0, j]), np.float64(u[1, j])
            A[i, j] = scale * (z.real * (ur * vr + ui * vi) - z.imag * (ur * vi - ui * vr))
