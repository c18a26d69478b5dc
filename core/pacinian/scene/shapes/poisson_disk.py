"""Poisson-disk sampling: thin out many points to evenly spread ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.neighbours import thin

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

MIN_DISTANCE = 0.8  # smallest distance of neighbours, over the spacing; this gives about one sample per spacing^2


def thin_out(points: Floats, radius: float, first: int = 0) -> Indices:
    """Return the indices of a maximal subset of points, (K, 3) [m], no two of which are nearer than `radius` [m].

    The first `first` points are tried first, in order. The others are tried in a reproducible random order.
    """
    others = first + np.random.default_rng(0).permutation(len(points) - first)
    order = np.concatenate([np.arange(first), others]).astype(np.int64)
    kept = np.empty(len(points), dtype=np.bool_)
    thin(np.ascontiguousarray(points, dtype=np.float64), order, radius, kept)
    return np.flatnonzero(kept)
