"""Motion between updates: where a thing is now, that was seen somewhere a moment ago."""

from __future__ import annotations

import math

from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Pose, Vector, rotate, vector
from pacinian.checks import check_number
from pacinian.errors import ArgumentError

MAX_EXTRAPOLATION = 0.1  # [s] after which an update is no longer followed: the thing stands still
MAX_SPEED = 100.0  # [m/s]
STILL = 0.0, 0.0, 0.0


class Motion(Struct, frozen=True, forbid_unknown_fields=True):
    """How an object moves after it was seen at its pose.

    velocity: [m/s]. angular_velocity: about the world's axes [rad/s]. time: when it was seen [s],
    of the renderer's time. It is followed for 0.1 s; the next update should come before. Raises
    ArgumentError.
    """

    velocity: Vector = STILL
    angular_velocity: Vector = STILL
    time: float = 0.0

    def __post_init__(self) -> None:
        for name in ("velocity", "angular_velocity"):
            force_setattr(self, name, vector(name, getattr(self, name)))
        if math.hypot(*self.velocity) > MAX_SPEED:
            raise ArgumentError(
                "velocity", f"must be at most {MAX_SPEED:g} m/s, in metres a second"
            )
        force_setattr(self, "time", check_number("time", self.time))

    def age(self, t: float) -> float:
        """For how long it has moved at time t [s], 0 to 0.1 s."""
        return min(max(t - self.time, 0.0), MAX_EXTRAPOLATION)

    def position(self, position: Vector, t: float) -> Vector:
        """Where at time t [s] is what was seen at `position` [m]."""
        s, (x, y, z), (u, v, w) = self.age(t), position, self.velocity
        return x + s * u, y + s * v, z + s * w

    def pose(self, pose: Pose, t: float) -> Pose:
        """The pose at time t [s] of what was seen at `pose`: straight on, at a constant turn."""
        rotation = pose.rotation
        if self.angular_velocity != STILL:
            rotation = rotate(rotation, self.angular_velocity, self.age(t))
        return Pose(self.position(pose.position, t), rotation)
