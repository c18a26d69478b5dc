"""Kernels in the small space: the Gram matrix B B^H, Gerchberg-Saxton steps on it, limits, evidence."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numba
import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats, Singles

TILE = 512  # columns at a time: the real and imaginary parts of 64 rows fill a second-level cache


@compiled("void(c8[:, ::1], i8, i8, f4[:, :, ::1], c16[:, ::1])")
def gram(B: Complexes, start: int, stop: int, scratch: Singles, out: Complexes) -> None:
    """Write B B^H, (M, M), exactly Hermitian, of the columns start..stop.

    Sums over a tile are single, over tiles double. scratch: (2, M + M % 2, TILE). Rows are taken two by
    two, so that each number loaded is used twice: 2 times as fast as BLAS for M = 16 to 24, and no
    slower to M = 128.
    """
    M = B.shape[0]
    even, tile = scratch.shape[1], scratch.shape[2]
    out[:] = 0.0
    scratch[:] = f4(0.0)
    re, im = scratch[0], scratch[1]
    for first in range(start, stop, tile):
        count = min(tile, stop - first)
        for m in range(M):
            row = B[m, first : first + count]
            for n in range(count):
                re[m, n] = row[n].real
                im[m, n] = row[n].imag
        for i in range(0, even, 2):
            a0, b0, a1, b1 = re[i, :count], im[i, :count], re[i + 1, :count], im[i + 1, :count]
            for j in range(0, i + 2, 2):
                c0, d0, c1, d1 = re[j, :count], im[j, :count], re[j + 1, :count], im[j + 1, :count]
                r00, i00, r01, i01 = f4(0.0), f4(0.0), f4(0.0), f4(0.0)
                r10, i10, r11, i11 = f4(0.0), f4(0.0), f4(0.0), f4(0.0)
                for n in range(count):
                    r00 += a0[n] * c0[n] + b0[n] * d0[n]
                    i00 += b0[n] * c0[n] - a0[n] * d0[n]
                    r01 += a0[n] * c1[n] + b0[n] * d1[n]
                    i01 += b0[n] * c1[n] - a0[n] * d1[n]
                    r10 += a1[n] * c0[n] + b1[n] * d0[n]
                    i10 += b1[n] * c0[n] - a1[n] * d0[n]
                    r11 += a1[n] * c1[n] + b1[n] * d1[n]
                    i11 += b1[n] * c1[n] - a1[n] * d1[n]
                out[i, j] += complex(r00, i00)
                if i + 1 < M:
                    out[i + 1, j] += complex(r10, i10)
                if j + 1 < M:
                    out[i, j + 1] += complex(r01, i01)
                if i + 1 < M and j + 1 < M:
                    out[i + 1, j + 1] += complex(r11, i11)
    for i in range(M):
        out[i, i] = complex(out[i, i].real, 0.0)
        for j in range(i):
            out[j, i] = np.conj(out[i, j])


SEALED = numba.types.Array(numba.complex128, 2, "C", readonly=True)
GIVEN = numba.types.Array(numba.float64, 1, "C", readonly=True)
GIVEN_POINTS = numba.types.Array(numba.float64, 2, "C", readonly=True)


@compiled(numba.void(SEALED, numba.boolean[::1], numba.int64, numba.complex128[::1]))
def gerchberg_saxton(G: Complexes, free: Flags, steps: int, p: Complexes) -> None:
    """Repeat p <- |p| exp(j arg(G p)) in place where `free`, (M,); a point that nothing reaches stays."""
    M = len(p)
    q = np.empty(M, np.complex128)
    size = np.abs(p)
    for _ in range(steps):
        for i in range(M):
            total = complex(0.0, 0.0)
            for j in range(M):
                total += G[i, j] * p[j]
            q[i] = total
        for i in range(M):
            length = abs(q[i])
            if free[i] and length > 0.0:
                p[i] = q[i] * (size[i] / length)


@compiled(
    numba.float64(
        SEALED, GIVEN, GIVEN, GIVEN, numba.int64, numba.complex128[::1], numba.boolean[::1]
    ),
    finite=False,
)
def choose(
    G: Complexes, t: Floats, phi: Floats, start: Floats, steps: int, p: Complexes, free: Flags
) -> float:
    """Write targets p, (M,), with the phases phi, where NaN by Gerchberg-Saxton steps from `start`.

    free: where a phase may be any, and counts. Returns ||t||.
    """
    size, any_free = 0.0, False
    for m in range(len(t)):
        free[m] = phi[m] != phi[m] and t[m] > 0.0
        any_free = any_free or free[m]
        angle = start[m] if phi[m] != phi[m] else phi[m]
        p[m] = t[m] * complex(np.cos(angle), np.sin(angle))
        size += t[m] * t[m]
    if any_free:
        gerchberg_saxton(G, free, steps, p)
    return math.sqrt(size)


@compiled(numba.float64(GIVEN_POINTS, GIVEN, GIVEN), finite=False)
def furthest(q: Floats, origin: Floats, t: Floats) -> float:
    """The largest |q_m - origin|^2, (M, 3); NaN where a number is not finite, or t_m neither 0 nor 1e-30..1e30."""
    most, health = 0.0, 0.0
    for m in range(q.shape[0]):
        x, y, z = q[m, 0] - origin[0], q[m, 1] - origin[1], q[m, 2] - origin[2]
        square = x * x + y * y + z * z
        health += 0.0 * square + 0.0 * t[m]
        most = max(most, square)
        health += 0.0 if t[m] == 0.0 or 1e-30 <= t[m] <= 1e30 else np.nan
    return most + health


@compiled(numba.float64(numba.complex128[::1], GIVEN, GIVEN), finite=False)
def miss(p: Complexes, t: Floats, phi: Floats) -> float:
    """||asked - p|| / ||t||; phases phi, (M,) [rad], are as p has them where NaN."""
    missed, size = 0.0, 0.0
    for m in range(len(p)):
        size += t[m] * t[m]
        if phi[m] == phi[m]:
            a = t[m] * complex(np.cos(phi[m]), np.sin(phi[m])) - p[m]
            missed += a.real * a.real + a.imag * a.imag
        else:
            missed += (t[m] - np.sqrt(p[m].real ** 2 + p[m].imag ** 2)) ** 2
    return math.sqrt(missed / size) if size > 0.0 else 0.0


@compiled("f8(c8[::1])", "f8(c16[::1])", finite=False)
def peak(g: Complexes) -> float:
    """The largest |g_n|^2, or NaN where any is not finite."""
    largest, health = 0.0, 0.0
    for n in range(g.size):
        re, im = np.float64(g[n].real), np.float64(g[n].imag)
        square = re * re + im * im
        health += square * 0.0  # 0, or NaN
        largest = square if square > largest else largest
    return largest + health


@compiled("f8(c8[::1])", "f8(c16[::1])")
def power(g: Complexes) -> float:
    """||g||^2, summed in double precision: squares of small gains vanish in single."""
    total = 0.0
    for n in range(g.size):
        re, im = np.float64(g[n].real), np.float64(g[n].imag)
        total += re * re + im * im
    return total


@compiled("void(c8[:, ::1], f8[::1])", "void(c16[:, ::1], f8[::1])")
def powers(B: Complexes, out: Floats) -> None:
    """Write sum_n |B_mn|^2 of each row, (M,); summed in single precision for 64 columns at most."""
    M, N = B.shape
    for m in range(M):
        row, total = B[m], 0.0
        for first in range(0, N, 64):
            part = row[0].real * 0
            for n in range(first, min(first + 64, N)):
                part += row[n].real * row[n].real + row[n].imag * row[n].imag
            total += part
        out[m] = total


@compiled("void(c8[::1], f8, f8)", "void(c16[::1], f8, f8)")
def restrain(g: Complexes, factor: float, highest: float) -> None:
    """Multiply gains (N,) by `factor` in place; then shorten those above `highest` to it."""
    for n in range(g.size):
        re, im = factor * np.float64(g[n].real), factor * np.float64(g[n].imag)
        size = np.sqrt(re * re + im * im)
        shorter = highest / size if size > highest else 1.0
        g[n] = complex(re * shorter, im * shorter)
