"""The triangles of a mesh, read from a file and repaired."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from pacinian.argument_checks import check_length
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.mesh_repair import merge_vertices, orient_outward, volume

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Vector
    from pacinian.types import Floats, Longs

# No compressed formats, because a small file could expand to any size.
FORMATS = "obj", "stl", "ply", "off", "glb", "gltf"
MAX_FILE_BYTES = 256 << 20  # largest file [bytes]
MAX_TRIANGLES = 1_000_000  # largest number of triangles
MIN_RELATIVE_HEIGHT = 1e-7  # smallest height of a triangle over the bounding radius; less is single-precision rounding


@dataclass(frozen=True, eq=False)
class Triangles:
    """F repaired triangles.

    vertices: (V, 3) [m]. faces: (F, 3). normals: unit, (F, 3), zero for triangles that are too thin to have one. areas:
    (F,) [m^2]. edges: index of the edge opposite each corner, (F, 3). sharing: number of faces at each edge. flaw: why
    the triangles do not enclose a volume, "" if they do.
    """

    vertices: Floats
    faces: Longs
    normals: Floats
    areas: Floats
    edges: Longs
    sharing: Longs
    flaw: str

    @cached_property
    def area(self) -> float:
        """Total area [m^2]."""
        return float(self.areas.sum())

    @cached_property
    def bounding_radius(self) -> float:
        """Distance of the farthest point from the origin [m]."""
        return _reach(self.vertices)

    @cached_property
    def extent(self) -> Vector:
        """Half the size of the bounding box centred on the origin [m]."""
        x, y, z = np.abs(self.vertices).max(axis=0).tolist()
        return x, y, z

    def rim(self, spacing: float) -> tuple[Floats, Longs]:
        """Return points at most `spacing` [m] apart on the rim, (K, 3) [m], and the triangle of each, (K,).

        The rim consists of the edges that belong to one triangle only. Ends of edges come first, so that thinning keeps
        the corners.
        """
        face, corner = np.nonzero(self.sharing[self.edges] == 1)
        a = self.vertices[self.faces[face, (corner + 1) % 3]]
        b = self.vertices[self.faces[face, (corner + 2) % 3]]
        counts = np.ceil(np.sqrt(((b - a) ** 2).sum(axis=1)) / spacing).clip(1.0).astype(np.int64)
        which = np.repeat(np.arange(len(face)), counts)
        nth = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
        points = a[which] + (nth / counts[which])[:, None] * (b - a)[which]
        order = np.argsort(nth > 0, kind="stable")
        return points[order], face[which[order]]

    @classmethod
    def of(cls, vertices: Floats, faces: Longs, name: str) -> Self:
        """Make triangles from vertices, (V, 3) [m], and faces, (F, 3). Raises ArgumentError, which mentions `name`."""
        if not len(faces):
            raise ArgumentError("mesh", f"{name} has no triangles")
        if len(faces) > MAX_TRIANGLES:
            raise ArgumentError(
                "mesh", f"{name} has {len(faces):,} triangles: keep to {MAX_TRIANGLES:,}"
            )
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise ArgumentError("mesh", f"{name} has faces with vertices that are not there")
        if not np.isfinite(vertices).all():
            raise ArgumentError("mesh", f"{name} has vertices that are not finite")
        check_length("mesh", 1e-30 + float(np.abs(vertices).max()))
        vertices, faces = merge_vertices(vertices, faces)
        normals, areas = _normals(vertices, faces)
        if not areas.any():
            raise ArgumentError("mesh", f"{name} has no area")
        edges, sharing, flaw = _edges(vertices, faces, float(areas.sum()))
        if not flaw:
            turned = orient_outward(vertices, faces, edges)
            swap = (turned != faces).any(axis=1, keepdims=True)
            if swap.any():  # made again, so that triangles of these triangles are equal bit for bit
                faces, edges = turned, np.where(swap, edges[:, ::-1], edges)
                normals, areas = _normals(vertices, faces)
        return cls(vertices, faces, normals, areas, edges, sharing, flaw)

    @classmethod
    def read(cls, file: str, scale: float) -> Self:
        """Read the triangles of a file in one of `FORMATS`. Raises ArgumentError, which names the file.

        scale: [m] per unit of the file.
        """
        import trimesh

        path = Path(file)
        kind = path.suffix[1:].lower()
        try:
            if not path.is_file():
                raise ArgumentError(
                    "mesh", f"{file} cannot be read: it is not there, or not a file"
                )
            if kind not in FORMATS:
                raise ArgumentError("mesh", f"{file} must end in one of .{', .'.join(FORMATS)}")
            if (size := path.stat().st_size) > MAX_FILE_BYTES:
                raise ArgumentError(
                    "mesh", f"{file} is {size >> 20} MiB: keep to {MAX_FILE_BYTES >> 20}"
                )
            loaded: Any = trimesh.load_mesh(path, process=False)
            if not isinstance(loaded, trimesh.Trimesh) or not len(loaded.faces):
                raise ArgumentError("mesh", f"{file} has no triangles, or is damaged")
            vertices = np.asarray(loaded.vertices, dtype=np.float64) * scale
            return cls.of(vertices, np.asarray(loaded.faces, dtype=np.int64), file)
        except ArgumentError:
            raise
        except ImportError as error:  # a decoder is not installed, such as Draco's
            raise ArgumentError(
                "mesh",
                f"{file} cannot be read without the library {error.name}: save it as plain .stl",
            ) from error
        except Exception as error:
            problem = f"{file} is damaged, or is no {kind.upper()} file ({error})"
            raise ArgumentError("mesh", f"{problem}: export it again") from error


def _normals(vertices: Floats, faces: Longs) -> tuple[Floats, Floats]:
    """Return the unit normals and areas [m^2] of faces; both are zero for faces that are too thin."""
    a, b, c = (vertices[corner] for corner in faces.T)
    cross = np.cross(b - a, c - a)
    twice = np.sqrt((cross**2).sum(axis=1))
    longest = np.sqrt((np.stack([c - b, a - c, b - a]) ** 2).sum(axis=2).max(axis=0, initial=0.0))
    wide = twice > MIN_RELATIVE_HEIGHT * _reach(vertices) * longest
    normals = np.where(wide[:, None], cross, 0.0) / np.where(wide, twice, 1.0)[:, None]
    return normals, np.where(wide, twice / 2.0, 0.0)


def _edges(vertices: Floats, faces: Longs, area: float) -> tuple[Longs, Longs, str]:
    """Return edges, sharing and flaw, as in `Triangles`."""
    first, last = faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]
    name = np.minimum(first, last) * len(vertices) + np.maximum(first, last)
    _, edges, sharing = np.unique(name, return_inverse=True, return_counts=True)
    turns = np.bincount(edges.ravel(), np.where(first < last, 1.0, -1.0).ravel())
    content = abs(float(volume(vertices, faces).sum()))  # [m^3]
    flaw = ""
    if gaps := int((sharing % 2).sum()):
        flaw = f"it does not close at {gaps} edges"
    elif turns.any():
        flaw = "its triangles are not all wound the same way round"
    elif content <= MIN_RELATIVE_HEIGHT * _reach(vertices) * area:
        flaw = "it encloses nothing"
    return edges.reshape(faces.shape), sharing, flaw


def _reach(vertices: Floats) -> float:
    """Return the largest distance of a vertex from the origin [m]."""
    return math.sqrt(float((vertices**2).sum(axis=1).max(initial=0.0)))
