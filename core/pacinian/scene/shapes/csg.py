"""Constructive solid geometry: solids that are placed, united, intersected or subtracted."""

from __future__ import annotations

import functools
import math
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Pose
from pacinian.argument_checks import check_kind
from pacinian.errors import ArgumentError
from pacinian.scene.shapes import Box, Capsule, Sphere, csg_sampling
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.sdf import SDF
from pacinian.scene.shapes.voxels import Voxels

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.acoustics.pose import Vector
    from pacinian.scene.shapes import Disc, Rectangle
    from pacinian.scene.shapes.height_map import HeightMap
    from pacinian.types import Floats

    Sides = tuple[tuple["SolidShape", float], ...]

MAX_DEPTH = 16  # largest nesting depth of a combination
MAX_SOLIDS = 100  # largest number of solids in a combination


class Placed(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="placed"):
    """A solid that is moved or rotated. shape: in its own frame. pose: of that frame. Raises ArgumentError."""

    shape: SolidShape
    pose: Pose = Pose()

    def __post_init__(self) -> None:
        _solid("shape", self.shape)
        check_kind("pose", self.pose, Pose)
        _limit("shape", self)

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        return self.shape.area

    @property
    def extent(self) -> Vector:
        """Half the size of a bounding box centred on the origin [m]."""
        x, y, z = np.abs(self.pose.matrix) @ self.shape.extent + np.abs(self.pose.position)
        return float(x), float(y), float(z)

    @property
    def bounding_radius(self) -> float:
        """Upper bound of the distance from the origin to the farthest point [m]."""
        return math.hypot(*self.pose.position) + self.shape.bounding_radius

    def distance(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; `beyond` and `deep` as for a mesh."""
        local = (points - self.pose.position) @ self.pose.matrix
        return distance(self.shape, local, beyond, deep)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return samples of the shape's surface, about `spacing` [m] apart."""
        points, normals, area = self.shape.sample_surface(spacing)
        return LocalSamples(self.pose.points(points), self.pose.directions(normals), area)


class Combination(Struct, frozen=True, forbid_unknown_fields=True, dict=True, tag_field="type"):
    """The abstract base of solids that combine several solids."""

    united: ClassVar[bool] = False

    @cached_property
    def sides(self) -> Sides:
        """The parts, each with 1 if the shell of the part faces outward, or -1 if it faces inward."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """Surface area [m^2], estimated from samples. Raises ArgumentError."""
        return self._area

    @cached_property
    def _area(self) -> float:
        for part, _ in self.sides:
            check_closed(part)
        return csg_sampling.measure_shell(self, self.sides)

    @property
    def extent(self) -> Vector:
        """Half the size of a bounding box centred on the origin [m]."""
        bound = np.max if self.united else np.min
        x, y, z = bound([part.extent for part, side in self.sides if side > 0.0], axis=0).tolist()
        return x, y, z

    @property
    def bounding_radius(self) -> float:
        """Upper bound of the distance from the origin to the farthest point [m]."""
        bound = max if self.united else min
        return bound(part.bounding_radius for part, side in self.sides if side > 0.0)

    def distance(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """Return the signed distance of points, (K, 3), negative inside: (K,) [m]. `beyond`, `deep`: as for a mesh."""
        each = (
            distance(part, points, beyond, deep)
            if side > 0.0
            else -distance(part, points, deep, beyond)
            for part, side in self.sides
        )
        return functools.reduce(np.minimum if self.united else np.maximum, each)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return the samples of the parts, about `spacing` [m] apart, that lie on the shell of the whole."""
        return csg_sampling.sample_shell(self, self.sides, spacing)


class _OfParts(Combination, frozen=True):
    """The base of unions and intersections, whose parts all count in the same way."""

    parts: tuple[SolidShape, ...]

    def __post_init__(self) -> None:
        force_setattr(self, "parts", _solids("parts", self.parts))
        _limit("parts", self)

    @cached_property
    def sides(self) -> Sides:
        """The parts, each with 1 if its shell faces outward, or -1."""
        return tuple((part, 1.0) for part in self.parts)


class Union(_OfParts, frozen=True, tag="union"):
    """The union of solids. Inside, where parts overlap, the true depth can exceed the computed one.

    Raises ArgumentError.
    """

    united = True


class Intersection(_OfParts, frozen=True, tag="intersection"):
    """The intersection of solids. Outside its edges, the true distance can exceed the computed one.

    Raises ArgumentError.
    """


class Difference(Combination, frozen=True, tag="difference"):
    """One solid minus others. Outside its edges, the true distance can exceed the computed one.

    of: the solid. less: the solids that are cut out of it. Raises ArgumentError.
    """

    of: SolidShape
    less: tuple[SolidShape, ...]

    def __post_init__(self) -> None:
        _solid("of", self.of)
        force_setattr(self, "less", _solids("less", self.less))
        _limit("less", self)

    @cached_property
    def sides(self) -> Sides:
        """The parts, each with 1 if its shell faces outward, or -1."""
        return (self.of, 1.0), *((part, -1.0) for part in self.less)


SOLIDS = Sphere, Box, Capsule, Mesh, Voxels, SDF, Placed, Union, Intersection, Difference
if TYPE_CHECKING:
    SolidShape = (
        Sphere | Box | Capsule | Mesh | Voxels | SDF | Placed | Union | Intersection | Difference
    )
else:  # scene files cannot hold an SDF
    SolidShape = Sphere | Box | Capsule | Mesh | Voxels | Placed | Union | Intersection | Difference


def check_closed(solid: SolidShape) -> None:
    """Check that all meshes in a solid, parts included, are closed. Raises ArgumentError."""
    if isinstance(solid, Mesh):
        solid.check_closed()
    for part in _inner(solid):
        check_closed(part)


def _solid(name: str, solid: SolidShape) -> None:
    check_kind(name, solid, *SOLIDS)
    if isinstance(solid, Mesh) and not solid.file:
        solid.check_closed()


def _solids(name: str, solids: Iterable[SolidShape]) -> tuple[SolidShape, ...]:
    try:
        solids = tuple(solids)
    except TypeError:
        raise ArgumentError(name, f"must be a list of solids, not {solids!r}") from None
    if not solids:
        raise ArgumentError(name, "must be at least one solid")
    for i, solid in enumerate(solids):
        _solid(f"{name}[{i}]", solid)
    return solids


def _limit(name: str, whole: SolidShape | Combination) -> None:
    depth, number = _measure_nesting(whole)
    if depth > MAX_DEPTH or number > MAX_SOLIDS:
        raise ArgumentError(
            name, f"is {number} solids, {depth} deep: keep to {MAX_SOLIDS}, and to {MAX_DEPTH} deep"
        )


def _measure_nesting(solid: SolidShape | Combination) -> tuple[int, int]:
    inner = [_measure_nesting(part) for part in _inner(solid)]
    return 1 + max((depth for depth, _ in inner), default=-1), sum(n for _, n in inner) or 1


def _inner(solid: SolidShape | Combination) -> tuple[SolidShape, ...]:
    if isinstance(solid, Placed):
        return (solid.shape,)
    return tuple(part for part, _ in solid.sides) if isinstance(solid, Combination) else ()


def distance(
    shape: SolidShape | Rectangle | Disc | HeightMap, points: Floats, beyond: float, deep: float
) -> Floats:
    """Return the signed distance of points, (K, 3), in the shape's own frame, (K,) [m]; negative inside or behind.

    beyond, deep: distances farther outside or inside than these need not be exact [m].
    """
    if isinstance(shape, (Mesh, Placed, Combination)):
        return shape.distance(points, beyond, deep)
    return shape.distance(points)
