"""Products with B and B^H, tile by tile: B is read once, in single precision, without BLAS and its threads.

Arguments shared by all: B [Pa], (M, N). Complex vectors are planes, real and imaginary parts, (2, ...).
tile: room for one tile of B, (2, M rounded up to 4, TILE). Sums over a tile are single, over tiles double.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Gains, Singles

TILE = 256  # columns at a time: 16 rows of them stay in the first-level cache, 256 in the second


@compiled("void(c8[:, ::1], i8, i8, f4[:, :, ::1])")
def load(B: Gains, first: int, count: int, tile: Singles) -> None:
    """Write the columns first..first + count of B to `tile`, real and imaginary parts apart."""
    for m in range(B.shape[0]):
        row, re, im = B[m, first : first + count], tile[0, m], tile[1, m]
        for n in range(count):
            re[n] = row[n].real
            im[n] = row[n].imag


@compiled("void(f4[:, :, ::1], i8, f4[:, ::1], f4[::1], f4[::1])")
def backward(tile: Singles, count: int, y: Singles, xr: Singles, xi: Singles) -> None:
    """Write x = B^H y of one tile; rows of `tile` and of y beyond M are 0."""
    for n in range(count):
        xr[n] = f4(0.0)
        xi[n] = f4(0.0)
    for m in range(0, tile.shape[1], 4):
        a0, b0, a1, b1 = tile[0, m], tile[1, m], tile[0, m + 1], tile[1, m + 1]
        a2, b2, a3, b3 = tile[0, m + 2], tile[1, m + 2], tile[0, m + 3], tile[1, m + 3]
        r0, i0, r1, i1 = y[0, m], y[1, m], y[0, m + 1], y[1, m + 1]
        r2, i2, r3, i3 = y[0, m + 2], y[1, m + 2], y[0, m + 3], y[1, m + 3]
        for n in range(count):
            xr[n] += (
                (a0[n] * r0 + b0[n] * i0) + (a1[n] * r1 + b1[n] * i1)
                + (a2[n] * r2 + b2[n] * i2) + (a3[n] * r3 + b3[n] * i3)
            )  # fmt: skip
            xi[n] += (
                (a0[n] * i0 - b0[n] * r0) + (a1[n] * i1 - b1[n] * r1)
                + (a2[n] * i2 - b2[n] * r2) + (a3[n] * i3 - b3[n] * r3)
            )  # fmt: skip


@compiled("void(f4[:, :, ::1], i8, f4[::1], f4[::1], f8[:, ::1])")
def forward(tile: Singles, count: int, hr: Singles, hi: Singles, p: Floats) -> None:
    """Add B h of one tile to p."""
    for m in range(p.shape[1]):
        a, b = tile[0, m], tile[1, m]
        re, im = f4(0.0), f4(0.0)
        for n in range(count):
            re += a[n] * hr[n] - b[n] * hi[n]
            im += a[n] * hi[n] + b[n] * hr[n]
        p[0, m] += re
        p[1, m] += im


@compiled("void(c8[:, ::1], f4[:, ::1], f4[:, ::1], f4[:, :, ::1])")
def spread(B: Gains, y: Singles, x: Singles, tile: Singles) -> None:
    """Write x = B^H y, (2, N)."""
    N = B.shape[1]
    for first in range(0, N, TILE):
        count = min(TILE, N - first)
        load(B, first, count, tile)
        backward(tile, count, y, x[0, first : first + count], x[1, first : first + count])


@compiled("void(c8[:, ::1], f4[:, ::1], f8[:, ::1], f4[:, :, ::1])")
def gather(B: Gains, g: Singles, p: Floats, tile: Singles) -> None:
    """Write p = B g, (2, M), for gains (2, N)."""
    N = B.shape[1]
    p[:] = 0.0
    for first in range(0, N, TILE):
        count = min(TILE, N - first)
        load(B, first, count, tile)
        forward(tile, count, g[0, first : first + count], g[1, first : first + count], p)


@compiled("void(c8[:, ::1], c8[::1], c16[::1])")
def apply(B: Gains, g: Gains, p: Complexes) -> None:
    """Write p = B g, (M,), for gains (N,)."""
    N = B.shape[1]
    gr, gi = np.empty(TILE, f4), np.empty(TILE, f4)
    p[:] = 0.0
    for first in range(0, N, TILE):
        count = min(TILE, N - first)
        for n in range(count):
            gr[n], gi[n] = g[first + n].real, g[first + n].imag
        for m in range(B.shape[0]):
            row = B[m, first : first + count]
            re, im = f4(0.0), f4(0.0)
            for n in range(count):
                re += row[n].real * gr[n] - row[n].imag * gi[n]
                im += row[n].real * gi[n] + row[n].imag * gr[n]
            p[m] += complex(re, im)


@compiled("void(c8[:, ::1], c16[::1], c8[::1])")
def adjoint(B: Gains, y: Complexes, x: Gains) -> None:
    """Write x = B^H y, (N,), for y of shape (M,)."""
    N = B.shape[1]
    re, im = np.empty(TILE, f4), np.empty(TILE, f4)
    for first in range(0, N, TILE):
        count = min(TILE, N - first)
        re[:] = f4(0.0)
        im[:] = f4(0.0)
        for m in range(B.shape[0]):
            row = B[m, first : first + count]
            yr, yi = f4(y[m].real), f4(y[m].imag)
            for n in range(count):
                re[n] += row[n].real * yr + row[n].imag * yi
                im[n] += row[n].real * yi - row[n].imag * yr
        for n in range(count):
            x[first + n] = complex(re[n], im[n])
