"""Round shapes: sphere and capsule."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_count, check_length
from pacinian.scene.shapes.local_samples import GOLDEN_ANGLE, LocalSamples

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Vector
    from pacinian.types import Floats


class Sphere(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="sphere"):
    """A sphere centred on the origin, as a surface or as a volume. radius: [m]."""

    radius: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", check_length("radius", self.radius))

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        return 4.0 * math.pi * self.radius**2

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        return (self.radius, self.radius, self.radius)

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self.radius

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; negative inside."""
        x, y, z = points.T
        return np.asarray(np.sqrt(x * x + y * y + z * z) - self.radius)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return a Fibonacci lattice of equal areas, about `spacing` [m] apart."""
        return _spiral(self.radius, 0.0, self.area, spacing)


class Capsule(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="capsule"):
    """A capsule along z, centred on the origin. radius: [m]. length: between the centres of the caps [m]."""

    radius: float
    length: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", check_length("radius", self.radius))
        force_setattr(self, "length", check_length("length", self.length))

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        return 2.0 * math.pi * self.radius * (2.0 * self.radius + self.length)

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        return (self.radius, self.radius, self.radius + self.length / 2.0)

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self.radius + self.length / 2.0

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; negative inside."""
        x, y, z = points.T
        beyond = np.maximum(np.abs(z) - self.length / 2.0, 0.0)
        return np.asarray(np.sqrt(x * x + y * y + beyond * beyond) - self.radius)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return a spiral of equal areas, about `spacing` [m] apart."""
        return _spiral(self.radius, self.length / 2.0, self.area, spacing)


def _spiral(a: float, half: float, area: float, spacing: float) -> LocalSamples:
    """Divide a capsule of radius `a` and half length `half` along z into equal areas on a spiral.

    By Archimedes' theorem, equal steps in z cover equal areas, on the caps as on the cylinder.
    """
    K = max(4, round(check_count(area, spacing, 2)))
    i = np.arange(K)
    height = (a + half) * (1.0 - (2.0 * i + 1.0) / K)  # z if the caps were part of the cylinder
    axis = np.clip(height, -half, half)
    z, phi = (height - axis) / a, i * GOLDEN_ANGLE
    r = np.sqrt(1.0 - z * z)
    normals = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    points = a * normals
    points[:, 2] += axis
    return LocalSamples(points, normals, np.full(K, area / K))
