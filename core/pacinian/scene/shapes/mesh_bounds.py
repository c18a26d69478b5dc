"""Rough distances to a mesh, which suffice for points far away."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import label_cells, measure_cells, rough
from pacinian.scene.shapes.winding import winding_number

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.shapes.triangles import Triangles
    from pacinian.types import Flags, Floats, Indices, Longs

MIN_CELL_SIZE = 0.0015  # smallest size of a cell [m]
MAX_CELLS = 1 << 18  # largest number of cells
COARSE = 8  # side of the coarsest octree cells, in cells
EIGHT = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)


class Bounds:
    """Bounds of the signed distance to triangles, one for each cubic cell.

    The bound is never farther than the distance, and it is 0 near the surface. For an open surface it is positive on
    all sides.
    """

    def __init__(self, t: Triangles, distance: Callable[[Floats], Floats]) -> None:
        low, high = t.vertices.min(axis=0), t.vertices.max(axis=0)
        self.size = MIN_CELL_SIZE
        while (number := _cells(high - low, self.size)).prod() > MAX_CELLS:
            self.size *= 1.25
        self.low = (low + high - self.size * number) / 2.0
        self.high = self.low + self.size * number
        self.closed = not t.flaw
        self.gap: Floats = self._gap(number, distance)
        if self.closed:
            self._sign(t)

    def __call__(self, points: Floats, beyond: float, deep: float, d: Floats) -> Longs:
        """Write the bounds of points, (K, 3), to d, (K,) [m].

        Returns the indices of the points that may lie within `beyond` [m] outside and `deep` [m] inside, and therefore
        need an exact distance.
        """
        near = np.empty(len(points), dtype=np.int64)
        most = beyond if self.closed else max(beyond, deep)
        number = rough(points, self.low, self.high, self.size, self.gap, -deep, most, d, near)
        return near[:number]

    def _gap(self, number: Indices, distance: Callable[[Floats], Floats]) -> Floats:
        """Return a lower bound of each cell's distance from the surface [m].

        Near the surface it follows from exact distances, and elsewhere from a distance transform of the cells.
        """
        size, half = self.size, math.sqrt(3.0) / 2.0 * self.size
        cells = np.argwhere(np.ones(number // COARSE)) * COARSE
        side = COARSE
        while True:  # refine an octree of the cells that the surface may cross
            d = distance(self.low + (cells + side / 2.0) * size)
            if side == 1:
                break
            side //= 2
            cells = (cells[d <= 2 * side * half, None] + side * EIGHT).reshape(-1, 3)
        crossed = np.zeros(number, dtype=np.bool_)
        crossed[tuple(cells[d <= half].T)] = True
        # Measure to the nearest cell that touches a crossed one, because distances between cells, not centres, count.
        squared = np.empty(number)
        measure_cells(_spread(crossed), squared)
        gap = size * np.sqrt(squared)
        at = tuple(cells.T)
        gap[at] = np.maximum(gap[at], d - half)
        return np.asarray(gap)

    def _sign(self, t: Triangles) -> None:
        """Make the bounds inside negative. Each connected component of cells away from the surface has one sign."""
        part = np.empty(self.gap.shape, dtype=np.int64)
        label_cells(self.gap > 0.0, part)
        first = np.unique(part, return_index=True)[1]
        cells = np.stack(np.unravel_index(first, part.shape), axis=1)
        turns = winding_number(t.vertices[t.faces], self.low + (cells + 0.5) * self.size)
        sign = np.where(turns > 0.5, -1.0, 1.0)
        sign[0] = 1.0  # the cells near the surface
        self.gap *= sign[part]


def _spread(marked: Flags) -> Flags:
    """Mark also the cells that touch a marked one, be it at a corner."""
    for axis in range(3):
        inner = np.moveaxis(marked, axis, 0)
        wider = inner.copy()
        wider[1:] |= inner[:-1]
        wider[:-1] |= inner[1:]
        marked = np.moveaxis(wider, 0, axis)
    return np.ascontiguousarray(marked)


def _cells(extent: Floats, size: float) -> Indices:
    """Return the number of cells of `size` [m] along each side of a box of `extent` [m]: multiples of COARSE."""
    return COARSE * np.maximum(np.ceil(extent / (COARSE * size)), 1.0).astype(np.intp)
