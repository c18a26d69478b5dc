"""Round shapes: sphere and capsule."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_count, check_length
from pacinian.scene.shapes.local_samples import GOLDEN, LocalSamples

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Vector
    from pacinian.types import Floats


class Sphere(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="sphere"):
    """A sphere about the origin, as a surface or as a volume. radius [m]."""

    radius: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", check_length("radius", self.radius))

    @property
    def area(self) -> float:
        """[m^2]."""
        return 4.0 * math.pi * self.radius**2

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        return (self.radius, self.radius, self.radius)

    @property
    def bounding_radius(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return self.radius

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside."""
        x, y, z = points.T
        return np.asarray(np.sqrt(x * x + y * y + z * z) - self.radius)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """A Fibonacci lattice: equal areas, about `spacing` [m] apart."""
        return _spiral(self.radius, 0.0, self.area, spacing)


class Capsule(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="capsule"):
    """A capsule about the origin along z. radius [m]; length [m] between the centres of its caps."""

    radius: float
    length: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", check_length("radius", self.radius))
        force_setattr(self, "length", check_length("length", self.length))

    @property
    def area(self) -> float:
        """[m^2]."""
        return 2.0 * math.pi * self.radius * (2.0 * self.radius + self.length)

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        return (self.radius, self.radius, self.radius + self.length / 2.0)

    @property
    def bounding_radius(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        return self.radius + self.length / 2.0

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m]; negative inside."""
        x, y, z = points.T
        beyond = np.maximum(np.abs(z) - self.length / 2.0, 0.0)
        return np.asarray(np.sqrt(x * x + y * y + beyond * beyond) - self.radius)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """A spiral: equal areas, about `spacing` [m] apart."""
        return _spiral(self.radius, self.length / 2.0, self.area, spacing)


def _spiral(a: float, half: float, area: float, spacing: float) -> LocalSamples:
    """Equal areas (Archimedes' theorem, for caps and mantle alike) of a sphere of radius a drawn out in z."""
    K = max(4, round(check_count(area, spacing, 2)))
    i = np.arange(K)
    height = (a + half) * (1.0 - (2.0 * i + 1.0) / K)  # of the enclosing cylinder's mantle
    axis = np.clip(height, -half, half)
    z, phi = (height - axis) / a, i * GOLDEN
    r = np.sqrt(1.0 - z * z)
    normals = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    points = a * normals
    points[:, 2] += axis
    return LocalSamples(points, normals, np.full(K, area / K))
