"""Triangle meshes of arrays, hands, objects and samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.plot.volumes import isosurface
from pacinian.scene.hands import capsules as flesh
from pacinian.scene.objects import Body
from pacinian.scene.shapes import Disc, Rectangle
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.shape_types import distance

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.objects import Object
    from pacinian.types import Floats, Indices, Longs

SIDES = 12  # corners of a transducer's disc
DOT, WIDE = 0.003, 0.0045  # radius of a sample, and of a transducer [m]
# Cells along the longest edge of a solid's box; least along any.
LONGEST_EDGE_CELLS, MIN_CELLS = 48, 12
DISC_CORNERS = 48  # corners of a disc
MAX_HEIGHTS = 200  # maximum number of heights along an edge
SKIN = 0.003  # distance between the grid points around a hand [m]
ALONG = 0.004  # distance between the balls of a line [m]


class Triangles(NamedTuple):
    """vertices (V, 3) [m]; faces (F, 3); index of the input that each vertex belongs to, (V,)."""

    vertices: Floats
    faces: Longs
    thing: Indices


def discs(array: Array) -> Triangles:
    """Make a disc for each transducer, in its direction."""
    n = array.normals
    aside = np.where(np.abs(n[:, 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    u = np.cross(aside, n)
    u /= np.sqrt((u * u).sum(axis=1, keepdims=True))
    rim = spun(SIDES).T
    rims = rim[0, :, None] * u[:, None] + rim[1, :, None] * np.cross(n, u)[:, None]
    flat = np.concatenate([np.zeros((len(n), 1, 3)), WIDE * rims], axis=1)
    return _copies(flat + array.positions[:, None], _fan(SIDES))


def spots(points: Floats) -> Triangles:
    """Make a ball for each of the points, (K, 3) [m]."""
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=2, radius=DOT)
    return _copies(points[:, None] + np.asarray(ball.vertices), np.asarray(ball.faces))


def hand(held: Hand) -> Triangles:
    """Make the skin of a hand, which must not be lost."""
    if held.vertices is not None and held.faces is not None:
        return make_triangles(held.vertices, held.faces)
    assert held.joints is not None  # because it has no mesh
    capsules = flesh.make_capsules(held)
    far = capsules[:, 6:].max() + 2.0 * SKIN
    low, high = held.joints.min(axis=0) - far, held.joints.max(axis=0) + far
    return _solid(lambda q: flesh.distance_to_skin(capsules, q), low, high, SKIN)


def make_object(item: Object) -> Triangles:
    """Make the surface of an object in its own frame; points and lines become small balls."""
    if not isinstance(item, Body):
        return spots(item.sample_surface(ALONG).points)
    shape = item.shape
    if isinstance(shape, Mesh):
        return make_triangles(shape.triangles.vertices, shape.triangles.faces)
    if isinstance(shape, Rectangle):
        ends = np.array([-0.5, 0.5])
        return _sheet(ends * shape.width, ends * shape.height, np.zeros((2, 2)))
    if isinstance(shape, HeightMap):
        i, j = (
            np.linspace(0, n - 1, min(n, MAX_HEIGHTS)).round().astype(int) for n in shape.z.shape
        )
        R, C = shape.z.shape
        x, y = (j / (C - 1) - 0.5) * shape.width, (i / (R - 1) - 0.5) * shape.height
        return _sheet(x, y, shape.z[np.ix_(i, j)])
    if isinstance(shape, Disc):
        rim = spun(DISC_CORNERS) * shape.radius
        return make_triangles(np.pad(rim, ((1, 0), (0, 1))), _fan(DISC_CORNERS))
    half = np.array(shape.extent)
    cells = np.clip(np.ceil(LONGEST_EDGE_CELLS * half / half.max()), MIN_CELLS, LONGEST_EDGE_CELLS)
    step = 2.0 * half / cells
    return _solid(
        lambda q: distance(shape, q, np.inf, np.inf), -half - 1.5 * step, half + 1.5 * step, step
    )


def spun(count: int) -> Floats:
    """Return points of a circle of radius 1, (count, 2)."""
    turn = 2.0 * np.pi * np.arange(count) / count
    return np.stack([np.cos(turn), np.sin(turn)], axis=-1)


def _fan(count: int) -> Longs:
    """Return the triangles from a middle to a rim of `count` points that follow it, (count, 3)."""
    return np.array([(0, 1 + k, 1 + (k + 1) % count) for k in range(count)])


def _solid(
    away: Callable[[Floats], Floats], low: Floats, high: Floats, step: float | Floats
) -> Triangles:
    """Make the surface of a shape from its signed distance."""
    steps = np.broadcast_to(step, 3)
    counts = np.ceil((high - low) / steps).astype(int) + 1
    x, y, z = (low[k] + steps[k] * np.arange(counts[k]) for k in range(3))
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    d = away(np.stack([X, Y, Z], axis=-1).reshape(-1, 3)).reshape(Z.shape)
    return make_triangles(*isosurface(-d, low, step, 0.0))


def _sheet(x: Floats, y: Floats, z: Floats) -> Triangles:
    """Make an open surface over the xy-plane: heights (R, C) at x, (C,), and y, (R,) [m]."""
    R, C = z.shape
    X, Y = np.meshgrid(x, y)
    first = (C * np.arange(R - 1)[:, None] + np.arange(C - 1)).ravel()
    a, b, c, d = first, first + 1, first + C + 1, first + C
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    return make_triangles(np.stack([X, Y, z], axis=-1).reshape(-1, 3), faces)


def make_triangles(vertices: Floats, faces: Longs) -> Triangles:
    """Make the triangles of a single thing."""
    return Triangles(vertices, faces, np.zeros(len(vertices), dtype=np.intp))


def _copies(vertices: Floats, faces: Longs) -> Triangles:
    """Join K copies, (K, V, 3), that share the same faces, (F, 3)."""
    K, V = vertices.shape[:2]
    every = (faces + V * np.arange(K)[:, None, None]).reshape(-1, 3)
    return Triangles(vertices.reshape(-1, 3), every, np.repeat(np.arange(K), V))
