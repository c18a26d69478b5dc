"""The propagation kernels: equations (3) to (7) fused, in single precision, without temporaries.

A wave is evaluated on tiles of transducers small enough for the first-level cache, in passes that
the compiler vectorises: distance, amplitude, phase. Phase is kept in turns, so that the range
reduction is one rounding; the error of a phase is that of a float32 distance: 6e-8 k r [rad] RMS,
5 times that at most.
`propagation.matrix` in double precision is the reference that tests compare with.

Arguments shared by all: r, n: positions [m] and normals of the transducers relative to their centre,
shape (3, N). law: (k / 2 pi [1/m], power, beta [1/m], P0 [Pa m]). table: the directivity in the middle
of equal steps of cos(theta) from 0 to 1, after one entry for all that lies behind; of length 1 for an
omnidirectional transducer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Gains, Indices, Numbers, Singles

TILE = 256
NEAREST = f4(1e-30)  # [m^2]; keeps 1 / r finite on a transducer
TOUCHING = f4(1e-12)  # [m^2]; a point this near is on the transducer


@compiled("f4(f4, f4, f4, f4[:, ::1], f4[:, ::1], i8, i8, f4[::1], f4[::1], f4[:, ::1], i4[::1])")
def wave(
    x: float, y: float, z: float, r: Singles, n: Singles, first: int, count: int,
    law: Singles, table: Singles, tile: Singles, place: Numbers,
) -> np.float32:  # fmt: skip
    """Sound pressure at (x, y, z) per gain of the transducers first..first + count.

    Writes its real part to tile[0], its imaginary part to tile[1], and the inverse distance [1/m] to
    tile[2]; place is for its own use. Returns how many of the transducers the point lies on.
    """
    turns, power, beta, P0 = law[0], law[1], law[2], law[3]
    last = np.uint32(table.size - 1)
    rx, ry, rz = (
        r[0, first : first + count],
        r[1, first : first + count],
        r[2, first : first + count],
    )
    real, imag, inverse = tile[0], tile[1], tile[2]
    touching = f4(0.0)
    for i in range(count):
        dx, dy, dz = x - rx[i], y - ry[i], z - rz[i]
        square = dx * dx + dy * dy + dz * dz
        touching += f4(1.0) if square < TOUCHING else f4(0.0)
        inverse[i] = f4(1.0) / np.sqrt(square + NEAREST)
        # The distance [m]; as the inverse may be an estimate, with a step of Newton's.
        distance = square * inverse[i]
        real[i] = distance + f4(0.5) * inverse[i] * (square - distance * distance)
    # Amplitude into imag; the two usual laws need no power.
    if power == f4(1.0):
        for i in range(count):
            imag[i] = P0 * inverse[i]
    elif power == f4(0.0):
        for i in range(count):
            imag[i] = P0
    else:
        for i in range(count):
            imag[i] = P0 * inverse[i] ** power
    if beta > f4(0.0):
        for i in range(count):  # exp(t) = exp(t / 64)^64, |t| <= 32
            t = -beta * real[i]
            t = (t if t > f4(-32.0) else f4(-32.0)) * f4(1.0 / 64.0)
            e = f4(1.0) + t * (
                f4(1.0) + t * (f4(0.5) + t * (f4(1 / 6) + t * (f4(1 / 24) + t * f4(1 / 120))))
            )
            e *= e
            e *= e
            e *= e
            e *= e
            e *= e
            imag[i] *= e * e if -beta * real[i] > f4(-32.0) else f4(0.0)
    if table.size > 1:
        nx, ny, nz = (
            n[0, first : first + count],
            n[1, first : first + count],
            n[2, first : first + count],
        )
        steps = f4(table.size - 1)
        for i in range(count):
            cosine = ((x - rx[i]) * nx[i] + (y - ry[i]) * ny[i] + (z - rz[i]) * nz[i]) * inverse[i]
            front = cosine if cosine > f4(0.0) else f4(0.0)
            place[i] = np.int32(np.ceil(front * steps))  # 0 for all that is not in front
        for i in range(count):
            imag[i] *= table[min(np.uint32(place[i]), last)]
    for i in range(count):
        t = real[i] * turns
        t -= np.rint(t)  # -1/2 .. 1/2 turns; half of it below: sin and cos of pi t
        u = t * t
        s = t * (f4(3.14159258) + u * (f4(-5.16770687) + u * (f4(2.55003119)
            + u * (f4(-0.59804419) + u * f4(0.07721839)))))  # fmt: skip
        c = f4(1.0) + u * (f4(-4.93480214) + u * (f4(4.05870916) + u * (f4(-1.335212)
            + u * (f4(0.23493731) + u * f4(-0.02439632)))))  # fmt: skip
        a = imag[i]
        real[i] = a * (c * c - s * s)
        imag[i] = f4(-2.0) * a * (s * c)
    return touching


@compiled("f4(f4[:, ::1], f4[:, ::1], f4[:, ::1], f4[::1], f4[::1], i8[::1], c8[:, ::1], f4[::1])")
def matrix(
    q: Singles, r: Singles, n: Singles, law: Singles, table: Singles,
    rows: Indices, out: Gains, touches: Singles,
) -> np.float32:  # fmt: skip
    """Write rows of B [Pa], (N,) each, for points q [m], (K, 3), to the rows of `out`, (M, N).

    touches: how many transducers each point lies on, (K,). Returns their sum.
    """
    N = r.shape[1]
    all_touching = f4(0.0)
    tile = np.empty((3, TILE), np.float32)
    place = np.empty(TILE, np.int32)
    for m in range(q.shape[0]):
        touching = f4(0.0)
        for first in range(0, N, TILE):
            count = min(TILE, N - first)
            touching += wave(q[m, 0], q[m, 1], q[m, 2], r, n, first, count, law, table, tile, place)
            row = out[rows[m], first : first + count]
            for i in range(count):
                row[i] = complex(tile[0, i], tile[1, i])
        touches[m] = touching
        all_touching += touching
    return all_touching


@compiled(
    "void(f4[:, ::1], f4[:, ::1], f4[:, ::1], f4[::1], f4[::1], f4[:, ::1], c8[::1], f4[::1])"
)
def field(
    q: Singles, r: Singles, n: Singles, law: Singles, table: Singles,
    g: Singles, out: Gains, touches: Singles,
) -> None:  # fmt: skip
    """Write p = B g [Pa], shape (M,), without building B; g: real and imaginary parts, shape (2, N)."""
    N = r.shape[1]
    tile = np.empty((3, TILE), np.float32)
    place = np.empty(TILE, np.int32)
    for m in range(q.shape[0]):
        touching = f4(0.0)
        re, im = np.float64(0.0), np.float64(0.0)
        for first in range(0, N, TILE):
            count = min(TILE, N - first)
            touching += wave(q[m, 0], q[m, 1], q[m, 2], r, n, first, count, law, table, tile, place)
            a, b = g[0, first : first + count], g[1, first : first + count]
            sum_re, sum_im = f4(0.0), f4(0.0)
            for i in range(count):
                sum_re += tile[0, i] * a[i] - tile[1, i] * b[i]
                sum_im += tile[0, i] * b[i] + tile[1, i] * a[i]
            re += sum_re
            im += sum_im
        out[m] = complex(re, im)
        touches[m] = touching
