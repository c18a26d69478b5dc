"""Solids made of solids: placed, united, intersected, cut out of one another."""

from __future__ import annotations

import functools
import math
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Pose
from pacinian.checks import check_kind
from pacinian.errors import ArgumentError
from pacinian.scene.shapes import Box, Capsule, Sphere, csg_shell
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.sdf import SDF
from pacinian.scene.shapes.voxels import Voxels

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.acoustics.pose import Vector
    from pacinian.types import Floats

    Sides = tuple[tuple["SolidShape", float], ...]

MAX_DEPTH = 16
MAX_SOLIDS = 100  # solids in one


class Placed(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="placed"):
    """A solid elsewhere, or turned. shape: in its own frame. pose: where it is. Raises ArgumentError."""

    shape: SolidShape
    pose: Pose = Pose()

    def __post_init__(self) -> None:
        _solid("shape", self.shape)
        check_kind("pose", self.pose, Pose)
        _limit("shape", self)

    @property
    def area(self) -> float:
        """[m^2]."""
        return self.shape.area

    @property
    def extent(self) -> Vector:
        """Half the size of a box about the origin that holds it [m]."""
        x, y, z = np.abs(self.pose.matrix) @ self.shape.extent + np.abs(self.pose.position)
        return float(x), float(y), float(z)

    @property
    def bounding_radius(self) -> float:
        """Distance of its farthest point from its origin [m], at most."""
        return math.hypot(*self.pose.position) + self.shape.bounding_radius

    def distance(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """As of its shape."""
        local = (points - self.pose.position) @ self.pose.matrix
        return _distance(self.shape, local, beyond, deep)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """As of its shape."""
        points, normals, area = self.shape.sample_surface(spacing)
        return LocalSamples(self.pose.points(points), self.pose.directions(normals), area)


class Combination(Struct, frozen=True, forbid_unknown_fields=True, dict=True, tag_field="type"):
    """What solids made of several have in common; abstract."""

    united: ClassVar[bool] = False

    @cached_property
    def sides(self) -> Sides:
        """Its parts, each with 1 where the shell of the part faces outward, or -1."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """[m^2], measured by samples: an estimate. Raises ArgumentError."""
        return self._area

    @cached_property
    def _area(self) -> float:
        for part, _ in self.sides:
            check_closed(part)
        return csg_shell.measure_shell(self, self.sides)

    @property
    def extent(self) -> Vector:
        """Half the size of a box about the origin that holds it [m]."""
        bound = np.max if self.united else np.min
        x, y, z = bound([part.extent for part, side in self.sides if side > 0.0], axis=0).tolist()
        return x, y, z

    @property
    def bounding_radius(self) -> float:
        """Distance of its farthest point from its origin [m], at most."""
        bound = max if self.united else min
        return bound(part.bounding_radius for part, side in self.sides if side > 0.0)

    def distance(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside. `beyond` and `deep` as of a mesh."""
        each = (
            _distance(part, points, beyond, deep)
            if side > 0.0
            else -_distance(part, points, deep, beyond)
            for part, side in self.sides
        )
        return functools.reduce(np.minimum if self.united else np.maximum, each)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Samples of its parts, about `spacing` [m] apart: those on its shell."""
        return csg_shell.sample_shell(self, self.sides, spacing)


class Union(Combination, frozen=True, tag="union"):
    """All that is in any of the parts; where they meet, it is deeper than its distance says.

    Raises ArgumentError.
    """

    united = True
    parts: tuple[SolidShape, ...]

    def __post_init__(self) -> None:
        force_setattr(self, "parts", _solids("parts", self.parts))
        _limit("parts", self)

    @cached_property
    def sides(self) -> Sides:
        """As of every combination."""
        return tuple((part, 1.0) for part in self.parts)


class Intersection(Combination, frozen=True, tag="intersection"):
    """What is in all of the parts; outside of its edges, it is farther than its distance says.

    Raises ArgumentError.
    """

    parts: tuple[SolidShape, ...]

    def __post_init__(self) -> None:
        force_setattr(self, "parts", _solids("parts", self.parts))
        _limit("parts", self)

    @cached_property
    def sides(self) -> Sides:
        """As of every combination."""
        return tuple((part, 1.0) for part in self.parts)


class Difference(Combination, frozen=True, tag="difference"):
    """What is in one solid and in none of others; outside of its edges, farther than its distance says.

    Raises ArgumentError.
    """

    of: SolidShape
    less: tuple[SolidShape, ...]

    def __post_init__(self) -> None:
        _solid("of", self.of)
        force_setattr(self, "less", _solids("less", self.less))
        _limit("less", self)

    @cached_property
    def sides(self) -> Sides:
        """As of every combination."""
        return (self.of, 1.0), *((part, -1.0) for part in self.less)


SOLIDS = Sphere, Box, Capsule, Mesh, Voxels, SDF, Placed, Union, Intersection, Difference
if TYPE_CHECKING:
    SolidShape = (
        Sphere | Box | Capsule | Mesh | Voxels | SDF | Placed | Union | Intersection | Difference
    )
else:  # what a scene file may hold
    SolidShape = Sphere | Box | Capsule | Mesh | Voxels | Placed | Union | Intersection | Difference


def check_closed(solid: SolidShape) -> None:
    """Refuse a mesh without an inside, also as a part. Raises ArgumentError."""
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


def _limit(name: str, whole: SolidShape) -> None:
    depth, number = _nested(whole)
    if depth > MAX_DEPTH or number > MAX_SOLIDS:
        raise ArgumentError(
            name, f"is {number} solids, {depth} deep: keep to {MAX_SOLIDS}, and to {MAX_DEPTH} deep"
        )


def _nested(solid: SolidShape) -> tuple[int, int]:
    inner = [_nested(part) for part in _inner(solid)]
    return 1 + max((depth for depth, _ in inner), default=-1), sum(n for _, n in inner) or 1


def _inner(solid: SolidShape) -> tuple[SolidShape, ...]:
    if isinstance(solid, Placed):
        return (solid.shape,)
    return tuple(part for part, _ in solid.sides) if isinstance(solid, Combination) else ()


def _distance(solid: SolidShape, points: Floats, beyond: float, deep: float) -> Floats:
    if isinstance(solid, (Mesh, Placed, Combination)):
        return solid.distance(points, beyond, deep)
    return solid.distance(points)
