"""Repairs of a mesh: merged vertices and outward orientation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs

MERGE_DISTANCE = 1e-8  # vertices in one cube of this side are merged [m]


def merge_vertices(vertices: Floats, faces: Longs) -> tuple[Floats, Longs]:
    """Return vertices and faces without duplicates.

    Merges vertices within 10 nm, and faces of the same vertices, whichever side they face. Drops faces that have a
    vertex twice, and vertices without a face.
    """
    vertices, faces = _drop_unused(vertices, faces)
    _, first, same = np.unique(
        np.round(vertices / MERGE_DISTANCE), axis=0, return_index=True, return_inverse=True
    )
    order = np.argsort(first, kind="stable")  # vertices stay in order
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    vertices, faces = vertices[first[order]], place[same.reshape(-1)][faces]
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    unique = np.zeros(len(faces), dtype=np.bool_)
    unique[np.unique(np.sort(faces, axis=1), axis=0, return_index=True)[1]] = True
    return _drop_unused(vertices, faces[distinct & unique])


def _drop_unused(vertices: Floats, faces: Longs) -> tuple[Floats, Longs]:
    """Return vertices and faces without the vertices that no face has."""
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[faces] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]


def orient_outward(vertices: Floats, faces: Longs) -> Longs:
    """Return the faces of a closed mesh with inside-out bodies flipped.

    An inside-out body within another body is a cavity, and is not flipped.
    """
    if volume(vertices, faces).sum() < 0.0:
        faces = faces[:, ::-1]
    body = _find_bodies(faces)
    for k in np.flatnonzero(np.bincount(body, volume(vertices, faces)) < 0.0):
        own = np.equal(body, k)
        at = vertices[faces[own][:1, 0]]
        if not wind(vertices[faces[~own]], at)[0] > 0.5:
            faces = np.where(own[:, None], faces[:, ::-1], faces)
    return np.ascontiguousarray(faces)


def volume(vertices: Floats, faces: Longs) -> Floats:
    """Return the signed volume between each face and the origin, (F,) [m^3]; the sum is that of a closed mesh."""
    a, b, c = (vertices[corner] for corner in faces.T)
    return np.asarray((a * np.cross(b, c)).sum(axis=1) / 6.0, dtype=np.float64)
