"""Repairs of a mesh: merged vertices and outward orientation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats, Longs


def merge_vertices(vertices: Floats, faces: Longs) -> tuple[Floats, Longs]:
    """Return vertices and faces without duplicates.

    Merges vertices within 10 nm, and faces of the same vertices, whichever side they face. Drops faces that have a
    vertex twice, and vertices without a face.
    """
    from trimesh import Trimesh

    mesh = Trimesh(vertices, faces, process=False)
    mesh.merge_vertices()
    distinct = (mesh.faces != np.roll(mesh.faces, 1, axis=1)).all(axis=1)
    mesh.update_faces(distinct & mesh.unique_faces())
    mesh.remove_unreferenced_vertices()
    return np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64)


def orient_outward(vertices: Floats, faces: Longs) -> Longs:
    """Return the faces of a closed mesh with inside-out bodies flipped.

    An inside-out body within another body is a cavity, and is not flipped.
    """
    import igl

    if volume(vertices, faces).sum() < 0.0:
        faces = faces[:, ::-1]
    _, body = igl.facet_components(faces)
    for k in np.flatnonzero(np.bincount(body, volume(vertices, faces)) < 0.0):
        own = np.equal(body, k)
        at = vertices[faces[own][:1, 0]]
        turns: Floats = np.asarray(igl.winding_number(vertices, faces[~own], at))
        if not turns[0] > 0.5:
            faces = np.where(own[:, None], faces[:, ::-1], faces)
    return np.ascontiguousarray(faces)


def volume(vertices: Floats, faces: Longs) -> Floats:
    """Return the signed volume between each face and the origin, (F,) [m^3]; the sum is that of a closed mesh."""
    a, b, c = (vertices[corner] for corner in faces.T)
    return np.asarray((a * np.cross(b, c)).sum(axis=1) / 6.0, dtype=np.float64)
