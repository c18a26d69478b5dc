"""Points spread evenly, out of many."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

APART = 0.8  # share of the spacing that neighbours keep: then there is one sample per spacing^2


def thin_out(points: Floats, radius: float, first: int = 0) -> Indices:
    """Indices of points, (K, 3) [m], of which no two are nearer than `radius` [m], and none is missing.

    Of the first so many as are kept beside each other, then of the others at random (always the same).
    """
    from scipy.spatial import KDTree

    tree, left = KDTree(points), np.ones(len(points), dtype=np.bool_)
    kept: list[int] = []
    others = first + np.random.default_rng(0).permutation(len(points) - first)
    for i in np.concatenate([np.arange(first), others]).tolist():
        if left[i]:
            kept.append(i)
            left[tree.query_ball_point(points[i], radius)] = False
    return np.array(sorted(kept), dtype=np.intp)
