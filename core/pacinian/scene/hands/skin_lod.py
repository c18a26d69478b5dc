"""Points spread evenly over a skin, coarse ones among the fine, and what fine ones share with coarse.

Two points are on the same side of the skin if their normals are less than 90 degrees apart and they are
not on two different fingers. Only points on the same side keep their distance, and only they share.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

FINEST = 1.75e-3  # [m], a fifth of a wavelength: pressure falls from full to nothing within 3 mm of a rim
SPACINGS = FINEST * np.sqrt(2.0) ** np.arange(9)
"""Of the levels, fine to coarse, (9,) [m]."""
GRAIN = 0.9e-3  # [m] between the points that those of a skin are chosen from
SHARERS = 3  # nodes that a point is shared among


class SkinNodes(NamedTuple):
    """N points of a skin at rest. points: (N, 3) [m]. normals: (N, 3). fingers: 0 if none, (N,)."""

    points: Floats
    normals: Floats
    fingers: Indices

    def only(self, kept: Indices) -> SkinNodes:
        """Those points, in the order wanted."""
        return SkinNodes(self.points[kept], self.normals[kept], self.fingers[kept])


class Share(NamedTuple):
    """What each of K points gives to the nodes of a level: indices (K, 3), weights (K, 3), summing to 1."""

    indices: Indices
    weights: Floats


def spread_pressure(surface: SkinNodes, spacing: float = FINEST) -> tuple[Indices, Floats, Indices]:
    """Choose points one after the other, each the one farthest from those before it.

    Stops when none on the same side is `spacing` [m] away from all. Returns which, (K,); how far each
    then was from those before, (K,) [m], never growing; and of all N points, (N,), the nearest chosen.
    """
    N = len(surface.points)
    order, apart = np.empty(N, dtype=np.intp), np.empty(N)
    nearest = np.zeros(N, dtype=np.intp)
    K = kernels.spread(*surface, spacing, order, apart, nearest)
    return order[:K].copy(), apart[:K].copy(), nearest


def gather_pressure(to: Indices, area: Floats, count: int = 0) -> Floats:
    """The sums of the areas, (N,), given to each of at least `count` points."""
    return np.asarray(np.bincount(to, area, count), dtype=np.float64)


def share_pressure(surface: SkinNodes, nodes: int) -> Share:
    """Share every point among the nearest of the first so many.

    Weights are (1/D - 1/D_4)^2, normalised, with D the distance over the cosine between the normals, and
    D_4 that of the fourth nearest node, so that a node counts for nothing when it comes or goes [1]; a
    node's own point goes to it alone.

    [1] Franke and Nielson, Smooth interpolation of large sets of scattered data, 1980 (modified Shepard).
    """
    K = len(surface.points)
    out = Share(np.zeros((K, SHARERS), dtype=np.intp), np.zeros((K, SHARERS)))
    kernels.share(*surface, nodes, *out)
    return out
