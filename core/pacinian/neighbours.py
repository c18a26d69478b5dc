"""Nearest points, found by a compiled k-d tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import neighbours as kernels

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs


def find_nearest(points: Floats, queries: Floats) -> tuple[Floats, Longs]:
    """Return the distance to the nearest of `points`, (K, 3) [m], from each of `queries`, (Q, 3), and which it is.

    Both results have the shape (Q,). Of several nearest points, the first counts. K > 0; all points are finite.
    """
    distance, which = np.empty(len(queries)), np.empty(len(queries), dtype=np.int64)
    kernels.find_nearest(
        np.ascontiguousarray(points, dtype=np.float64),
        np.ascontiguousarray(queries, dtype=np.float64),
        distance,
        which,
    )
    return distance, which
