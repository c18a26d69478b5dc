"""Conversion of wire shapes to shapes of `pacinian.scene` and back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import asdict

from pacinian.acoustics import pose as scene_pose
from pacinian.errors import WireError
from pacinian.scene.shapes import box_disc_rectangle, csg, curves, mesh, texture, voxels
from pacinian.scene.shapes import height_map as maps
from pacinian.scene.shapes import sphere_capsule as rounds
from pacinian.scene.shapes.array_data import decode_array
from pacinian.wire import shapes
from pacinian.wire.binary_arrays import pack, pack_indices, unpack, unpack_indices
from pacinian.wire.decode_errors import locate_errors
from pacinian.wire.objects import Texture

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Singles

SAME_FIELDS: dict[type, type] = {  # classes whose fields have the same names
    shapes.Rectangle: box_disc_rectangle.Rectangle,
    shapes.Disc: box_disc_rectangle.Disc,
    shapes.Box: box_disc_rectangle.Box,
    shapes.Sphere: rounds.Sphere,
    shapes.Capsule: rounds.Capsule,
    shapes.Line: curves.Line,
    shapes.Circle: curves.Circle,
}
SAME_FIELDS_BACK: dict[type, type] = {theirs: ours for ours, theirs in SAME_FIELDS.items()}


DEGREE_DIGITS = 12  # decimals of degrees on the wire, so that round numbers stay round


def degrees_to_radians(angle: float) -> float:
    """Return an angle of the wire [deg] as a scene has it [rad], less whole turns."""
    return math.radians(math.remainder(angle, 360.0) if abs(angle) > 360.0 else angle)


def radians_to_degrees(angle: float) -> float:
    """Return an angle of a scene [rad] as the wire has it [deg]."""
    return round(math.degrees(angle), DEGREE_DIGITS)


def shape_to_scene(shape: Any) -> Any:
    """Convert a wire shape or curve to one of `pacinian.scene`. Raises ArgumentError, WireError."""
    kind = SAME_FIELDS.get(type(shape))
    return kind(**asdict(shape)) if kind else TO_SCENE[type(shape)](shape)


def shape_to_wire(shape: Any) -> Any:
    """Convert a shape or curve of `pacinian.scene` to a wire one. Reads its file. Raises ArgumentError, WireError."""
    kind = SAME_FIELDS_BACK.get(type(shape))
    if kind:
        return kind(**asdict(shape))
    if (convert := TO_WIRE.get(type(shape))) is None:
        raise WireError(f"a {type(shape).__name__} cannot be sent: give a Mesh or Voxels")
    return convert(shape)


def pose_to_scene(pose: shapes.Pose) -> scene_pose.Pose:
    """Convert a wire pose to a scene pose. Raises ArgumentError."""
    return scene_pose.Pose(pose.position, pose.rotation)


def pose_to_wire(pose: scene_pose.Pose) -> shapes.Pose:
    """Convert a scene pose to a wire pose."""
    return shapes.Pose(pose.position, pose.rotation)


def texture_to_scene(item: Texture) -> texture.Texture:
    """Convert a wire texture to a scene texture. Raises ArgumentError."""
    return texture.Texture(values=_grid(item.values, item.grid), size=item.size, repeat=item.repeat)


def texture_to_wire(item: texture.Texture) -> Texture:
    """Convert a scene texture to a wire texture. Reads its file. Raises ArgumentError."""
    R, C = item.factors.shape
    values = pack(item.factors[::-1])
    return Texture(values=values, grid=(R, C), size=item.size, repeat=item.repeat)


def _grid(data: bytes, grid: tuple[int, ...]) -> Singles:
    return np.frombuffer(data, "<f4").reshape(grid)


def _map_to_scene(s: shapes.HeightMap) -> maps.HeightMap:
    heights = _grid(s.heights, s.grid)
    return maps.HeightMap(heights=heights, width=s.width, height=s.height, depth=s.depth)


def _map_to_wire(s: maps.HeightMap) -> shapes.HeightMap:
    h = decode_array("heights", s.heights, s.file, 2)
    R, C = h.shape
    return shapes.HeightMap(
        heights=pack(h), grid=(R, C), width=s.width, height=s.height, depth=s.depth
    )


def _mesh_to_scene(s: shapes.Mesh) -> mesh.Mesh:
    vertices: Any = unpack(s.vertices, 3)
    faces: Any = unpack_indices(s.faces, 3)
    return mesh.Mesh(scale=s.scale, vertices=vertices, faces=faces)


def _mesh_to_wire(s: mesh.Mesh) -> shapes.Mesh:
    if s.file:
        t = s.triangles
        return shapes.Mesh(vertices=pack(t.vertices), faces=pack_indices(t.faces))
    return shapes.Mesh(vertices=pack(s.vertices), faces=pack_indices(s.faces), scale=s.scale)


def _voxels_to_scene(s: shapes.Voxels) -> voxels.Voxels:
    return voxels.Voxels(values=_grid(s.values, s.grid), pitch=s.pitch, level=s.level)


def _voxels_to_wire(s: voxels.Voxels) -> shapes.Voxels:
    values = decode_array("values", s.values, s.file, 3)
    x, y, z = values.shape
    return shapes.Voxels(values=pack(values), grid=(x, y, z), pitch=s.pitch, level=s.level)


def _polyline_to_scene(s: shapes.Polyline) -> curves.Polyline:
    points: Any = unpack(s.points, 3)
    return curves.Polyline(points, s.closed)


def _polyline_to_wire(s: curves.Polyline) -> shapes.Polyline:
    return shapes.Polyline(pack(s.points), s.closed)


def _placed_to_scene(s: shapes.Placed) -> csg.Placed:
    shape = locate_errors(".shape", shape_to_scene, s.shape)
    return csg.Placed(shape, locate_errors(".pose", pose_to_scene, s.pose))


def _placed_to_wire(s: csg.Placed) -> shapes.Placed:
    _flat(".shape", s.shape, csg.Placed, csg.Combination)
    return shapes.Placed(locate_errors(".shape", shape_to_wire, s.shape), pose_to_wire(s.pose))


def _each(key: str, solids: tuple[Any, ...], convert: Callable[[Any], Any]) -> tuple[Any, ...]:
    return tuple(locate_errors(f".{key}[{i}]", convert, s) for i, s in enumerate(solids))


def _part_to_wire(s: Any) -> Any:
    _flat("", s, csg.Combination)
    return shape_to_wire(s)


def _flat(path: str, shape: object, *kinds: type) -> None:
    if isinstance(shape, kinds):
        name = type(shape).__name__
        raise WireError(f"a {name} within another cannot be sent: solids are one level deep", path)


def _lissajous_to_scene(s: shapes.Lissajous) -> curves.Lissajous:
    return curves.Lissajous(s.width, s.height, s.a, s.b, degrees_to_radians(s.phase))


def _lissajous_to_wire(s: curves.Lissajous) -> shapes.Lissajous:
    return shapes.Lissajous(s.width, s.height, s.a, s.b, radians_to_degrees(s.phase))


def _difference_to_scene(s: shapes.Difference) -> csg.Difference:
    of = locate_errors(".of", shape_to_scene, s.of)
    return csg.Difference(of, _each("less", s.less, shape_to_scene))


def _difference_to_wire(s: csg.Difference) -> shapes.Difference:
    of = locate_errors(".of", _part_to_wire, s.of)
    return shapes.Difference(of, _each("less", s.less, _part_to_wire))


TO_SCENE: dict[type, Callable[[Any], Any]] = {
    shapes.HeightMap: _map_to_scene,
    shapes.Mesh: _mesh_to_scene,
    shapes.Voxels: _voxels_to_scene,
    shapes.Polyline: _polyline_to_scene,
    shapes.Lissajous: _lissajous_to_scene,
    shapes.Placed: _placed_to_scene,
    shapes.Union: lambda s: csg.Union(_each("parts", s.parts, shape_to_scene)),
    shapes.Intersection: lambda s: csg.Intersection(_each("parts", s.parts, shape_to_scene)),
    shapes.Difference: _difference_to_scene,
}
TO_WIRE: dict[type, Callable[[Any], Any]] = {
    maps.HeightMap: _map_to_wire,
    mesh.Mesh: _mesh_to_wire,
    voxels.Voxels: _voxels_to_wire,
    curves.Polyline: _polyline_to_wire,
    curves.Lissajous: _lissajous_to_wire,
    csg.Placed: _placed_to_wire,
    csg.Union: lambda s: shapes.Union(_each("parts", s.parts, _part_to_wire)),
    csg.Intersection: lambda s: shapes.Intersection(_each("parts", s.parts, _part_to_wire)),
    csg.Difference: _difference_to_wire,
}
