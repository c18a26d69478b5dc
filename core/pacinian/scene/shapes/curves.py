"""Curves in their own frame. They are felt along their whole length, or guide a moving focus."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Vector
from pacinian.argument_checks import (
    MAX_LENGTH,
    check_angle,
    check_count,
    check_integer,
    check_length,
    check_numbers,
)
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.arc_length import Polyline3D
from pacinian.scene.shapes.local_samples import EDGE, LocalSamples

if TYPE_CHECKING:
    from pacinian.types import Floats

MAX_POINTS = 100_000  # largest number of points of a polyline
MIN_LENGTH = 1e-6  # smallest length of a polyline [m]
MAX_FREQUENCY = 100  # largest frequency a or b of a Lissajous figure
POINTS_PER_TURN = 512  # points per turn for measuring a Lissajous figure


class Line(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="line"):
    """A straight line along x, centred on the origin. length: [m]. Raises ArgumentError."""

    length: float

    def __post_init__(self) -> None:
        force_setattr(self, "length", check_length("length", self.length))

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self.length / 2.0

    def at(self, u: Floats) -> Floats:
        """Return the points at u, (K,): (K, 3) [m]. From u = 0 to 1/2 they move to +x at constant speed, then back."""
        points = np.zeros((len(u), 3))
        points[:, 0] = self.length * (_there_and_back(u) - 0.5)
        return points

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points `spacing` [m] apart or a little more. Each represents a square with this side."""
        return _cover(self, spacing, 0.5)

    def distance(self, points: Floats) -> Floats:
        """Return the distance of points, (K, 3), from the curve: (K,) [m]."""
        x, y, z = points.T
        return np.asarray(
            np.hypot(np.hypot(x - np.clip(x, -self.bounding_radius, self.bounding_radius), y), z)
        )


class Circle(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="circle"):
    """A circle in the xy-plane, centred on the origin. radius: [m]. Raises ArgumentError."""

    radius: float

    def __post_init__(self) -> None:
        force_setattr(self, "radius", check_length("radius", self.radius))

    @property
    def length(self) -> float:
        """Length of the curve [m]."""
        return 2.0 * math.pi * self.radius

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self.radius

    def at(self, u: Floats) -> Floats:
        """Return the points at u, (K,): (K, 3) [m]. They go around once from u = 0 to 1, from +x towards +y."""
        phi = 2.0 * np.pi * u
        return self.radius * np.stack([np.cos(phi), np.sin(phi), np.zeros_like(phi)], axis=-1)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points `spacing` [m] apart or a little more. Each represents a square with this side."""
        return _cover(self, spacing)

    def distance(self, points: Floats) -> Floats:
        """Return the distance of points, (K, 3), from the curve: (K,) [m]."""
        x, y, z = points.T
        return np.asarray(np.hypot(np.hypot(x, y) - self.radius, z))


class Lissajous(
    Struct, frozen=True, forbid_unknown_fields=True, dict=True, tag_field="type", tag="lissajous"
):
    """A Lissajous figure in the xy-plane: x = width/2 sin(a s + phase), y = height/2 sin(b s).

    width, height: [m]. a, b: whole numbers from 1; they are divided by their greatest common divisor, so that the
    figure is drawn once, and are then at most 100. phase: [rad]. Raises ArgumentError.
    """

    width: float
    height: float
    a: int = 1
    b: int = 2
    phase: float = 0.0

    def __post_init__(self) -> None:
        force_setattr(self, "width", check_length("width", self.width))
        force_setattr(self, "height", check_length("height", self.height))
        a, b = check_integer("a", self.a, low=1), check_integer("b", self.b, low=1)
        divisor = math.gcd(a, b)
        for name, turns in (("a", a // divisor), ("b", b // divisor)):
            if turns > MAX_FREQUENCY:
                raise ArgumentError(name, f"must be at most {MAX_FREQUENCY}, not {turns}")
            force_setattr(self, name, turns)
        force_setattr(self, "phase", check_angle("phase", self.phase))

    @property
    def length(self) -> float:
        """Length of the curve [m]."""
        return float(self._arc[1][-1])

    @property
    def bounding_radius(self) -> float:
        """Upper bound of the distance from the origin to the farthest point [m]."""
        return math.hypot(self.width, self.height) / 2.0

    def at(self, u: Floats) -> Floats:
        """Return the points at u, (K,): (K, 3) [m]. They draw the figure once at constant speed from u = 0 to 1."""
        s, arc = self._arc
        return self._points(np.interp((u % 1.0) * arc[-1], arc, s))

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points `spacing` [m] apart or a little more. Each represents a square with this side."""
        return _cover(self, spacing)

    def distance(self, points: Floats) -> Floats:
        """Return the distance of points, (K, 3), from the curve, (K,) [m], accurate to 1e-4 of its size."""
        return self._pieces.distance(points)

    def _points(self, s: Floats) -> Floats:
        x = self.width / 2.0 * np.sin(self.a * s + self.phase)
        y = self.height / 2.0 * np.sin(self.b * s)
        return np.stack([x, y, np.zeros_like(x)], axis=-1)

    @functools.cached_property
    def _arc(self) -> tuple[Floats, Floats]:
        """The parameter s, and the arc length up to it [m], (L,) each."""
        s = np.linspace(0.0, 2.0 * np.pi, POINTS_PER_TURN * max(self.a, self.b) + 1)
        x = self.a * self.width / 2.0 * np.cos(self.a * s + self.phase)
        y = self.b * self.height / 2.0 * np.cos(self.b * s)
        speed = np.hypot(x, y)
        steps = (speed[1:] + speed[:-1]) * (s[1] / 2.0)
        return s, np.concatenate([[0.0], np.cumsum(steps)])

    @functools.cached_property
    def _pieces(self) -> Polyline3D:
        return Polyline3D(self._points(self._arc[0]))


class Polyline(
    Struct, frozen=True, forbid_unknown_fields=True, dict=True, tag_field="type", tag="polyline"
):
    """Straight segments from point to point in space.

    points: 2 to 100,000 [m]. closed: whether a segment joins the last point to the first. Raises ArgumentError.
    """

    points: tuple[Vector, ...]
    closed: bool = False

    def __post_init__(self) -> None:
        points = check_numbers("points", self.points, (None, 3))
        if not 2 <= len(points) <= MAX_POINTS:
            raise ArgumentError("points", f"must be 2 to {MAX_POINTS}, not {len(points)}")
        if np.abs(points).max() > MAX_LENGTH:
            raise ArgumentError("points", "must be in metres (millimetres given?)")
        force_setattr(self, "points", tuple(map(tuple, points.tolist())))
        if not self.length >= MIN_LENGTH:
            raise ArgumentError("points", "must not all be the same")

    @property
    def length(self) -> float:
        """Length of the curve [m]."""
        return self._pieces.length

    @functools.cached_property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return float(np.sqrt((np.array(self.points) ** 2).sum(axis=1).max()))

    def at(self, u: Floats) -> Floats:
        """Return the points at u, (K,): (K, 3) [m], at constant speed.

        From u = 0 to 1, they go around a closed polyline once, or along an open one and back.
        """
        share = u % 1.0 if self.closed else _there_and_back(u)
        return self._pieces.at(share * self.length)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points `spacing` [m] apart or a little more. Each represents a square with this side."""
        return _cover(self, spacing, 1.0 if self.closed else 0.5)

    def distance(self, points: Floats) -> Floats:
        """Return the distance of points, (K, 3), from the curve: (K,) [m]."""
        return self._pieces.distance(points)

    @functools.cached_property
    def _pieces(self) -> Polyline3D:
        points = np.array(self.points)
        return Polyline3D(np.concatenate([points, points[:1]]) if self.closed else points)


Curve = Line | Circle | Lissajous | Polyline


def _there_and_back(u: Floats) -> Floats:
    """Return values that go from 0 to 1 and back to 0 as u goes from 0 to 1."""
    return np.asarray(1.0 - np.abs(1.0 - 2.0 * (u % 1.0)))


def _cover(curve: Curve, spacing: float, once: float = 1.0) -> LocalSamples:
    """Return the midpoints of equal pieces of a curve that is traversed once as u goes from 0 to `once`."""
    K = max(1, math.floor(check_count(curve.length, spacing, 1) + EDGE))
    points = curve.at(np.asarray(once * (np.arange(K) + 0.5) / K, dtype=np.float64))
    return LocalSamples(points, np.zeros_like(points), np.full(K, (curve.length / K) ** 2))
