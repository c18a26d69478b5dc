"""The kernel of `resolution`: under which directions an array is seen from points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

TINY = 1e-30
ROWS = numba.types.Array(numba.float64, 2, "C", readonly=True)


@compiled(
    numba.void(
        ROWS, ROWS, ROWS, numba.complex64[:, ::1], numba.boolean,
        numba.float64[:, ::1], numba.float64[:, :, ::1],
    )
)  # fmt: skip
def spread(
    q: Floats, n: Floats, r: Floats, B: Complexes, even: bool, mean: Floats, covariance: Floats
) -> None:
    """Write the mean, (M, 3), and the covariance, (M, 3, 3), of the unit vectors from points to transducers.

    q: points, (M, 3) [m]. n: normals there, zero where sound counts from every side, (M, 3). r: transducers, (N, 3)
    [m]. B: (M, N). even: whether the weights are |B| times the cosine of the incidence; else that squared.
    """
    for m in range(len(q)):
        x, y, z, nx, ny, nz = q[m, 0], q[m, 1], q[m, 2], n[m, 0], n[m, 1], n[m, 2]
        free = 1.0 if nx == 0.0 and ny == 0.0 and nz == 0.0 else 0.0
        s = sx = sy = sz = xx = yy = zz = xy = yz = zx = 0.0
        for i in range(len(r)):
            dx, dy, dz = r[i, 0] - x, r[i, 1] - y, r[i, 2] - z
            inverse = 1.0 / np.sqrt(dx * dx + dy * dy + dz * dz + TINY)
            dx, dy, dz = dx * inverse, dy * inverse, dz * inverse
            cosine = max(dx * nx + dy * ny + dz * nz, 0.0) + free
            b = B[m, i]
            w = (float(b.real) ** 2 + float(b.imag) ** 2) * cosine * cosine
            w = np.sqrt(w) if even else w
            s += w
            sx, sy, sz = sx + w * dx, sy + w * dy, sz + w * dz
            xx, yy, zz = xx + w * dx * dx, yy + w * dy * dy, zz + w * dz * dz
            xy, yz, zx = xy + w * dx * dy, yz + w * dy * dz, zx + w * dz * dx
        s = 1.0 / max(s, TINY)
        a, b_, c = sx * s, sy * s, sz * s
        mean[m, 0], mean[m, 1], mean[m, 2] = a, b_, c
        covariance[m, 0, 0] = xx * s - a * a
        covariance[m, 1, 1] = yy * s - b_ * b_
        covariance[m, 2, 2] = zz * s - c * c
        covariance[m, 0, 1] = covariance[m, 1, 0] = xy * s - a * b_
        covariance[m, 1, 2] = covariance[m, 2, 1] = yz * s - b_ * c
        covariance[m, 2, 0] = covariance[m, 0, 2] = zx * s - c * a
