"""Motion between updates: extrapolate the pose of an object from its last known pose and velocity."""

from __future__ import annotations

import math

from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Pose, Vector, rotate, vector
from pacinian.argument_checks import check_number
from pacinian.errors import ArgumentError

MAX_EXTRAPOLATION = 0.1  # an object stops this long after its last update [s]
MAX_SPEED = 100.0  # largest speed of an object [m/s]
STILL = 0.0, 0.0, 0.0


class Motion(Struct, frozen=True, forbid_unknown_fields=True):
    """The motion of an object since it was seen at its pose.

    velocity: [m/s]. angular_velocity: about the world's axes [rad/s]. time: when the object was seen, by the
    renderer's clock [s]. The motion is extrapolated for 0.1 s, so send the next update before that. Raises
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
        """Return for how long the object has moved by time t [s]: 0 to 0.1 s."""
        return min(max(t - self.time, 0.0), MAX_EXTRAPOLATION)

    def position(self, position: Vector, t: float) -> Vector:
        """Return the position [m] at time t [s] of a point that was seen at `position` [m]."""
        s, (x, y, z), (u, v, w) = self.age(t), position, self.velocity
        return x + s * u, y + s * v, z + s * w

    def pose(self, pose: Pose, t: float) -> Pose:
        """Return the pose at time t [s] of an object that was seen at `pose`, at constant velocities."""
        rotation = pose.rotation
        if self.angular_velocity != STILL:
            rotation = rotate(rotation, self.angular_velocity, self.age(t))
        return Pose(self.position(pose.position, t), rotation)
