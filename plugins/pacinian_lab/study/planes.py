"""The planes of a study's patterns, with their own axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from msgspec import Struct

from pacinian.argument_checks import MAX_LENGTH, check_angle, check_number
from pacinian_lab.study.sweep import Number, check_each, check_single

if TYPE_CHECKING:
    from pacinian.types import Floats


class Plane(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A plane through (x, y, z) [m], parallel to the xy-plane unless tilted.

    tilt: angle by which its axis v is raised [rad]; pi / 2 is upright. azimuth: rotation about z after that [rad].

        u = (cos azimuth, sin azimuth, 0)
        v = (-sin azimuth cos tilt, cos azimuth cos tilt, sin tilt)

    name: its label. Numbers may be lists, which are swept. Raises ArgumentError.
    """

    drawn: ClassVar[bool] = False

    name: str = ""
    x: Number = 0.0
    y: Number = 0.0
    z: Number = 0.2
    tilt: Number = 0.0
    azimuth: Number = 0.0

    def __post_init__(self) -> None:
        for name in ("x", "y", "z"):
            check_each(
                name,
                getattr(self, name),
                lambda n, v: check_number(n, v, low=-MAX_LENGTH, high=MAX_LENGTH),
            )
        for name in ("tilt", "azimuth"):
            check_each(name, getattr(self, name), check_angle)

    @property
    def origin(self) -> Floats:
        """Origin of the plane, (3,) [m]."""
        return np.array([check_single(self.x), check_single(self.y), check_single(self.z)])

    @property
    def axes(self) -> Floats:
        """The unit vectors u and v, (2, 3)."""
        t, a = check_single(self.tilt), check_single(self.azimuth)
        return np.array(
            [
                [np.cos(a), np.sin(a), 0.0],
                [-np.sin(a) * np.cos(t), np.cos(a) * np.cos(t), np.sin(t)],
            ]
        )

    def points(self, uv: Floats) -> Floats:
        """Return the points (..., 3) [m] of the plane at uv, (..., 2) [m]."""
        return np.asarray(self.origin + uv @ self.axes)
