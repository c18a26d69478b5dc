"""A rigid pose."""

from __future__ import annotations

from math import cos, hypot, isfinite, sin
from typing import TYPE_CHECKING, cast

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def vector(name: str, value: ArrayLike) -> Vector:
    """Return `value` as three finite floats."""
    if isinstance(value, tuple) and len(value) == 3:
        x, y, z = cast("Vector", value)
        if all(type(v) is float and isfinite(v) for v in (x, y, z)):
            return x, y, z
    x, y, z = check_numbers(name, value, (3,)).tolist()
    return x, y, z


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """The rotation b, then the rotation a."""
    x, y, z, w = a
    p, q, r, s = b
    return (
        w * p + x * s + y * r - z * q,
        w * q - x * r + y * s + z * p,
        w * r + x * q - y * p + z * s,
        w * s - x * p - y * q - z * r,
    )


def rotate(rotation: Quaternion, angular_velocity: Vector, seconds: float) -> Quaternion:
    """`rotation`, turned on at `angular_velocity` [rad/s], about the world's axes, for `seconds` [s]."""
    rate = hypot(*angular_velocity)
    if not rate:
        return rotation
    half = rate * seconds / 2.0
    x, y, z = (sin(half) * v / rate for v in angular_velocity)
    return multiply((x, y, z, cos(half)), rotation)


class Pose(Struct, frozen=True, forbid_unknown_fields=True):
    """Where something is: a rotation about its own origin, then a translation.

    position: [m]. rotation: quaternion (x, y, z, w); normalised here if its length is within 1 % of 1.
    Raises ArgumentError.
    """

    position: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = UPRIGHT

    def __post_init__(self) -> None:
        force_setattr(self, "position", vector("position", self.position))
        if self.rotation is UPRIGHT or (type(self.rotation) is tuple and self.rotation == UPRIGHT):
            return
        q = check_numbers("rotation", self.rotation, (4,))
        size = hypot(*q.tolist())
        if abs(size - 1.0) > 0.01:
            raise ArgumentError(
                "rotation", f"must be a unit quaternion (x, y, z, w), not of length {size:g}"
            )
        force_setattr(self, "rotation", tuple((q / size).tolist()))

    @property
    def matrix(self) -> Floats:
        """The rotation as a matrix, shape (3, 3)."""
        x, y, z, w = self.rotation
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )

    def points(self, local: Floats) -> Floats:
        """World positions [m] of local points, shape (M, 3)."""
        return np.asarray(self.directions(local) + np.array(self.position))

    def directions(self, local: Floats) -> Floats:
        """World directions of local ones, shape (M, 3)."""
        return np.asarray(local @ self.matrix.T)

    @classmethod
    def turned(cls, axis: str, angle: float, position: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """A pose turned about "x", "y" or "z" by `angle` [deg], then placed at `position` [m]."""
        if axis not in ("x", "y", "z"):
            raise ArgumentError("axis", f'must be "x", "y" or "z", not {axis!r}')
        half = np.radians(check_number("angle", angle)) / 2.0
        xyz = [float(np.sin(half)) if name == axis else 0.0 for name in "xyz"]
        return cls(vector("position", position), (xyz[0], xyz[1], xyz[2], float(np.cos(half))))
