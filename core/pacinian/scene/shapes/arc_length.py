"""Polylines: the position at an arc length, and the distance to them."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.shapes.triangle_tree import TriangleTree

if TYPE_CHECKING:
    from pacinian.types import Floats

MIN_LENGTH = 1e-300  # [m]


class Polyline3D:
    """Straight segments between two or more points, (L, 3) [m]. Further columns are interpolated too.

    arc: arc length up to each point, (L,) [m].
    """

    def __init__(self, points: Floats) -> None:
        d = points[1:, :3] - points[:-1, :3]
        self.points, self.arc = points, np.zeros(len(points))
        np.sqrt((d * d).sum(axis=1)).cumsum(out=self.arc[1:])

    @property
    def length(self) -> float:
        """Total length [m]."""
        return float(self.arc[-1])

    def at(self, s: Floats) -> Floats:
        """Return the positions at arc lengths `s`, (K,) [m]: (K, 3), or as many columns as the points have."""
        i = np.searchsorted(self.arc[1:-1], s, side="right")
        step = np.maximum(self.arc[i + 1] - self.arc[i], MIN_LENGTH)
        a, f = self.points[i], (s - self.arc[i]) / step
        return np.asarray(a + f[:, None] * (self.points[i + 1] - a))

    def distance(self, points: Floats) -> Floats:
        """Return the distance of points, (K, 3), from the polyline: (K,) [m]."""
        return np.sqrt(self._tree.find_closest(points)[0])

    @functools.cached_property
    def _tree(self) -> TriangleTree:
        """The tree of boxes around the segments, which are triangles without area."""
        i = np.arange(len(self.points) - 1)
        return TriangleTree(self.points[:, :3], np.stack([i, i + 1, i + 1], axis=-1))
