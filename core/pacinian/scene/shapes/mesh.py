"""Triangle meshes: open surfaces, or closed shells of volumes."""

from __future__ import annotations

import logging
import math
import os
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Vector
from pacinian.argument_checks import check_count, check_length, check_numbers
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.mesh_distance import MeasurableTriangles
from pacinian.scene.shapes.poisson_disk import MIN_DISTANCE, thin_out
from pacinian.scene.shapes.sdf import scale_shell, share_area
from pacinian.scene.shapes.triangle_points import pick_points

if TYPE_CHECKING:
    from pacinian.types import Floats

TRIES = 12  # random candidates per sample
RIM = 8  # candidates per spacing on the rim of an open mesh

Stamp = tuple[int, int]  # modification time of a file [ns], and its size [bytes]
# cache of triangles by file, scale and stamp; an entry lives as long as a mesh uses it
_read: WeakValueDictionary[tuple[str, float, Stamp | None], MeasurableTriangles] = (
    WeakValueDictionary()
)


class Mesh(
    Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="mesh", dict=True
):
    """A triangle mesh from a file (OBJ, STL, PLY, OFF, glTF), or from vertices and faces.

    A closed mesh is a solid; if it is wound inside out, its triangles are flipped. An open mesh faces the side from
    which its triangles appear counter-clockwise. Several meshes in a file count as one.

    file: path; a scene file gives it relative to its own folder. scale: [m] per unit of the mesh. vertices: [unit],
    (V, 3). faces: indices of vertices, (F, 3). Raises ArgumentError.
    """

    file: str = ""
    scale: float = 1.0
    vertices: tuple[Vector, ...] = ()
    faces: tuple[tuple[int, int, int], ...] = ()

    def __post_init__(self) -> None:
        force_setattr(self, "scale", check_length("scale", self.scale))
        vertices = check_numbers("vertices", self.vertices, (None, 3))
        faces = check_numbers("faces", self.faces, (None, 3))
        if self.file:
            if len(vertices) or len(faces):
                raise ArgumentError("mesh", "needs either a file or vertices and faces, not both")
            return
        if not len(faces):
            raise ArgumentError("mesh", "needs either a file or vertices and faces")
        if (faces % 1.0).any():
            raise ArgumentError("faces", "must be whole numbers")
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise ArgumentError("faces", f"must be indices of the {len(vertices)} vertices")
        force_setattr(self, "vertices", tuple(map(tuple, vertices.tolist())))
        force_setattr(self, "faces", tuple(map(tuple, faces.astype(np.int64).tolist())))

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        return self.triangles.area

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self.triangles.bounding_radius

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box centred on the origin [m]."""
        return self.triangles.extent

    @property
    def closed(self) -> bool:
        """Whether the mesh encloses a volume: its triangles close, and are wound the same way."""
        return not self.triangles.flaw

    def check_closed(self) -> None:
        """Check that the mesh encloses a volume. Raises ArgumentError."""
        if flaw := self.triangles.flaw:
            name = self.file or "given here"
            raise ArgumentError(
                "mesh", f"{name} is no volume: {flaw}; close it, or use it as a surface"
            )

    def distance(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]: negative inside, or behind an open surface.

        Beside an open surface, the distance is positive. The first call is slow (0.2 s for 20,000 triangles).

        beyond, deep: farther outside or inside than these [m], the result may be too near, but it stays beyond these
        limits. Deep behind an open surface, the result may have the sign of the front.
        """
        return self.triangles.distance(points, beyond, deep)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return reproducible random samples, thinned to about `spacing` [m]. The rim of an open mesh comes first."""
        t = self.triangles
        tries = TRIES * max(1, round(check_count(TRIES * t.area, spacing, 2) / TRIES))
        points, face = pick_points(t.vertices[t.faces], t.areas, tries)
        rim, of = t.rim(spacing / RIM)
        every, face = np.concatenate([rim, points]), np.concatenate([of, face])
        kept = thin_out(every, MIN_DISTANCE * spacing, len(rim))
        whole = np.repeat([0.0, t.area / tries], [len(rim), tries])
        area = scale_shell(share_area(every, whole, kept), t.area)
        return LocalSamples(every[kept], t.normals[face[kept]], area)

    @property
    def triangles(self) -> MeasurableTriangles:
        """Triangles of the mesh [m]. A changed file is read again; if that fails, the old triangles stay.

        Raises ArgumentError.
        """
        kept: tuple[Stamp | None, MeasurableTriangles] | None = vars(self).get("kept")
        stamp = _stamp(self.file)
        if kept is None or (stamp is not None and stamp != kept[0]):
            try:
                made = self._make_triangles(stamp)
            except ArgumentError as error:
                if kept is None:
                    raise
                logging.getLogger("pacinian").warning("keeping the previous mesh: %s", error)
                made = kept[1]
            kept = vars(self)["kept"] = stamp, made
        return kept[1]

    def _make_triangles(self, stamp: Stamp | None) -> MeasurableTriangles:
        if not self.file:
            vertices = self.scale * np.array(self.vertices)
            return MeasurableTriangles.of(
                vertices, np.array(self.faces, dtype=np.int64), "given here"
            )
        key = self.file, self.scale, stamp
        if (made := _read.get(key)) is None:
            made = _read[key] = MeasurableTriangles.read(self.file, self.scale)
        return made


def _stamp(file: str) -> Stamp | None:
    """Return the modification time and size of a file; None if it does not exist."""
    try:
        stat = os.stat(file) if file else None
    except (OSError, ValueError):
        return None
    return (stat.st_mtime_ns, stat.st_size) if stat else None
