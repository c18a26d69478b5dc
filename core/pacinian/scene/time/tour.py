"""The order in which a focus visits points: through them all, or around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

TIE = 1.0 - 1e-6  # of squared distances: what is as near up to rounding comes in order


@compiled("i8[::1](f8[:, ::1])")
def through(q: Floats) -> Indices:
    """Indices of points q, (M, 3) [m]: from the first on, always the nearest that is left."""
    M = len(q)
    order = np.zeros(M, dtype=np.int64)
    left = np.ones(M, dtype=np.bool_)
    i = 0
    for m in range(1, M):
        left[i] = False
        best, least = -1, 0.0
        for j in range(M):
            if left[j]:
                x, y, z = q[j, 0] - q[i, 0], q[j, 1] - q[i, 1], q[j, 2] - q[i, 2]
                d = x * x + y * y + z * z
                if best < 0 or d < TIE * least:
                    best, least = j, d
        i = best
        order[m] = i
    return order


@compiled("i8[::1](f8[:, ::1], i8[::1])")
def around(q: Floats, order: Indices) -> Indices:
    """Indices of the corners of points q, (M, 2) [m], anticlockwise; of points on a line, its ends.

    order: of the points by x, then y, (M,). Andrew's monotone chain: the lower side, then the upper.
    """
    M = len(q)
    corners = np.zeros(2 * M + 1, dtype=np.int64)
    count, least = 0, 2
    for m in range(2 * M - 1):
        if m == M:
            least = count + 1
        i = order[m] if m < M else order[2 * M - 2 - m]
        while count >= least:
            a, b = corners[count - 2], corners[count - 1]
            x, y = q[b, 0] - q[a, 0], q[b, 1] - q[a, 1]
            if x * (q[i, 1] - q[a, 1]) - y * (q[i, 0] - q[a, 0]) > 0.0:  # a turn to the left
                break
            count -= 1
        corners[count] = i
        count += 1
    return corners[: max(count - 1, 1)]
