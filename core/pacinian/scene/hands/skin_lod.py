"""Levels of detail of a skin: evenly spread points, of which coarse levels use a part, and how nodes share forces.

Two points are on the same side of the skin if their normals are less than 90 degrees apart and they are not on two
different fingers. Points keep their distance from, and share forces with, only points on the same side.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

# Finest spacing, a fifth of a wavelength [m]. Pressure falls from full to 0 within 3 mm of a rim.
FINEST = 1.75e-3
SPACINGS = FINEST * np.sqrt(2.0) ** np.arange(9)
"""Spacings of the levels, fine to coarse, (9,) [m]."""
GRAIN = 0.9e-3  # spacing of the candidates for the points of a skin [m]
SHARERS = 3  # number of nodes that share a point's force


class SkinNodes(NamedTuple):
    """N points of a skin at rest. points: (N, 3) [m]. normals: (N, 3). fingers: 0 for the palm, (N,)."""

    points: Floats
    normals: Floats
    fingers: Indices

    def only(self, kept: Indices) -> SkinNodes:
        """Return the points `kept`, in that order."""
        return SkinNodes(self.points[kept], self.normals[kept], self.fingers[kept])


class Share(NamedTuple):
    """The nodes of a level that share the force of each of K points: indices, (K, 3), and weights, (K, 3).

    The weights of a point sum to 1.
    """

    indices: Indices
    weights: Floats


def spread_pressure(surface: SkinNodes, spacing: float = FINEST) -> tuple[Indices, Floats, Indices]:
    """Choose points one after the other, each the farthest from those already chosen.

    Stops when no point is `spacing` [m] away from all chosen points on its side. Returns the indices of the chosen
    points, (K,); the distance of each from those before it, (K,) [m], which never increases; and the nearest chosen
    point to each of the N points, (N,).
    """
    N = len(surface.points)
    order, apart = np.empty(N, dtype=np.intp), np.empty(N)
    nearest = np.zeros(N, dtype=np.intp)
    K = kernels.spread(*surface, spacing, order, apart, nearest)
    return order[:K].copy(), apart[:K].copy(), nearest


def gather_pressure(to: Indices, area: Floats, count: int = 0) -> Floats:
    """Sum the areas, (N,), that go to each of at least `count` points."""
    return np.asarray(np.bincount(to, area, count), dtype=np.float64)


def share_pressure(surface: SkinNodes, nodes: int) -> Share:
    """Share every point among the nearest of the first `nodes` points.

    The weights are (1/D - 1/D_4)^2, normalised. D is the distance over the square root of the cosine between the
    normals, and D_4 is D of the fourth nearest node, so that the weight of a node is 0 when it enters or leaves the
    nearest three [1]. A point that is a node belongs to itself alone.

    [1] Franke and Nielson, Smooth interpolation of large sets of scattered data, 1980 (modified Shepard).
    """
    K = len(surface.points)
    out = Share(np.zeros((K, SHARERS), dtype=np.intp), np.zeros((K, SHARERS)))
    kernels.share(*surface, nodes, *out)
    return out
