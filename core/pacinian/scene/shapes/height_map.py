"""Height maps: surfaces z = h(x, y)."""

from __future__ import annotations

import itertools
import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_length
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.array_data import decode_array, encode_array
from pacinian.scene.shapes.box_disc_rectangle import Rectangle, distance_beside, distance_outside
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.sdf import scale_shell

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

    Heights = ArrayLike
else:  # the types that a scene file may hold
    Heights = bytes | tuple[tuple[float, ...], ...]

GAUSS = 0.5 - 0.75**0.5 / 3.0, 0.5 + 0.75**0.5 / 3.0  # nodes of the two-point Gauss rule


class HeightMap(
    Struct,
    frozen=True,
    forbid_unknown_fields=True,
    kw_only=True,
    dict=True,
    tag_field="type",
    tag="height-map",
):
    """A surface over a rectangle in the xy-plane, centred on the origin and facing +z.

    heights: at R x C points, in rows as in a picture seen from +z, so that the first row is at the largest y. The first
    and last points lie on the outline. Heights in between are interpolated bilinearly. file: a .npy file or a picture
    (white is 1), instead of heights; a scene file gives it relative to its own folder. width, height: in x and y [m].
    depth: height of the value 1 [m]. Raises ArgumentError.
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
        """Heights, (R, C) [m]; y increases with the row, x with the column."""
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
        """Surface area [m^2]."""
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
        """Distance from the origin to the farthest point [m]."""
        R, C = self.z.shape
        x, y = np.linspace(-0.5, 0.5, C) * self.width, np.linspace(-0.5, 0.5, R) * self.height
        return math.sqrt(float((x**2 + y[:, None] ** 2 + self.z**2).max()))

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), to first order, negative below the surface: (K,) [m].

        This is the height above the surface times the cosine of the slope there. Beside the surface it is positive.
        """
        z, x, y = self._at(points)
        d = (points[:, 2] - z) / np.sqrt(1.0 + x * x + y * y)
        return distance_beside(distance_outside(points, self.width, self.height), d)

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return a grid that includes the outline, at most `spacing` [m] apart in x and y, so wider on slopes."""
        points, _, area = Rectangle(self.width, self.height).sample_surface(spacing)
        points[:, 2], x, y = self._at(points)
        stretch = np.sqrt(1.0 + x * x + y * y)
        normals = np.stack([-x, -y, np.ones_like(x)], axis=-1) / stretch[:, None]
        return LocalSamples(points, normals, scale_shell(area * stretch, self.area))

    def _at(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the height [m] and its slopes in x and y at points, or at the nearest points of the outline, (K,)."""
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
    """Interpolate between a at (s, t) = (0, 0), b at (1, 0), c at (0, 1), d at (1, 1): value, slopes in s and t."""
    x, y = b - a, c - a
    twist = d - c - x
    y = y + s * twist
    return a + s * x + t * y, x + t * twist, y
