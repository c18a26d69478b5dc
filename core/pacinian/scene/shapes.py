"""Shapes in their own frame, and how each is covered with points."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Vector, vector
from pacinian.checks import count, length

if TYPE_CHECKING:
    from pacinian.types import Floats

GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # [rad]
EDGE = 1e-9  # [m]


class Local(NamedTuple):
    """Samples in a shape's own frame. points: (K, 3) [m]. normals: outward, (K, 3)."""

    points: Floats
    normals: Floats


class Rectangle(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="rectangle"):
    """A rectangle in the xy-plane about the origin, facing +z. width in x, height in y [m]."""

    width: float
    height: float

    def __post_init__(self) -> None:
        force_setattr(self, "width", length("width", self.width))
        force_setattr(self, "height", length("height", self.height))

    @property
    def area(self) -> float:
        """[m^2]."""
        return self.width * self.height

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return math.hypot(self.width, self.height) / 2.0

    def cover(self, spacing: float) -> Local:
        """A centred grid, `spacing` [m] apart or a little more."""
        count(self.area, spacing, 2)
        x, y = (_centred(extent, spacing) for extent in (self.width, self.height))
        X, Y = np.meshgrid(x, y)
        points = np.stack([X, Y, np.zeros_like(X)], axis=-1).reshape(-1, 3)
        return Local(points, np.broadcast_to([0.0, 0.0, 1.0], points.shape).copy())


class Disc(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="disc"):
    """A disc in the xy-plane about the origin, facing +z. radius [m]."""

    radius: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", length("radius", self.radius))

    @property
    def area(self) -> float:
        """[m^2]."""
        return math.pi * self.radius**2

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return self.radius

    def cover(self, spacing: float) -> Local:
        """A sunflower: equal areas, about `spacing` [m] apart."""
        K = max(1, round(count(self.area, spacing, 2)))
        i = np.arange(K)
        r, phi = self.radius * np.sqrt((i + 0.5) / K) if K > 1 else np.zeros(1), i * GOLDEN
        points = np.stack([r * np.cos(phi), r * np.sin(phi), np.zeros(K)], axis=-1)
        return Local(points, np.broadcast_to([0.0, 0.0, 1.0], points.shape).copy())


class Sphere(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="sphere"):
    """A sphere about the origin, as a surface or as a volume. radius [m]."""

    radius: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", length("radius", self.radius))

    @property
    def area(self) -> float:
        """[m^2]."""
        return 4.0 * math.pi * self.radius**2

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        return (self.radius, self.radius, self.radius)

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside."""
        return np.asarray(np.sqrt((points * points).sum(axis=1)) - self.radius)

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return self.radius

    def cover(self, spacing: float) -> Local:
        """A Fibonacci lattice: equal areas, about `spacing` [m] apart."""
        K = max(4, round(count(self.area, spacing, 2)))
        i = np.arange(K)
        z, phi = 1.0 - (2.0 * i + 1.0) / K, i * GOLDEN
        r = np.sqrt(1.0 - z * z)
        normals = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
        return Local(self.radius * normals, normals)


class Box(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="box"):
    """A box about the origin. size: its full extent in x, y and z [m]."""

    size: Vector

    def __post_init__(self) -> None:
        force_setattr(self, "size", vector("size", self.size))
        for extent in self.size:
            length("size", extent)

    @property
    def area(self) -> float:
        """[m^2]."""
        x, y, z = self.size
        return 2.0 * (x * y + y * z + z * x)

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        x, y, z = self.size
        return (x / 2.0, y / 2.0, z / 2.0)

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside."""
        d = np.abs(points) - np.array(self.extent)
        outside = np.sqrt((np.maximum(d, 0.0) ** 2).sum(axis=1))
        return np.asarray(outside + np.minimum(d.max(axis=1), 0.0))

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return math.hypot(*self.extent)

    def cover(self, spacing: float) -> Local:
        """A centred grid on each of the six faces, none on an edge."""
        x, y, z = self.size
        points: list[Floats] = []
        normals: list[Floats] = []
        for axis, (width, height) in enumerate(((y, z), (z, x), (x, y))):
            face = Rectangle(width, height).cover(spacing).points
            for side in (-1.0, 1.0):
                # (u, v, 0) to the face's own two axes, in turn
                at = np.roll(face, axis + 1, axis=1)
                at[:, axis] = side * self.extent[axis]
                points.append(at)
                normals.append(np.broadcast_to(side * np.eye(3)[axis], at.shape))
        return Local(np.concatenate(points), np.concatenate(normals))


class Capsule(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="capsule"):
    """A capsule about the origin along z. radius [m]; length [m] between the centres of its caps."""

    radius: float
    length: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", length("radius", self.radius))
        force_setattr(self, "length", length("length", self.length))

    @property
    def area(self) -> float:
        """[m^2]."""
        return 2.0 * math.pi * self.radius * (2.0 * self.radius + self.length)

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        return (self.radius, self.radius, self.radius + self.length / 2.0)

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside."""
        half = self.length / 2.0
        axis = np.clip(points[:, 2], -half, half)
        d = points - np.stack([np.zeros_like(axis), np.zeros_like(axis), axis], axis=-1)
        return np.asarray(np.sqrt((d * d).sum(axis=1)) - self.radius)

    @property
    def reach(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return self.radius + self.length / 2.0

    def cover(self, spacing: float) -> Local:
        """A spiral: equal areas (Archimedes' theorem, for caps and mantle alike), about `spacing` [m] apart."""
        K = max(4, round(count(self.area, spacing, 2)))
        i = np.arange(K)
        a, half = self.radius, self.length / 2.0
        height = (a + half) * (1.0 - (2.0 * i + 1.0) / K)  # of the enclosing cylinder's mantle
        axis = np.clip(height, -half, half)
        z, phi = (height - axis) / a, i * GOLDEN
        r = np.sqrt(1.0 - z * z)
        normals = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
        return Local(a * normals + np.stack([0 * axis, 0 * axis, axis], axis=-1), normals)


def grid(extent: Vector, spacing: float) -> Floats:
    """A centred grid in the box of half size `extent` [m], (K, 3)."""
    count(8.0 * math.prod(extent), spacing, 3)
    axes = [_centred(2.0 * half, spacing) for half in extent]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _centred(extent: float, spacing: float) -> Floats:
    """Equal steps of at least `spacing`, half a step from both ends of a centred interval."""
    K = max(1, math.floor(extent / spacing + EDGE))
    return np.linspace(0.5 - K / 2.0, K / 2.0 - 0.5, K) * (extent / K)
