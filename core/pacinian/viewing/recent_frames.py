"""The frames of the last moments: a modulated field is many frames in turn, and each alone shows one instant of it."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from pacinian.wire.time import STEADY, Simultaneous

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.types import Singles
    from pacinian.wire.objects import Object

SPAN = 0.3  # [s] of frames that make up a cycle
MODULATED_SPAN = 1.0  # [s] of frames of which a modulation's mean is made, while nothing moves
MOVING_SPAN = 0.12  # [s] the same, while something moves: a longer mean would smear it
MAX_FRAMES = 64  # that differ
MAX_KEPT = 128
STILL = 0.001  # [m] that joints and objects may move, and count as still
SIMULTANEOUS = "simultaneous"


class RecentFrames:
    """Collects the gains of frames, for the mean and the peak of the field over them.

    While something moves and nothing is modulated, only the newest frame counts: then it is the whole field.
    """

    def __init__(self) -> None:
        self._frames: deque[tuple[float, bytes]] = deque(maxlen=MAX_KEPT)
        self._modulated: dict[str, bool] = {}
        self._technique = SIMULTANEOUS
        self._hands: Singles = np.zeros(0, np.float32)
        self._poses: Singles = np.zeros(0, np.float32)
        self._moved = -np.inf  # [s] when something moved last

    def clear(self) -> None:
        """Forget all frames: there is another array, or silence by command."""
        self._frames.clear()

    def add(self, time: float, gains: bytes) -> None:
        """A frame that was emitted at `time` [s]. gains: (1, N) complex64; empty in silence."""
        if self._frames and time < self._frames[-1][0]:
            self._frames.clear()  # a recording that goes back
            self._moved = -np.inf
        self._frames.append((time, gains))

    def see_state(self, time: float, technique: str, hands: bytes) -> None:
        """What a state says. hands: joints, float32 [m]."""
        self._technique = technique or SIMULTANEOUS
        self._hands = self._compare(self._hands, np.frombuffer(hands, "<f4"), time)

    def see_scene(
        self, time: float, objects: Mapping[str, Object], poses: Mapping[str, bytes]
    ) -> None:
        """What the scene has. objects: those that are new. poses: of all, float32."""
        self._modulated |= {name: is_modulated(item) for name, item in objects.items()}
        self._modulated = {name: self._modulated.get(name, False) for name in poses}
        joined = np.frombuffer(b"".join(poses.values()), "<f4")
        self._poses = self._compare(self._poses, joined, time)

    def gains(self) -> tuple[bytes, tuple[float, ...]]:
        """Of the frames that count, (K, N) complex64, the newest last, and the share of the time of each, (K,).

        Without modulation, frames that come again are a cycle, in which each has the same share; one that has not come
        before is on the way to another, and alone. With modulation, the shares are how often each was seen. Empty in
        silence.
        """
        if not self._frames:
            return b"", ()
        newest = self._frames[-1][0]
        modulated = self._technique != SIMULTANEOUS or any(self._modulated.values())
        begin = max(newest - (MODULATED_SPAN if modulated else SPAN), self._moved)
        if modulated:
            begin = min(begin, newest - MOVING_SPAN)
        counts: dict[bytes, int] = {}  # the newest first
        for time, gains in reversed(self._frames):
            known = gains in counts
            if counts and (time < begin or (len(counts) == MAX_FRAMES and not known)):
                break  # older ones would have less than their share
            counts[gains] = counts.get(gains, 0) + 1
        if not modulated:
            last = self._frames[-1][1]
            again = {gains: count for gains, count in counts.items() if gains and count > 1}
            counts = again if last in again else {last: 1}
        size = max(map(len, counts))
        if not size:
            return b"", ()
        chosen = {g: count for g, count in reversed(counts.items()) if len(g) in (0, size)}
        total = sum(chosen.values()) if modulated else len(chosen)
        shares = tuple((count if modulated else 1) / total for count in chosen.values())
        return b"".join(gains or bytes(size) for gains in chosen), shares

    def _compare(self, before: Singles, now: Singles, time: float) -> Singles:
        """The new reference: `before` while all of `now` is within `STILL` of it."""
        if len(before) == len(now) and (not len(now) or np.abs(now - before).max() <= STILL):
            return before
        self._moved = time
        return now


def is_modulated(item: Object) -> bool:
    """Whether an object's pressure varies in time by its own envelope or technique."""
    return item.envelope != STEADY or not isinstance(item.technique, Simultaneous | None)
