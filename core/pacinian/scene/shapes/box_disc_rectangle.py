"""Shapes with flat faces: rectangle, disc and box."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Vector, vector
from pacinian.argument_checks import check_count, check_length
from pacinian.scene.shapes.local_samples import EDGE, LocalSamples, centre, span

if TYPE_CHECKING:
    from pacinian.types import Floats


class Rectangle(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="rectangle"):
    """A rectangle in the xy-plane, centred on the origin and facing +z. width, height: in x and y [m]."""

    width: float
    height: float

    def __post_init__(self) -> None:
        force_setattr(self, "width", check_length("width", self.width))
        force_setattr(self, "height", check_length("height", self.height))

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        return self.width * self.height

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return math.hypot(self.width, self.height) / 2.0

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]: negative behind the surface, positive beside it."""
        return distance_beside(distance_outside(points, self.width, self.height), points[:, 2])

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return a grid that includes the outline, at most `spacing` [m] apart."""
        check_count(self.area, spacing, 2)
        (x, width), (y, height) = span(self.width, spacing), span(self.height, spacing)
        X, Y = np.meshgrid(x, y)
        return _make_flat_samples(X.ravel(), Y.ravel(), np.outer(height, width).ravel())


class Disc(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="disc"):
    """A disc in the xy-plane, centred on the origin and facing +z. radius: [m]."""

    radius: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", check_length("radius", self.radius))

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        return math.pi * self.radius**2

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self.radius

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]: negative behind the surface, positive beside it."""
        x, y, z = points.T
        return distance_beside(np.maximum(np.hypot(x, y) - self.radius, 0.0), z)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points on rings that include the outline, at most `spacing` [m] apart along and across the rings."""
        check_count(self.area, spacing, 2)
        radius = self.radius if self.radius >= spacing / 2.0 else 0.0
        steps = math.ceil(radius / spacing - EDGE)
        r = np.linspace(0.0, radius, steps + 1)
        edges = np.concatenate([[0.0], (r[1:] + r[:-1]) / 2.0, [self.radius]])
        counts = np.ceil(2.0 * math.pi * r / spacing - EDGE).clip(1.0).astype(np.intp)
        ring = np.repeat(np.arange(steps + 1), counts)
        nth = np.arange(len(ring)) - np.repeat(np.cumsum(counts) - counts, counts)
        phi = 2.0 * math.pi * (nth + ring % 2 / 2.0) / counts[ring]
        area = math.pi * np.diff(edges**2) / counts
        return _make_flat_samples(r[ring] * np.cos(phi), r[ring] * np.sin(phi), area[ring])


class Box(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="box"):
    """A box centred on the origin. size: its full extent in x, y and z [m]."""

    size: Vector

    def __post_init__(self) -> None:
        force_setattr(self, "size", vector("size", self.size))
        for extent in self.size:
            check_length("size", extent)

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        x, y, z = self.size
        return 2.0 * (x * y + y * z + z * x)

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box [m]."""
        x, y, z = self.size
        return (x / 2.0, y / 2.0, z / 2.0)

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return math.hypot(*self.extent)

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; negative inside."""
        x, y, z = np.abs(points.T) - np.array(self.extent)[:, None]
        nearest = np.maximum(np.maximum(x, y), z)
        x, y, z = np.maximum(x, 0.0), np.maximum(y, 0.0), np.maximum(z, 0.0)
        return np.asarray(np.sqrt(x * x + y * y + z * z) + np.minimum(nearest, 0.0))

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return a centred grid on each of the six faces, `spacing` [m] apart or a little more, without the edges."""
        x, y, z = self.size
        sides: list[LocalSamples] = []
        for axis, (width, height) in enumerate(((y, z), (z, x), (x, y))):
            face = _inner(width, height, spacing)
            for side in (-1.0, 1.0):
                # cyclically move (u, v, 0) to the axes of this face
                points = np.roll(face.points, axis + 1, axis=1)
                points[:, axis] = side * self.extent[axis]
                normals = np.roll(side * face.normals, axis + 1, axis=1)
                sides.append(LocalSamples(points, normals, face.area))
        return LocalSamples(*(np.concatenate(values) for values in zip(*sides, strict=True)))


def _inner(width: float, height: float, spacing: float) -> LocalSamples:
    """Return a centred grid that starts half a step from the outline."""
    check_count(width * height, spacing, 2)
    X, Y = np.meshgrid(centre(width, spacing), centre(height, spacing))
    return _make_flat_samples(X.ravel(), Y.ravel(), np.full(X.size, width * height / X.size))


def distance_outside(points: Floats, width: float, height: float) -> Floats:
    """Return the distance of points, (K, 3), outside a centred width x height outline in x and y, (K,) [m]."""
    x, y = np.maximum(np.abs(points[:, 0]) - width / 2.0, 0.0), np.abs(points[:, 1]) - height / 2.0
    return np.asarray(np.hypot(x, np.maximum(y, 0.0)))


def distance_beside(outside: Floats, height: Floats) -> Floats:
    """Return the signed distance to an open surface, (K,) [m]: within its outline, the height of the point."""
    return np.where(outside > 0.0, np.hypot(outside, height), height)


def _make_flat_samples(x: Floats, y: Floats, area: Floats) -> LocalSamples:
    K = len(x)
    points = np.stack([x, y, np.zeros(K)], axis=-1)
    return LocalSamples(points, np.tile([0.0, 0.0, 1.0], (K, 1)), area)
