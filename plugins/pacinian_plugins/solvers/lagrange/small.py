"""Kernels in the small space of K equations, in double precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np
from numba import complex128 as c16
from numba import float64 as f8
from numba import int64 as i8

from pacinian.acoustics.compiled import compiled
from pacinian.solving.kernels import GIVEN, SEALED, choose

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats, Indices, Singles

LOST = 1e-14  # of the largest diagonal element: a pivot below it is rounding


@compiled("f8(f8, f8, f8, i8)")
def within(size: float, relative: float, mu: float, N: int) -> float:
    """By how much to scale targets of norm `size` [Pa per unit limit] so that single precision can work.

    Up to the lower bound, 2 sqrt(mu), nothing reaches its limit: ||g|| <= ||p|| / (2 sqrt(mu)). Beyond the
    upper one the answer hardly changes. relative: mu over trace(G) / M.
    """
    root = np.sqrt(mu / relative)
    return float(min(max(size, np.sqrt(mu)), 1e3 * N * root) / size)


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


@compiled(
    numba.int64(
        SEALED, GIVEN, GIVEN, GIVEN, i8, f8, f8, f8, i8, c16[::1], numba.boolean[::1], c16[::1],
        c16[:, ::1], f8[::1],
    ),
    finite=False,
)  # fmt: skip
def begin(
    G: Complexes, t: Floats, phi: Floats, start: Floats, steps: int, mu: float, relative: float,
    unit: float, N: int, p: Complexes, free: Flags, y: Complexes, L: Complexes, found: Floats,
) -> int:  # fmt: skip
    """Write targets p [Pa per unit limit], with phases chosen as by `choose`, and y = mu (G + mu I)^-1 p.

    G: (M, M); for few samples it is quicker to solve here than by LAPACK. found: by how much the targets
    are scaled, as by `within`.
    """
    M = len(p)
    norm = choose(G, t, phi, start, steps, p, free)
    share = within(norm / unit, relative, mu, N)
    found[0] = share
    for m in range(M):
        p[m] *= share / unit
        y[m] = mu * p[m]
    for i in range(M):
        for j in range(i):
            total = G[i, j]
            for k in range(j):
                total -= L[i, k] * np.conj(L[j, k])
            L[i, j] = total / L[j, j].real
        pivot = G[i, i].real + mu
        for k in range(i):
            pivot -= L[i, k].real ** 2 + L[i, k].imag ** 2
        L[i, i] = np.sqrt(max(pivot, LOST * mu))
        for k in range(i):
            y[i] -= L[i, k] * y[k]
        y[i] /= L[i, i].real
    for i in range(M - 1, -1, -1):
        y[i] /= L[i, i].real
        for k in range(i):
            y[k] -= np.conj(L[i, k]) * y[i]
    return M
