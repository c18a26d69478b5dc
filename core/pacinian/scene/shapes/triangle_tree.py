"""A tree of boxes around triangles, which finds the nearest one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs


class TriangleTree:
    """The tree of boxes of triangles: vertices, (V, 3) [m], faces, (F, 3), F > 0. A triangle may have no area."""

    def __init__(self, vertices: Floats, faces: Longs) -> None:
        self.vertices = np.ascontiguousarray(vertices, dtype=np.float64)
        self.faces = np.ascontiguousarray(faces, dtype=np.int64)
        F = len(faces)
        self._order, right = np.empty(F, dtype=np.int64), np.empty(F, dtype=np.int64)
        boxes = np.empty((F, 6))
        nodes = kernels.build_boxes(self.vertices, self.faces, self._order, boxes, right)
        self._boxes, self._right = boxes[:nodes].copy(), right[:nodes].copy()

    def find_closest(self, points: Floats) -> tuple[Floats, Longs, Floats]:
        """Return the squared distance of points, (K, 3), the nearest triangle, and its nearest point.

        The shapes are (K,) [m^2], (K,) and (K, 3) [m]. The distance is infinite from points that are not finite.
        """
        K = len(points)
        squared, face, nearest = np.empty(K), np.empty(K, dtype=np.int64), np.empty((K, 3))
        kernels.find_closest(
            self.vertices, self.faces, self._order, self._boxes, self._right,
            np.ascontiguousarray(points, dtype=np.float64), squared, face, nearest,
        )  # fmt: skip
        return squared, face, nearest
