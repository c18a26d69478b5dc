"""Predict hands between updates, blend in each update without a jump, and hold, then fade, a hand that is lost.

Velocities come from the client.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.sampling.pose_prediction import (
    BLEND_TIME,
    MAX_BLENDED_ERROR,
    compute_blend_factor,
)
from pacinian.scene.sampling.posed_skin import PosedSkin

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin import Skin
    from pacinian.types import Floats

HOLD_TIME = 0.05  # time for which a lost hand stays [s]
LOST_HAND_FADE_TIME = 0.1  # time in which it then fades [s]
# A blended hand at most this far from where it was seen counts as being there [m]
MAX_IGNORED_DISTANCE = 5e-4


def is_gone(hand: Hand, t: float) -> bool:
    """Return whether a hand that is new at time t [s] is not there: it is lost, or was measured too long ago."""
    return hand.lost or (hand.time is not None and t - hand.time >= HOLD_TIME + LOST_HAND_FADE_TIME)


def extrapolate_seen(hand: Hand, t: float) -> Hand:
    """Return a hand at time t [s], extrapolated by its velocities for at most `HOLD_TIME` after it was measured."""
    if hand.time is None or hand.velocities is None:
        return hand
    return hand.extrapolate(min(max(t - hand.time, 0.0), HOLD_TIME))


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
        self._posed_skin: PosedSkin | None = None

    def update(self, hand: Hand, t: float, ahead: float = 0.0) -> tuple[Hand | None, float]:
        """Return the hand at time t [s], or None if it is gone, and the factor on its pressures, 0..1.

        A hand that returns counts fully at once; ramps.py makes it rise. hand: its newest update, or the same one as in
        the last call. ahead: how far t lies in the future, in which nobody can have seen the hand yet [s].
        """
        if hand is not self._given and not (self._given is not None and hand.same(self._given)):
            before, self._given = self._given, hand
            if not hand.lost:
                self._accept_update(hand, t)
            elif before is not None and before is self._last and before.time is None:
                self._seen = t  # a hand without a time counts as seen until it is lost
        last = self._last
        if last is None:
            return None, 0.0
        self._seen, self._since = min(self._seen, t), min(self._since, t)  # time may jump back
        late = 0.0 if hand.time is None and not hand.lost else t - ahead - self._seen - HOLD_TIME
        share = min(1.0, 1.0 - late / LOST_HAND_FADE_TIME)
        if share <= 0.0:
            self._last = None
            return None, 0.0
        return self._blend_hand(last, t), share

    def pose_skin(self, hand: Hand) -> PosedSkin:
        """Return the posed skin of a hand from `update`; the previous one if the hand has not moved."""
        before = self._posed_skin
        if before is not None and before.hand is hand:
            return before
        same = before is not None and before.hand.faces is hand.faces
        self._posed_skin = PosedSkin(hand, before.skin if before and same else self._skin)
        return self._posed_skin

    def pose_seen(self, skin: PosedSkin, t: float) -> PosedSkin:
        """Return the skin where the last update puts it at time t [s], without the blend. skin: from `pose_skin`."""
        f = compute_blend_factor(self._since, t)
        d = self._offset
        if (
            d is None
            or self._last is None
            or f * f * (d * d).sum(axis=1).max() < MAX_IGNORED_DISTANCE * MAX_IGNORED_DISTANCE
        ):
            return skin
        return PosedSkin(extrapolate_seen(self._last, t), skin.skin)

    def can_move(self, t: float) -> bool:
        """Return whether the hand may move or fade after time t [s] without an update."""
        if self._last is None:
            return False
        given = self._given
        timed = given is not None and (given.lost or given.time is not None)
        return timed or (self._offset is not None and t < self._since + BLEND_TIME)

    def _accept_update(self, hand: Hand, t: float) -> None:
        """Accept a new update of a hand that is not lost."""
        was = None if self._last is None else self._blend_hand(self._last, t)
        self._seen = t if hand.time is None else hand.time
        self._last, self._offset = hand, None
        if was is None or was.carriers.shape != hand.carriers.shape:
            return
        d = was.carriers - extrapolate_seen(hand, t).carriers
        if float((d * d).sum(axis=1).max()) <= MAX_BLENDED_ERROR * MAX_BLENDED_ERROR and d.any():
            self._offset, self._since = d, t

    def _blend_hand(self, hand: Hand, t: float) -> Hand:
        now = extrapolate_seen(hand, t)
        f = compute_blend_factor(self._since, t)
        if self._offset is None or f <= 0.0:
            self._offset = None
            return now
        return now.translate(f * self._offset)
