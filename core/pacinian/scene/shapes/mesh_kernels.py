"""The kernels of distances to meshes: what is far away, and on which side the rest is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numba
import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs

ON = 1e-9  # [m] from an edge: on it
POINTS = numba.types.Array(numba.float64, 2, "C", readonly=True)
ROW, TABLE, CUBE = numba.float64[::1], numba.float64[:, ::1], numba.float64[:, :, ::1]
REAL, WHICH = numba.float64, numba.int64[::1]


@compiled(
    numba.int64(POINTS, ROW, ROW, REAL, CUBE, REAL, REAL, ROW, WHICH), finite=False
)  # fmt: skip
def rough(
    points: Floats, low: Floats, high: Floats, size: float, gap: Floats,
    least: float, most: float, d: Floats, near: Longs,
) -> int:  # fmt: skip
    """Write bounds of the distance to `d`, and to `near` the indices of those from least to most [m].

    low, high: corners of the box of cells [m]. size: of a cell [m]. gap: bound of each cell [m]; a point
    outside of the box is at a right angle or more from there to all in it. Returns how many are near.
    """
    count = 0
    cell = np.empty(3, dtype=np.int64)
    for i in range(points.shape[0]):
        away = 0.0
        for k in range(3):
            x = points[i, k]
            if not x > low[k]:  # or not a number
                x = low[k]
            x = min(x, high[k])
            cell[k] = min(int((x - low[k]) / size), gap.shape[k] - 1)
            away += (points[i, k] - x) ** 2
        bound = gap[cell[0], cell[1], cell[2]]
        if away > 0.0:  # nothing inside of a mesh is outside of its box
            bound = math.sqrt(away + bound * bound)
        elif away != 0.0:
            bound = math.inf
        d[i] = bound
        if least <= bound <= most:
            near[count] = i
            count += 1
    return count


@compiled(
    numba.void(
        POINTS, ROW, WHICH, TABLE, CUBE, TABLE, TABLE, numba.int64[:, ::1], WHICH, ROW
    ),
    finite=False,
)  # fmt: skip
def signed(
    points: Floats, squared: Floats, face: Longs, nearest: Floats,
    inward: Floats, offset: Floats, normals: Floats, features: Longs, where: Longs, d: Floats,
) -> None:  # fmt: skip
    """Write the signed distance of the k-th point to d[where[k]].

    squared: of the distance [m^2], to the point `nearest` [m] of `face`. The others: see `MeshDistance`.
    """
    for k in range(points.shape[0]):
        d[where[k]] = math.sqrt(squared[k])
        if 0.0 * (points[k, 0] + points[k, 1] + points[k, 2]) != 0.0:  # not finite
            d[where[k]] = math.inf
            continue
        f = face[k]
        on = 0
        for i in range(3):
            s = offset[f, i]
            for j in range(3):
                s += inward[f, i, j] * nearest[k, j]
            if s < ON:
                on += 1 << i
        n = features[f, on]
        side = 0.0
        for j in range(3):
            side += (points[k, j] - nearest[k, j]) * normals[n, j]
        if side < 0.0:
            d[where[k]] = -d[where[k]]
