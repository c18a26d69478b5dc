"""Shapes given by a mesh or by a signed-distance function, and the samples inside of volumes."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Vector, vector
from pacinian.checks import count, length, numbers
from pacinian.errors import ArgumentError
from pacinian.scene.shapes import Local, grid
from pacinian.types import Floats

if TYPE_CHECKING:
    from pacinian.types import Indices


KEPT = 64  # meshes at hand
APART = 0.8  # share of the spacing that neighbours keep: then there is one sample per spacing^2
TRIES = 12  # random candidates for each sample
FEW, STEPS = 6, 5
ON = 0.01  # share of the spacing within which a projected point is on the shell


_meshes: dict[int, tuple[Mesh, tuple[int, int] | None, Any]] = {}


class Solid(Protocol):
    """What a volume needs of its shape."""

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        ...

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside."""
        ...

    def cover(self, spacing: float) -> Local:
        """Samples of its shell, about `spacing` [m] apart."""
        ...


class Mesh(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="mesh"):
    """A triangle mesh, from a file that trimesh reads (OBJ, STL, PLY, glTF), or given here.

    file: its path; in a scene file, from that file's folder. scale: [m] per unit of the mesh.
    vertices: [unit], V x 3. faces: indices of vertices, F x 3. Raises ArgumentError.
    """

    file: str = ""
    scale: float = 1.0
    vertices: tuple[Vector, ...] = ()
    faces: tuple[tuple[int, int, int], ...] = ()

    def __post_init__(self) -> None:
        force_setattr(self, "scale", length("scale", self.scale))
        vertices, faces = np.shape(self.vertices), np.shape(self.faces)
        if self.file:
            if vertices[0] or faces[0]:
                raise ArgumentError("mesh", "needs either a file or vertices and faces, not both")
            return
        points = numbers("vertices", self.vertices, (None, 3))
        corners = numbers("faces", self.faces, (None, 3))
        if (corners % 1.0).any():
            raise ArgumentError("faces", "must be whole numbers")
        corners = corners.astype(np.intp)
        if not len(corners):
            raise ArgumentError("mesh", "needs either a file or vertices and faces")
        if corners.min() < 0 or corners.max() >= len(points):
            raise ArgumentError("faces", f"must be indices of the {len(points)} vertices")
        force_setattr(self, "vertices", tuple(map(tuple, points.tolist())))
        force_setattr(self, "faces", tuple(map(tuple, corners.tolist())))

    @property
    def area(self) -> float:
        """[m^2]."""
        return float(_triangles(self).area)

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return float(np.sqrt((_triangles(self).vertices ** 2).sum(axis=1).max()))

    def cover(self, spacing: float) -> Local:
        """Random samples (always the same), thinned to about `spacing` [m]."""
        from trimesh.sample import sample_surface

        mesh = _triangles(self)
        tries = TRIES * max(1, round(count(TRIES * self.area, spacing, 2) / TRIES))
        points, face = sample_surface(mesh, tries, seed=0)[:2]
        kept = thin(points, APART * spacing)
        normals = np.asarray(mesh.face_normals[face[kept]], dtype=np.float64)
        return Local(np.asarray(points[kept], dtype=np.float64), normals)


class SDF(Struct, frozen=True, eq=False):
    """A volume given by a signed-distance function.

    function: points, (K, 3) [m], to distances, (K,) [m], negative inside. extent: half the size of a
    box about the origin that holds it [m]. Raises ArgumentError.
    """

    function: Callable[[Floats], Floats]
    extent: Vector

    def __post_init__(self) -> None:
        force_setattr(self, "extent", vector("extent", self.extent))
        for half in self.extent:
            length("extent", half)

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside. Raises ArgumentError."""
        d = np.asarray(self.function(points), dtype=np.float64)
        if d.shape != (len(points),) or not np.isfinite(d).all():
            raise ArgumentError(
                "function",
                f"must give one finite distance a point, shape ({len(points)},), not {d.shape}",
            )
        return d

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m], at most."""
        return math.hypot(*self.extent)

    def cover(self, spacing: float) -> Local:
        """Points of a fine grid near the shell, projected on it and thinned to `spacing` [m]."""
        fine = spacing / 3.0
        points = grid(self.extent, fine)
        points = points[np.abs(self.distance(points)) < fine]
        if len(points) < FEW:  # smaller than the spacing: from outside along the axes
            points = np.concatenate([np.diag(self.extent), -np.diag(self.extent)])
        for _ in range(STEPS):  # Newton steps along the gradient
            points = points - self.distance(points)[:, None] * gradient(self, points)
        points = points[np.abs(self.distance(points)) < ON * spacing]
        points = points[thin(points, APART * spacing)]
        return Local(points, gradient(self, points))


def thin(points: Floats, radius: float) -> Indices:
    """Indices of points, (K, 3) [m], of which no two are nearer than `radius` [m], and none is missing."""
    from scipy.spatial import KDTree

    tree, left = KDTree(points), np.ones(len(points), dtype=np.bool_)
    kept: list[int] = []
    for i in np.random.default_rng(0).permutation(len(points)).tolist():
        if left[i]:
            kept.append(i)
            left[tree.query_ball_point(points[i], radius)] = False
    return np.array(sorted(kept), dtype=np.intp)


def gradient(solid: Solid, points: Floats, step: float = 1e-5) -> Floats:
    """Unit gradient of the distance at points, (K, 3), by central differences over `step` [m]."""
    slopes = [solid.distance(points + e) - solid.distance(points - e) for e in step * np.eye(3)]
    direction = np.stack(slopes, axis=-1)
    size = np.sqrt((direction**2).sum(axis=1, keepdims=True))
    return direction / np.where(size > 0.0, size, 1.0)


def interior(solid: Solid, spacing: float) -> Local:
    """A centred grid inside of a volume, `spacing` [m] apart; normals away from its middle."""
    points = grid(solid.extent, spacing)
    points = points[solid.distance(points) < 0.0]
    return Local(points, gradient(solid, points))


def _triangles(mesh: Mesh) -> Any:
    """The mesh as trimesh has it, in metres; read again when its file has changed."""
    kept = _meshes.pop(id(mesh), None)
    if kept is not None and kept[0] is not mesh:
        kept = None
    state: tuple[int, int] | None = None
    if mesh.file:
        try:
            stat = Path(mesh.file).stat()
            state = stat.st_mtime_ns, stat.st_size
        except (OSError, ValueError) as error:
            if kept is None:
                raise ArgumentError("mesh", f"{mesh.file} does not load: {error}") from error
            state = kept[1]  # it is gone: what was read stays
    if kept is None or kept[1] != state:
        while len(_meshes) >= KEPT:
            del _meshes[next(iter(_meshes))]
        kept = mesh, state, _read(mesh)  # the mesh too: its id stays taken
    _meshes[id(mesh)] = kept
    return kept[2]


def _read(mesh: Mesh) -> Any:
    import trimesh

    name = mesh.file or "given here"
    try:
        if mesh.file:
            loaded: Any = trimesh.load_mesh(Path(mesh.file))
        else:
            loaded = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        if not isinstance(loaded, trimesh.Trimesh) or not len(loaded.faces):
            raise ArgumentError("mesh", f"{name} has no triangles")
        if not np.isfinite(loaded.vertices).all():
            raise ArgumentError("mesh", f"{name} has vertices that are not finite")
        length("mesh", 1e-30 + mesh.scale * float(np.abs(loaded.vertices).max()))
        loaded.vertices = loaded.vertices * mesh.scale
        if not loaded.area > 0.0:
            raise ArgumentError("mesh", f"{name} has no area")
    except ArgumentError:
        raise
    except Exception as error:
        raise ArgumentError("mesh", f"{name} does not load: {error}") from error
    return loaded
