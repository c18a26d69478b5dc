"""The broad phase: which of many objects may be touched at all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices


def cull(bounds: Floats, t: float, boxes: Floats) -> Indices:
    """Indices of the objects whose bounding spheres touch any of the boxes at time t [s], in order.

    bounds: as `Scene.bounds`, (objects, 8). boxes: lower and upper corners, (boxes, 6) [m].
    """
    found = np.empty(len(bounds), dtype=np.int64)
    return found[: kernels.near(bounds, t, boxes, found)]
