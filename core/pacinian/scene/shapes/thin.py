"""Points spread evenly, out of many."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

APART = 0.8  # share of the spacing that neighbours keep: then there is one sample per spacing^2


def thin(points: Floats, radius: float) -> Indices:
    """Indices of points, (K, 3) [m], of which no two are nearer than `radius` [m], and none is missing."""
    from scipy.spatial import KDTree

    tree, left = KDTree(points), np.ones(len(points), dtype=np.bool_)
    kept: list[int] = []
    for i in np.random.default_rng(0).permutation(len(points)).tolist():
        if left[i]:
            kept.append(i)
            left[tree.query_ball_point(points[i], radius)] = False
    return np.array(sorted(kept), dtype=np.intp)
