"""The order in which a focus visits points: through them all, or around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices


def order_through(q: Floats) -> Indices:
    """Indices of points q, (M, 3) [m]: from the first on, always the nearest that is left."""
    order = np.empty(len(q), dtype=np.int64)
    kernels.visit_through(q, order)
    return order


def order_around(q: Floats, order: Indices) -> Indices:
    """Indices of the corners of points q, (M, 2) [m], anticlockwise; of points on a line, its ends.

    order: of the points by x, then y, (M,). Andrew's monotone chain: the lower side, then the upper.
    """
    corners = np.empty(2 * len(q) + 1, dtype=np.int64)
    return corners[: kernels.visit_around(q, order, corners)]
