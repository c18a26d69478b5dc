"""Height maps: surfaces z = h(x, y)."""

from __future__ import annotations

import itertools
import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_length
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.arrays import decode_array, encode_array
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.planar import Rectangle, distance_beside, distance_outside
from pacinian.scene.shapes.sdf import scale_shell

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

    Heights = ArrayLike
else:  # what a scene file may hold
    Heights = bytes | tuple[tuple[float, ...], ...]

GAUSS = 0.5 - 0.75**0.5 / 3.0, 0.5 + 0.75**0.5 / 3.0  # the two points of his rule


class HeightMap(
    Struct,
    frozen=True,
    forbid_unknown_fields=True,
    kw_only=True,
    dict=True,
    tag_field="type",
    tag="height-map",
):
    """A surface over a rectangle in the xy-plane about the origin, facing +z.

    heights: at R x C points, in rows as in a picture that is looked at from +z: the first row is at the
    far end of y, the first and last points are on the outline. Between them it is bilinear. Or file: a
    .npy file, or a picture (white is 1); in a scene file from that file's folder. width in x, height in
    y [m]. depth: how high 1 is [m]. Raises ArgumentError.
    """

    heights: Heights | None = None
    width: float
    height: float
    depth: float = 1.0
    file: str = ""

    def __post_init__(self) -> None:
        for name in ("width", "height", "depth"):
            force_setattr(self, name, check_length(name, getattr(self, name)))
        force_setattr(self, "heights", encode_array("heights", self.heights, self.file, 2))
        if not self.file:
            _ = self.z

    @cached_property
    def z(self) -> Floats:
        """Its heights, (R, C) [m]; y grows with the row, x with the column."""
        given = decode_array("heights", self.heights, self.file, 2)
        R, C = given.shape
        if min(R, C) < 2:
            raise ArgumentError("heights", f"must be at least 2 x 2, not {R} x {C}")
        z = self.depth * given[::-1].astype(np.float64)
        check_length("heights", 1e-30 + float(np.abs(z).max()))
        z.setflags(write=False)
        return z

    @cached_property
    def area(self) -> float:
        """[m^2]."""
        R, C = self.z.shape
        corners = self.z[:-1, :-1], self.z[:-1, 1:], self.z[1:, :-1], self.z[1:, 1:]
        stretch = 0.0
        for s, t in itertools.product(GAUSS, GAUSS):
            _, x, y = _bilinear(*corners, s, t)
            x, y = x * (C - 1) / self.width, y * (R - 1) / self.height
            stretch += float(np.sqrt(1.0 + x * x + y * y).mean()) / 4.0
        return stretch * self.width * self.height

    @cached_property
    def bounding_radius(self) -> float:
        """Distance of its farthest point from its origin [m]."""
        R, C = self.z.shape
        x, y = np.linspace(-0.5, 0.5, C) * self.width, np.linspace(-0.5, 0.5, R) * self.height
        return math.sqrt(float((x**2 + y[:, None] ** 2 + self.z**2).max()))

    def distance(self, points: Floats) -> Floats:
        """Signed distance of points, (K, 3), (K,) [m], to first order; negative below, not beside it.

        It is the height above the surface times the cosine of the slope there.
        """
        z, x, y = self._at(points)
        d = (points[:, 2] - z) / np.sqrt(1.0 + x * x + y * y)
        return distance_beside(distance_outside(points, self.width, self.height), d)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """A grid in x and y with the outline in it, at most `spacing` [m] apart: farther on a slope."""
        points, _, area = Rectangle(self.width, self.height).sample_surface(spacing)
        points[:, 2], x, y = self._at(points)
        stretch = np.sqrt(1.0 + x * x + y * y)
        normals = np.stack([-x, -y, np.ones_like(x)], axis=-1) / stretch[:, None]
        return LocalSamples(points, normals, scale_shell(area * stretch, self.area))

    def _at(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Height at points [m], or at those of the outline next to them, and its slopes in x and y, (K,)."""
        R, C = self.z.shape
        u, v = (C - 1) / self.width, (R - 1) / self.height
        s = np.fmin(np.fmax(points[:, 0] * u + (C - 1) / 2.0, 0.0), C - 1.0)
        t = np.fmin(np.fmax(points[:, 1] * v + (R - 1) / 2.0, 0.0), R - 1.0)
        i, j = np.minimum(t.astype(np.intp), R - 2), np.minimum(s.astype(np.intp), C - 2)
        a, b, c, d = self.z.take(i * C + j + np.array([[0], [1], [C], [C + 1]]))
        z, x, y = _bilinear(a, b, c, d, s - j, t - i)
        return z, x * u, y * v


def _bilinear(
    a: Floats, b: Floats, c: Floats, d: Floats, s: Floats | float, t: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """Between a at (s, t) = (0, 0), b at (1, 0), c at (0, 1) and d: the value, and its slopes in s and t."""
    x, y = b - a, c - a
    twist = d - c - x
    y = y + s * twist
    return a + s * x + t * y, x + t * twist, y
