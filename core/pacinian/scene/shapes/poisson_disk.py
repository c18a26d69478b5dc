"""Poisson-disk sampling: thin out many points to evenly spread ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

MIN_DISTANCE = 0.8  # smallest distance of neighbours, over the spacing; this gives about one sample per spacing^2


def thin_out(points: Floats, radius: float, first: int = 0) -> Indices:
    """Return the indices of a maximal subset of points, (K, 3) [m], no two of which are nearer than `radius` [m].

    The first `first` points are tried first, in order. The others are tried in a reproducible random order.
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
