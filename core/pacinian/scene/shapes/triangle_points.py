"""Random points on triangles, and their barycentric coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs


def pick_points(corners: Floats, weights: Floats, count: int) -> tuple[Floats, Longs]:
    """Return reproducible random points on triangles, (count, 3), and the triangle of each, (count,).

    corners: (F, 3, 3). weights: (F,), in proportion to which the triangles are picked. Within a triangle, the points
    are uniform: those of a parallelogram, the far half of which is folded back.
    """
    random = np.random.default_rng(0).random
    up_to = np.cumsum(weights)
    face = np.searchsorted(up_to, random(count) * up_to[-1]).astype(np.int64)
    sides = corners[face, 1:] - corners[face, :1]
    share = random((count, 2, 1))
    share[share.sum(axis=1).reshape(-1) > 1.0] -= 1.0
    return (sides * np.abs(share)).sum(axis=1) + corners[face, 0], face


def find_barycentric(corners: Floats, points: Floats) -> Floats:
    """Return the barycentric coordinates, (K, 3), of points, (K, 3), in triangles, (K, 3, 3), by Cramer's rule."""
    sides = corners[:, 1:] - corners[:, :1]
    first, second, to = sides[:, 0], sides[:, 1], points - corners[:, 0]
    a, b, c = _dot(first, first), _dot(first, second), _dot(second, second)
    d, e = _dot(first, to), _dot(second, to)
    inverse = 1.0 / (a * c - b * b)
    found = np.empty((len(points), 3))
    found[:, 2] = (a * e - b * d) * inverse
    found[:, 1] = (c * d - b * e) * inverse
    found[:, 0] = 1.0 - found[:, 1] - found[:, 2]
    return found


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(axis=1))
