"""Predict the poses of objects and hands between updates, and blend in each update without a jump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pose import UPRIGHT, Pose, Quaternion, Vector, multiply
from pacinian.scene.sampling.posed_skin import PosedSkin

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin import Skin
    from pacinian.scene.objects import Object
    from pacinian.types import Floats

BLEND = 0.01  # time in which the prediction error of an update is blended out [s]
JUMP = 0.05  # a larger prediction error is a teleport, which is not blended [m]
HOLD, FADE = 0.05, 0.1  # a lost hand stays for HOLD, and then fades within FADE [s]
MAX_OBJECTS = 4096  # largest number of tracked objects


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
        f = 1.0 - (t - self.since) / BLEND
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
        if float(d @ d) > JUMP * JUMP:
            return _Track(item, t)
        x, y, z, w = now.rotation
        a, b, c, e = multiply(was.rotation, (-x, -y, -z, w))
        sign = 1.0 if e >= 0.0 else -1.0
        self.blends_until = max(self.blends_until, t + BLEND)
        u, v, s = d.tolist()
        return _Track(item, t, (u, v, s), (sign * a, sign * b, sign * c, sign * e))


class HandTrack:
    """Predicts one hand between updates. A lost or late hand is held in place, and then fades.

    skin: replaces the default skin of this kind of hand.
    """

    def __init__(self, skin: Skin | None = None) -> None:
        self._skin = skin
        self._given: Hand | None = None
        self._last: Hand | None = None  # the last update that was not lost
        self._seen = -np.inf
        self._offset: Floats | None = None
        self._since = 0.0
        self._touchable: PosedSkin | None = None

    def at(self, hand: Hand, t: float, ahead: float = 0.0) -> tuple[Hand | None, float]:
        """Return the hand at time t [s], or None if it is gone, and the factor on its pressures, 0..1.

        ahead: how far t lies in the future, in which nobody can have seen the hand yet [s].
        """
        if hand is not self._given and not (self._given is not None and hand.same(self._given)):
            before, self._given = self._given, hand
            if not hand.lost:
                self._take(hand, t)
            elif before is not None and before is self._last and before.time is None:
                self._seen = t  # a hand without a time counts as seen until it is lost
        last = self._last
        if last is None:
            return None, 0.0
        self._seen, self._since = min(self._seen, t), min(self._since, t)  # time may jump back
        late = 0.0 if hand.time is None and not hand.lost else t - ahead - self._seen - HOLD
        share = min(1.0, 1.0 - late / FADE)
        if share <= 0.0:
            self._last = None
            return None, 0.0
        return self._blend_hand(last, t), share

    def pose_skin(self, hand: Hand) -> PosedSkin:
        """Return the posed skin of a hand from `at`; the previous one if the hand has not moved."""
        if self._touchable is None or self._touchable.hand is not hand:
            kind = self._touchable
            same = kind is not None and kind.hand.faces is hand.faces
            self._touchable = PosedSkin(hand, kind.skin if kind and same else self._skin)
        return self._touchable

    def can_move(self, t: float) -> bool:
        """Return whether the hand may move or fade after time t [s] without an update."""
        if self._last is None:
            return False
        given = self._given
        timed = given is not None and (given.lost or given.time is not None)
        return timed or (self._offset is not None and t < self._since + BLEND)

    def _take(self, hand: Hand, t: float) -> None:
        """Accept a new update of a hand that is not lost."""
        was = None if self._last is None else self._blend_hand(self._last, t)
        self._seen = t if hand.time is None else hand.time
        self._last, self._offset = hand, None
        if was is None or was.carriers.shape != hand.carriers.shape:
            return
        d = was.carriers - self._extrapolate(hand, t).carriers
        if float((d * d).sum(axis=1).max()) <= JUMP * JUMP and d.any():
            self._offset, self._since = d, t

    def _extrapolate(self, hand: Hand, t: float) -> Hand:
        if hand.time is None or hand.velocities is None:
            return hand
        return hand.extrapolate(min(max(t - hand.time, 0.0), HOLD))

    def _blend_hand(self, hand: Hand, t: float) -> Hand:
        now = self._extrapolate(hand, t)
        f = 1.0 - (t - self._since) / BLEND
        if self._offset is None or f <= 0.0:
            self._offset = None
            return now
        return now.translate(f * self._offset)
