"""Shapes and curves on the wire: as in scene files, but with bulk numbers in a `bin` and without files.

Limits: protocol.py.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Grid, Indices, Rows, check_arrays
from pacinian.wire.protocol import (
    MAX_FACES,
    MAX_PARTS,
    MAX_VALUES,
    MAX_VERTICES,
    Angle,
    Extent,
    Length,
    Position,
    Rotation,
    Side,
    Turns,
)

Values = Annotated[bytes, Meta(min_length=4, max_length=4 * MAX_VALUES)]


class Pose(Struct, frozen=True):
    """Position and orientation: a rotation about the origin of a frame, then a translation.

    position: position of the origin. rotation: unit quaternion x, y, z, w.
    """

    position: Position = (0.0, 0.0, 0.0)
    rotation: Rotation = (0.0, 0.0, 0.0, 1.0)


class Rectangle(Struct, frozen=True, tag_field="type", tag="rectangle"):
    """A rectangle in the xy-plane about the origin, facing +z. width: extent in x. height: extent in y."""

    width: Length
    height: Length


class Disc(Struct, frozen=True, tag_field="type", tag="disc"):
    """A disc in the xy-plane about the origin, facing +z. radius: radius of the disc."""

    radius: Length


class Sphere(Struct, frozen=True, tag_field="type", tag="sphere"):
    """A sphere about the origin, as a surface or as a volume. radius: radius of the sphere."""

    radius: Length


class HeightMap(Struct, frozen=True, kw_only=True, tag_field="type", tag="height-map"):
    """A surface over a rectangle in the xy-plane about the origin, facing +z.

    heights: values, (R, C) float32, in rows like those of a picture seen from +z, with the first row at the largest y.
    grid: R, C, each 2 or more. width: extent in x. height: extent in y. depth: height of a value of 1.
    """

    heights: Values
    grid: tuple[Side, Side]
    width: Length
    height: Length
    depth: Length = 1.0

    BULK = (Grid("heights", -1e6, 1e6),)

    def __post_init__(self) -> None:
        check_arrays(self)


class Mesh(Struct, frozen=True, kw_only=True, tag_field="type", tag="mesh"):
    """A triangle mesh. A volume must be closed. A surface faces the side from which triangles run counter-clockwise.

    vertices: positions, (V, 3) float32. faces: indices of vertices, (F, 3) little-endian uint32. scale: metres per unit
    of the vertices.
    """

    vertices: Annotated[bytes, Meta(min_length=36, max_length=12 * MAX_VERTICES)]
    faces: Annotated[bytes, Meta(min_length=12, max_length=12 * MAX_FACES)]
    scale: Length = 1.0

    BULK = Rows("vertices", 3, low=-1e6, high=1e6), Indices("faces", into="vertices")

    def __post_init__(self) -> None:
        check_arrays(self)


class Box(Struct, frozen=True, tag_field="type", tag="box"):
    """A box about the origin. size: full extent in x, y and z."""

    size: Extent


class Capsule(Struct, frozen=True, tag_field="type", tag="capsule"):
    """A capsule along z about the origin. radius: radius of the capsule. length: distance between cap centres."""

    radius: Length
    length: Length


class Voxels(Struct, frozen=True, kw_only=True, tag_field="type", tag="voxels"):
    """A volume given by the fill level of each voxel of a grid about the origin.

    values: fill levels 0..1, (X, Y, Z) float32, z fastest. grid: X, Y, Z. pitch: side of a voxel. level: fill level at
    the shell.
    """

    values: Values
    grid: tuple[Side, Side, Side]
    pitch: Length
    level: Annotated[float, Meta(gt=0.0, le=1.0, description="0..1, not 0")] = 0.5

    BULK = (Grid("values", 0.0, 1.0),)

    def __post_init__(self) -> None:
        check_arrays(self)


Primitive = Sphere | Box | Capsule | Mesh | Voxels


class Placed(Struct, frozen=True, tag_field="type", tag="placed"):
    """A solid that is moved or rotated. shape: solid in its own frame. pose: pose of that frame."""

    shape: Primitive
    pose: Pose = Pose()


Solids = Annotated[tuple[Primitive | Placed, ...], Meta(min_length=1, max_length=MAX_PARTS)]


class Union(Struct, frozen=True, tag_field="type", tag="union"):
    """The union of the parts. parts: solids, one level deep."""

    parts: Solids


class Intersection(Struct, frozen=True, tag_field="type", tag="intersection"):
    """The intersection of the parts. parts: solids, one level deep."""

    parts: Solids


class Difference(Struct, frozen=True, tag_field="type", tag="difference"):
    """One solid without others. of: the solid. less: solids that are cut away."""

    of: Primitive | Placed
    less: Solids


class Line(Struct, frozen=True, tag_field="type", tag="line"):
    """A straight line along x, about the origin. length: length of the line."""

    length: Length


class Circle(Struct, frozen=True, tag_field="type", tag="circle"):
    """A circle in the xy-plane about the origin. radius: radius of the circle."""

    radius: Length


class Lissajous(Struct, frozen=True, tag_field="type", tag="lissajous"):
    """A Lissajous figure in the xy-plane: x = width/2 sin(a s + phase), y = height/2 sin(b s).

    width: extent in x. height: extent in y. a: number of oscillations in x. b: number of oscillations in y. phase:
    lead of x over y.
    """

    width: Length
    height: Length
    a: Turns = 1
    b: Turns = 2
    phase: Angle = 0.0


class Polyline(Struct, frozen=True, tag_field="type", tag="polyline"):
    """Straight segments between points. points: (K, 3) float32 [m]. closed: whether the last joins the first."""

    points: Annotated[bytes, Meta(min_length=24, max_length=12 * MAX_VERTICES)]
    closed: bool = False

    BULK = (Rows("points", 3),)

    def __post_init__(self) -> None:
        check_arrays(self)


Shell = Rectangle | Disc | Sphere | HeightMap | Mesh
Solid = Primitive | Placed | Union | Intersection | Difference
Curve = Line | Circle | Lissajous | Polyline
