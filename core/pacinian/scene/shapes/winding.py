"""Winding numbers: whether points lie inside triangles."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats

MAX_ANGLES = 1 << 14  # most solid angles computed together, so that their arrays stay small


def winding_number(corners: Floats, points: Floats) -> Floats:
    """Return the winding number of triangles around each of a few points, (K, 3) [m]: (K,), 1 inside, 0 outside.

    corners: of the triangles, (F, 3, 3) [m]. Sums the solid angles by A. van Oosterom and J. Strackee, "The solid angle
    of a plane triangle", IEEE Trans. Biomed. Eng. 30 (1983) 125.
    """
    turns = np.empty(len(points))
    together = max(1, MAX_ANGLES // max(1, len(corners)))
    for begin in range(0, len(points), together):
        part = slice(begin, begin + together)
        a, b, c = np.moveaxis(corners[None] - points[part, None, None], 2, 0)
        x, y, z = (np.sqrt((v * v).sum(axis=2)) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=2)
        below = x * y * z + (a * b).sum(2) * z + (b * c).sum(2) * x + (c * a).sum(2) * y
        turns[part] = np.arctan2(volume, below).sum(axis=1) / (2.0 * math.pi)
    return turns
