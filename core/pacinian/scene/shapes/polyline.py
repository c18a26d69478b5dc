"""Straight pieces from point to point: the place at a distance along them, and the distance to them."""

from __future__ import annotations

import functools
import weakref
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats

MIN_LENGTH = 1e-300  # [m]


class Polyline3D:
    """Straight pieces between points, (L, 3) [m], two or more; further columns are carried along.

    arc: the length up to each point, (L,) [m].
    """

    def __init__(self, points: Floats) -> None:
        d = points[1:, :3] - points[:-1, :3]
        self.points, self.arc = points, np.zeros(len(points))
        np.sqrt((d * d).sum(axis=1)).cumsum(out=self.arc[1:])

    @property
    def length(self) -> float:
        """[m]."""
        return float(self.arc[-1])

    def at(self, s: Floats) -> Floats:
        """What is `s` [m] along, (K,): (K, 3), or as many columns as the points have."""
        i = np.searchsorted(self.arc[1:-1], s, side="right")
        step = np.maximum(self.arc[i + 1] - self.arc[i], MIN_LENGTH)
        a, f = self.points[i], (s - self.arc[i]) / step
        return np.asarray(a + f[:, None] * (self.points[i + 1] - a))

    def distance(self, points: Floats) -> Floats:
        """Distance of points, (K, 3), (K,) [m]."""
        tree, pairs = self._tree
        squared = tree.squared_distance(self.points, pairs, np.ascontiguousarray(points))[0]
        return np.asarray(np.sqrt(squared))

    @functools.cached_property
    def _tree(self) -> tuple[Any, Any]:
        """A tree of boxes around the pieces, and the two ends of each."""
        import igl

        i = np.arange(len(self.points) - 1)
        tree, pairs = igl.AABB(), np.stack([i, i + 1], axis=-1)
        tree.init(self.points, pairs)
        # at exit too: nanobind complains of what is still there then
        weakref.finalize(self, self.__dict__.pop, "_tree", None)
        return tree, pairs
