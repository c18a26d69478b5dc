"""Repairs of a mesh: merged vertices and outward orientation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import label_bodies
from pacinian.scene.shapes.winding import winding_number

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs

MERGES_PER_METRE = 1e8  # vertices in one cube of 10 nm are merged


def merge_vertices(vertices: Floats, faces: Longs) -> tuple[Floats, Longs]:
    """Return vertices and faces without duplicates.

    Merges vertices within 10 nm, and faces of the same vertices, whichever side they face. Drops faces that have a
    vertex twice, and vertices without a face.
    """
    vertices, faces = _drop_unused(vertices, faces)
    first, same = _find_equal(np.round(vertices * MERGES_PER_METRE).astype(np.int64))
    order = np.argsort(first)  # vertices stay in order
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    vertices, faces = vertices[first[order]], place[same][faces]
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    unique = np.zeros(len(faces), dtype=np.bool_)
    unique[_find_equal(np.sort(faces, axis=1))[0]] = True
    return _drop_unused(vertices, faces[distinct & unique])


def _find_equal(rows: Longs) -> tuple[Longs, Longs]:
    """Return the first row of each group of equal rows, and the group of each row."""
    order = np.lexsort(rows.T)
    new = np.ones(len(rows), dtype=np.bool_)
    new[1:] = (np.diff(rows[order], axis=0) != 0).any(axis=1)
    group = np.empty(len(rows), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    return order[new], group


def _drop_unused(vertices: Floats, faces: Longs) -> tuple[Floats, Longs]:
    """Return vertices and faces without the vertices that no face has."""
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[faces] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]


def orient_outward(vertices: Floats, faces: Longs, edges: Longs) -> Longs:
    """Return the faces of a closed mesh with inside-out bodies flipped. edges: of each face, (F, 3).

    An inside-out body within another body is a cavity, and is not flipped.
    """
    if volume(vertices, faces).sum() < 0.0:
        faces = faces[:, ::-1]
    body = np.empty(len(faces), dtype=np.int64)
    label_bodies(np.ascontiguousarray(edges), np.empty(edges.max() + 1, dtype=np.int64), body)
    for k in np.flatnonzero(np.bincount(body, volume(vertices, faces)) < 0.0):
        own = np.equal(body, k)
        at = vertices[faces[own][:1, 0]]
        if not winding_number(vertices[faces[~own]], at)[0] > 0.5:
            faces = np.where(own[:, None], faces[:, ::-1], faces)
    return np.ascontiguousarray(faces)


def volume(vertices: Floats, faces: Longs) -> Floats:
    """Return the signed volume between each face and the origin, (F,) [m^3]; the sum is that of a closed mesh."""
    a, b, c = (vertices[corner] for corner in faces.T)
    return np.asarray((a * np.cross(b, c)).sum(axis=1) / 6.0, dtype=np.float64)
