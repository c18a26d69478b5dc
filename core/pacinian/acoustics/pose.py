"""Rigid poses."""

from __future__ import annotations

from math import cos, hypot, isfinite, sin
from typing import TYPE_CHECKING, cast

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_angle, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def vector(name: str, value: ArrayLike) -> Vector:
    """Return `value` as three finite floats."""
    if isinstance(value, tuple) and len(value) == 3:
        x, y, z = cast("Vector", value)
        if all(type(v) is float and isfinite(v) for v in (x, y, z)):
            return x, y, z
    x, y, z = check_numbers(name, value, (3,)).tolist()
    return x, y, z


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation b followed by the rotation a."""
    x, y, z, w = a
    p, q, r, s = b
    return (
        w * p + x * s + y * r - z * q,
        w * q - x * r + y * s + z * p,
        w * r + x * q - y * p + z * s,
        w * s - x * p - y * q - z * r,
    )


def rotate(rotation: Quaternion, angular_velocity: Vector, seconds: float) -> Quaternion:
    """Return `rotation` after `seconds` [s] at `angular_velocity` [rad/s], about the world's axes."""
    rate = hypot(*angular_velocity)
    if not rate:
        return rotation
    half = rate * seconds / 2.0
    x, y, z = (sin(half) * v / rate for v in angular_velocity)
    return multiply((x, y, z, cos(half)), rotation)


class Pose(Struct, frozen=True, forbid_unknown_fields=True):
    """The pose of an object: a rotation about its own origin, followed by a translation.

    position: [m]. rotation: quaternion (x, y, z, w); normalised here if its length is within 1 % of 1.
    Poses are immutable: `translate`, `rotate`, `inverse` and `a @ b` return new ones. Raises ArgumentError.
    """

    position: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = UPRIGHT

    def __post_init__(self) -> None:
        force_setattr(self, "position", vector("position", self.position))
        if self.rotation is UPRIGHT or (type(self.rotation) is tuple and self.rotation == UPRIGHT):
            force_setattr(self, "rotation", UPRIGHT)  # not of integers
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
        """The rotation matrix, shape (3, 3)."""
        x, y, z, w = self.rotation
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )

    def points(self, local: Floats) -> Floats:
        """Return the world positions of local points, shape (M, 3) [m]."""
        return np.asarray(self.directions(local) + np.array(self.position))

    def directions(self, local: Floats) -> Floats:
        """Return the world directions of local directions, shape (M, 3)."""
        return np.asarray(local @ self.matrix.T)

    def translate(self, offset: ArrayLike) -> Pose:
        """Return this pose shifted by `offset`, (3,) [m], along the world's axes. Raises ArgumentError."""
        x, y, z = self.position
        a, b, c = vector("offset", offset)
        return Pose((x + a, y + b, z + c), self.rotation)

    def rotate(self, axis: str | ArrayLike, angle: float) -> Pose:
        """Return this pose rotated about its own position, which stays where it is.

        axis: "x", "y" or "z" of the world, or any direction, (3,). angle: [rad], counter-clockwise seen from the tip of
        the axis, -2 pi to 2 pi. To rotate about the world's origin, use `Pose().rotate(axis, angle) @ pose`; about the
        pose's own axes, `pose @ Pose().rotate(axis, angle)`. Raises ArgumentError.
        """
        x, y, z = _axis(axis)
        half = check_angle("angle", angle) / 2.0
        turn = (sin(half) * x, sin(half) * y, sin(half) * z, cos(half))
        return Pose(self.position, multiply(turn, self.rotation))

    def inverse(self) -> Pose:
        """Return the pose that undoes this one: `pose @ pose.inverse()` is `Pose()`."""
        x, y, z, w = self.rotation
        back = Pose((0.0, 0.0, 0.0), (-x, -y, -z, w))
        a, b, c = back.directions(np.array(self.position)).tolist()
        return Pose((-a, -b, -c), back.rotation)

    def __matmul__(self, other: object) -> Pose:
        """Return `other` followed by this pose: `(a @ b).points(q)` is `a.points(b.points(q))`."""
        if not isinstance(other, Pose):
            return NotImplemented
        return Pose(
            vector("position", self.points(np.array(other.position))),
            multiply(self.rotation, other.rotation),
        )


def _axis(axis: str | ArrayLike) -> Vector:
    """Return the unit vector of an axis. Raises ArgumentError."""
    if isinstance(axis, str):
        if axis in AXES:
            return AXES[axis]
        raise ArgumentError("axis", f'must be "x", "y", "z" or a direction, not {axis!r}')
    d = check_numbers("axis", axis, (3,))
    largest = float(np.abs(d).max())
    if not largest:
        raise ArgumentError("axis", "has zero length")
    d = d / largest
    x, y, z = (d / np.sqrt(d @ d)).tolist()
    return x, y, z
