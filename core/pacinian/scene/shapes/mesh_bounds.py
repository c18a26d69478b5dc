"""Rough distances to a mesh, so that what is far away needs no exact one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import rough

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.shapes.triangles import Triangles
    from pacinian.types import Floats, Indices, Longs

CELL = 0.0015  # [m], the least size of a cell
CELLS = 1 << 18  # at most
COARSE = 8  # cells along a side of the largest
EIGHT = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)


class Bounds:
    """Bounds of the signed distance to triangles, from cubic cells: not farther, and 0 near the surface.

    Beside, before and behind an open surface they are positive.
    """

    def __init__(self, t: Triangles, distance: Callable[[Floats], Floats]) -> None:
        low, high = t.vertices.min(axis=0), t.vertices.max(axis=0)
        self.size = CELL
        while (number := _cells(high - low, self.size)).prod() > CELLS:
            self.size *= 1.25
        self.low = (low + high - self.size * number) / 2.0
        self.high = self.low + self.size * number
        self.closed = not t.flaw
        self.gap: Floats = self._gap(number, distance)
        if self.closed:
            self._sign(t)

    def __call__(self, points: Floats, beyond: float, deep: float, d: Floats) -> Longs:
        """Write the bound of points, (K, 3), to d, (K,) [m].

        Returns the indices of those that may be neither farther outside than `beyond` [m] nor deeper
        inside than `deep` [m].
        """
        near = np.empty(len(points), dtype=np.int64)
        most = beyond if self.closed else max(beyond, deep)
        number = rough(points, self.low, self.high, self.size, self.gap, -deep, most, d, near)
        return near[:number]

    def _gap(self, number: Indices, distance: Callable[[Floats], Floats]) -> Floats:
        """Least distance of each cell from the surface [m]: by exact ones near it, by cells elsewhere."""
        from scipy import ndimage

        size, half = self.size, math.sqrt(3.0) / 2.0 * self.size
        cells = np.argwhere(np.ones(number // COARSE)) * COARSE
        side = COARSE
        while True:  # an octree of the cells that the surface may cross
            d = distance(self.low + (cells + side / 2.0) * size)
            if side == 1:
                break
            side //= 2
            cells = (cells[d <= 2 * side * half, None] + side * EIGHT).reshape(-1, 3)
        crossed = np.zeros(number, dtype=np.bool_)
        crossed[tuple(cells[d <= half].T)] = True
        # from cell to cell, not from centre to centre: to the nearest of those that touch one crossed
        touching = ndimage.binary_dilation(crossed, np.ones((3, 3, 3), dtype=np.bool_))
        gap = size * ndimage.distance_transform_edt(~touching)
        at = tuple(cells.T)
        gap[at] = np.maximum(gap[at], d - half)
        return np.asarray(gap)

    def _sign(self, t: Triangles) -> None:
        """Make bounds inside negative: what hangs together away from the surface has one sign."""
        from scipy import ndimage

        part = np.asarray(ndimage.label(self.gap > 0.0)[0])
        first = np.unique(part, return_index=True)[1]
        cells = np.stack(np.unravel_index(first, part.shape), axis=1)
        turns = winding_number(t, self.low + (cells + 0.5) * self.size)
        sign = np.where(turns > 0.5, -1.0, 1.0)
        sign[0] = 1.0  # near the surface
        self.gap *= sign[part]


def winding_number(t: Triangles, points: Floats) -> Floats:
    """How often the triangles wind around each of a few points, (K, 3) [m], (K,): 1 inside, 0 outside.

    The sum of their solid angles by A. van Oosterom and J. Strackee, "The solid angle of a plane triangle", IEEE
    Trans. Biomed. Eng. 30 (1983) 125. libigl's builds a tree, in which the interpreter lock is held too long.
    """
    corners = t.vertices[t.faces]  # (F, 3, 3) [m]
    turns = np.zeros(len(points))
    for k, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        x, y, z = (np.sqrt((v * v).sum(axis=1)) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=1)
        below = x * y * z + (a * b).sum(1) * z + (b * c).sum(1) * x + (c * a).sum(1) * y
        turns[k] = np.arctan2(volume, below).sum() / (2.0 * math.pi)
    return turns


def _cells(extent: Floats, size: float) -> Indices:
    """How many cells of `size` [m] hold a box of `extent` [m]: a multiple of COARSE along each side."""
    return COARSE * np.maximum(np.ceil(extent / (COARSE * size)), 1.0).astype(np.intp)
