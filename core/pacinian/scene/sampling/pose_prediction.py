"""Predict the poses of objects between updates, and blend in each update without a jump.

Velocities come from the client.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pose import UPRIGHT, Pose, Quaternion, Vector, multiply

if TYPE_CHECKING:
    from pacinian.scene.objects import Object

BLEND_TIME = 0.01  # time in which the prediction error of an update is blended out [s]
MAX_BLENDED_ERROR = 0.05  # a larger prediction error is a teleport, which is not blended [m]
MAX_OBJECTS = 4096  # largest number of tracked objects


def compute_blend_factor(since: float, t: float) -> float:
    """Return the factor at time t [s] on the prediction error of an update at time `since` [s].

    It falls from 1 to 0 within `BLEND_TIME`, and is then negative: nothing is left to blend.
    """
    return 1.0 - (t - since) / BLEND_TIME


@dataclass
class _Track:
    item: Object
    since: float
    offset: Vector = (0.0, 0.0, 0.0)  # [m] at `since`
    turn: Quaternion = UPRIGHT

    def pose(self, t: float) -> Pose:
        motion = self.item.motion
        assert motion is not None  # objects without a motion are not tracked
        now = motion.pose(self.item.pose, t)
        self.since = min(self.since, t)  # time may jump back
        f = compute_blend_factor(self.since, t)
        if f <= 0.0 or (self.offset == (0.0, 0.0, 0.0) and self.turn == UPRIGHT):
            return now
        (x, y, z), (u, v, w) = now.position, self.offset
        rotation = now.rotation
        if self.turn != UPRIGHT:
            a, b, c, d = self.turn
            part = np.array([f * a, f * b, f * c, (1.0 - f) + f * d])
            a, b, c, d = (part / np.sqrt(part @ part)).tolist()
            rotation = multiply((a, b, c, d), rotation)
        return Pose((x + f * u, y + f * v, z + f * w), rotation)


class PosePredictor:
    """Predicts the poses of moving objects. Objects without a motion keep their own pose."""

    def __init__(self) -> None:
        self._tracks: dict[str, _Track] = {}
        self.blends_until = -np.inf
        """Time when all blending ends, and every object follows its velocity [s]."""

    def pose(self, item: Object, t: float) -> Pose:
        """Return the pose of `item` at time t [s]."""
        motion = item.motion
        if motion is None:
            return item.pose
        if not item.name:
            return motion.pose(item.pose, t)
        track = self._tracks.get(item.name)
        if track is not None and (track.item is item or track.item == item):
            return track.pose(t)
        if track is None:
            while len(self._tracks) >= MAX_OBJECTS:
                del self._tracks[next(iter(self._tracks))]
            made = _Track(item, t)
        else:
            made = self._start_blend(item, t, track.pose(t))
        self._tracks[item.name] = made
        return made.pose(t)

    def _start_blend(self, item: Object, t: float, was: Pose) -> _Track:
        assert item.motion is not None
        now = item.motion.pose(item.pose, t)
        d = np.array(was.position) - now.position
        if float(d @ d) > MAX_BLENDED_ERROR * MAX_BLENDED_ERROR:
            return _Track(item, t)
        x, y, z, w = now.rotation
        a, b, c, e = multiply(was.rotation, (-x, -y, -z, w))
        sign = 1.0 if e >= 0.0 else -1.0
        self.blends_until = max(self.blends_until, t + BLEND_TIME)
        u, v, s = d.tolist()
        return _Track(item, t, (u, v, s), (sign * a, sign * b, sign * c, sign * e))
