"""Signed distances to the triangles of a mesh."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import scene as kernels
from pacinian.scene.shapes.mesh_bounds import Bounds
from pacinian.scene.shapes.triangle_tree import TriangleTree
from pacinian.scene.shapes.triangles import Triangles

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices, Longs


class MeshDistance:
    """Signed distances to triangles: the distance to the nearest point, with the sign from the pseudo-normal there.

    Baerentzen and Aanaes, "Signed distance computation using the angle weighted pseudonormal", 2005. The rim of an open
    surface has no normal. A point whose nearest surface point is on the rim lies beside the surface, where the distance
    is positive.

    normals, features: from `pseudo_normals`. inward, offset: in the plane of each face, the distance of a point x from
    each edge is inward . x + offset [m].
    """

    def __init__(self, t: Triangles) -> None:
        wide = t.areas > 0.0
        self.triangles, self.vertices, self.faces = t, t.vertices, t.faces[wide]
        self.tree = TriangleTree(self.vertices, self.faces)
        self.normals, features = pseudo_normals(t)
        self.features = features[wide]
        first, last = (self.vertices[np.roll(self.faces, -k, axis=1)] for k in (1, 2))
        along = (last - first) / np.sqrt(((last - first) ** 2).sum(axis=2, keepdims=True))
        self.inward: Floats = np.cross(t.normals[wide][:, None], along).astype(np.float64)
        self.offset = -(self.inward * first).sum(axis=2)

    @cached_property
    def bounds(self) -> Bounds:
        """Rough distances, for points far away."""
        return Bounds(self.triangles, self.compute_unsigned)

    def __call__(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; infinite for points that are not finite.

        beyond, deep: farther outside or inside than these [m], the result may be too near, but it stays beyond these
        limits. Deep behind an open surface, the result may have the sign of the front.
        """
        d = np.empty(len(points))
        points = np.ascontiguousarray(points, dtype=np.float64)
        if min(beyond, deep) < math.inf:
            near = self.bounds(points, beyond, deep, d)
            points = points[near]
        else:
            near = np.arange(len(points))
        squared, face, nearest = self.tree.find_closest(points)
        kernels.sign(
            points, squared, face, nearest,
            self.inward, self.offset, self.normals, self.features, near, d,
        )  # fmt: skip
        return d

    def compute_unsigned(self, points: Floats) -> Floats:
        """Return the unsigned distance of points, (K, 3): (K,) [m]."""
        squared = self.tree.find_closest(points)[0]
        return np.sqrt(squared)


class MeasurableTriangles(Triangles):
    """Triangles with the signed distance to them."""

    @cached_property
    def distance(self) -> MeshDistance:
        """Signed distance to the triangles, prepared at first use."""
        return MeshDistance(self)


def pseudo_normals(t: Triangles) -> tuple[Floats, Longs]:
    """Return the pseudo-normals, not of unit length, of faces, edges and vertices in one array, and an index into it.

    The index, (F, 8), gives for each face the normal of a point on it. Its second axis is a bit mask of the edges on
    which the point lies: bit i is the edge opposite corner i.
    """
    F, E, V = len(t.faces), len(t.sharing), len(t.vertices)
    corner, edge, three = t.faces.ravel(), t.edges.ravel(), np.repeat(np.arange(F), 3)
    first, last = (t.vertices[np.roll(t.faces, -k, axis=1)] for k in (1, 2))
    lengths = np.sqrt(((last - first) ** 2).sum(axis=2)).reshape(-1, 1)
    # A face without area counts as an edge, which joins its neighbours on either side.
    normals, thin = t.normals.copy(), t.areas == 0.0
    x, y, z = t.edges[thin].T
    line = _join(np.concatenate([x, y]), np.concatenate([y, z]), E)
    of_edges = _sums(line[edge], lengths * normals[three], E)[line]
    normals[thin] = of_edges[x]
    normals[thin] /= np.maximum(np.sqrt((normals[thin] ** 2).sum(axis=1, keepdims=True)), 1e-30)
    angles = _angles(t.vertices[t.faces]).reshape(-1, 1)
    of_vertices = _sums(corner, angles * normals[three], V)
    rim = np.isin(line, line[t.sharing == 1])
    of_edges[rim] = 0.0
    for k in (1, 2):  # the ends of each rim edge
        of_vertices[np.roll(t.faces, -k, axis=1)[rim[t.edges]]] = 0.0
    face = np.arange(F)
    (e0, e1, e2), (v0, v1, v2) = F + t.edges.T, F + E + t.faces.T
    features = np.stack([face, e0, e1, v2, e2, v1, v0, face], axis=1)
    return np.concatenate([normals, of_edges, of_vertices]), features


def _join(first: Indices, second: Indices, size: int) -> Indices:
    """Return the smallest index, (size,), that each index is joined with by pairs `first`, `second`, (K,)."""
    joined = np.arange(size)
    while (joined[first] != joined[second]).any():
        least = np.minimum(joined[first], joined[second])
        for ends in (first, second):
            np.minimum.at(joined, ends, least)
        joined = joined[joined]
    return joined


def _angles(corners: Floats) -> Floats:
    """Return the angle at each corner of triangles, (F, 3, 3): (F, 3) [rad]; 0 at an edge without length."""
    a, b = (np.roll(corners, -k, axis=1) - corners for k in (1, 2))
    across = np.sqrt((np.cross(a, b) ** 2).sum(axis=2))
    return np.asarray(np.arctan2(across, (a * b).sum(axis=2)), dtype=np.float64)


def _sums(index: Indices, values: Floats, size: int) -> Floats:
    """Sum the rows of `values`, (K, 3), that have the same index: (size, 3)."""
    columns = [np.bincount(index, column, size) for column in values.T]
    return np.stack(columns, axis=1).astype(np.float64, copy=False)
