"""Products with A, (R, N): single or double precision, sums always double."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Reals

DENSE = 0.7  # share of columns from which taking all of them is faster than picking some

SINGLE = numba.types.Array(numba.complex64, 2, "C", readonly=True)
DOUBLE = numba.types.Array(numba.complex128, 2, "C", readonly=True)
VECTOR, NUMBERS = numba.complex128[::1], numba.float64[::1]


@compiled(numba.void(SINGLE, VECTOR, VECTOR), numba.void(DOUBLE, VECTOR, VECTOR))
def adjoint(A: Complexes, y: Complexes, x: Complexes) -> None:
    """Write x = A^H y, (N,)."""
    x[:] = 0.0
    for m in range(A.shape[0]):
        row, c, d = A[m], y[m].real, y[m].imag
        if c != 0.0 or d != 0.0:
            for n in range(row.size):
                a, b = np.float64(row[n].real), np.float64(row[n].imag)
                x[n] += complex(a * c + b * d, a * d - b * c)


@compiled(numba.void(SINGLE, VECTOR, VECTOR), numba.void(DOUBLE, VECTOR, VECTOR))
def forward(A: Complexes, h: Complexes, made: Complexes) -> None:
    """Write made = A h, (R,)."""
    for m in range(A.shape[0]):
        row, re, im = A[m], 0.0, 0.0
        for n in range(row.size):
            a, b = np.float64(row[n].real), np.float64(row[n].imag)
            re += a * h[n].real - b * h[n].imag
            im += a * h[n].imag + b * h[n].real
        made[m] = complex(re, im)


@compiled(
    *(
        numba.int64(A, VECTOR, NUMBERS, numba.boolean, real[::1])
        for A, real in (
            (SINGLE, numba.float32),
            (SINGLE, numba.float64),
            (DOUBLE, numba.float64),
        )
    ),
    finite=False,
)
def columns(A: Complexes, x: Complexes, slope: Floats, across: bool, out: Reals) -> int:
    """Write the columns of A, turned along x_n (or across it), times sqrt(slope_n); return how many.

    out: room for (2R, N); written as (2R, count), real parts above imaginary parts. Columns of slope
    0 are left out, or where they are few, written as 0.
    """
    R, N = A.shape
    chosen, u, v = np.empty(N, np.int64), np.empty(N, out.dtype), np.empty(N, out.dtype)
    for everything in (False, True):
        count = 0
        for n in range(N):
            if slope[n] > 0.0 or everything:
                r, s = np.sqrt(x[n].real ** 2 + x[n].imag ** 2), np.sqrt(slope[n])
                a, b = (s * x[n].real / r, s * x[n].imag / r) if r > 0.0 else (s, 0.0)
                chosen[count], u[count], v[count] = n, -b if across else a, a if across else b
                count += 1
        if count <= DENSE * N:
            break
    for m in range(R):
        row = A[m]
        re, im = out[m * count : (m + 1) * count], out[(R + m) * count : (R + m + 1) * count]
        if count == N:
            for n in range(N):
                a, b = row[n].real, row[n].imag
                re[n], im[n] = a * u[n] - b * v[n], a * v[n] + b * u[n]
        else:
            for n in range(count):
                a, b = row[chosen[n]].real, row[chosen[n]].imag
                re[n], im[n] = a * u[n] - b * v[n], a * v[n] + b * u[n]
    return count


@compiled(numba.void(DOUBLE, numba.float64, numba.float64[::1, :]))
def real(G: Complexes, scale: float, S: Floats) -> None:
    """Write scale G, (R, R), as a real matrix, (2R, 2R)."""
    R = G.shape[0]
    for i in range(R):
        for j in range(R):
            a, b = scale * G[i, j].real, scale * G[i, j].imag
            S[i, j] = S[R + i, R + j] = a
            S[i, R + j], S[R + i, j] = -b, b


def mean_square(gram: Complexes) -> float:
    """||A||^2 / R, from A A^H."""
    return float(np.trace(gram).real) / max(1, len(gram))
