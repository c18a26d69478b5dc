"""The recent frames: a modulated field is a sequence of frames, each of which shows only one instant."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from pacinian.wire.time import STEADY, Simultaneous

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.types import Singles
    from pacinian.wire.objects import Object

SPAN = 0.3  # time in which frames that repeat are found [s]
MODULATED_SPAN = 1.0  # averaging time of a modulation while nothing moves [s]
MOVING_SPAN = 0.12  # minimum averaging time while something moves [s]; a longer one would smear
MAX_FRAMES = 64  # maximum number of different frames that count
MAX_KEPT = 128  # maximum number of stored frames
STILL = 0.001  # movement of joints and objects that counts as none [m]
SIMULTANEOUS = "simultaneous"


class RecentFrames:
    """Collects the gains of frames, for the mean and the peak of the field.

    While something moves and nothing is modulated, only the newest frame counts, because it is the whole field.
    """

    def __init__(self) -> None:
        self._frames: deque[tuple[float, bytes]] = deque(maxlen=MAX_KEPT)
        self._modulated: dict[str, bool] = {}
        self._technique = SIMULTANEOUS
        self._hands: Singles = np.zeros(0, np.float32)
        self._poses: Singles = np.zeros(0, np.float32)
        self._moved = -np.inf  # time of the last movement [s]

    def clear(self) -> None:
        """Forget all frames, for another array or after an emergency stop or a fault."""
        self._frames.clear()

    def add(self, time: float, gains: bytes) -> None:
        """Add a frame that was emitted at `time` [s]. gains: (1, N) complex64; empty in silence."""
        if self._frames and time < self._frames[-1][0]:
            self._frames.clear()  # a recording jumped back
            self._moved = -np.inf
        self._frames.append((time, gains))

    def see_state(self, time: float, technique: str, hands: bytes) -> None:
        """Note the technique and the hands of a state. hands: joints, float32 [m]."""
        self._technique = technique or SIMULTANEOUS
        self._hands = self._compare(self._hands, np.frombuffer(hands, "<f4"), time)

    def see_scene(
        self, time: float, objects: Mapping[str, Object], poses: Mapping[str, bytes]
    ) -> None:
        """Note the objects of the scene. objects: new objects. poses: poses of all objects, float32."""
        self._modulated |= {name: is_modulated(item) for name, item in objects.items()}
        self._modulated = {name: self._modulated.get(name, False) for name in poses}
        joined = np.frombuffer(b"".join(poses.values()), "<f4")
        self._poses = self._compare(self._poses, joined, time)

    def gains(self) -> tuple[bytes, tuple[float, ...]]:
        """Return the gains of the frames that count, (K, N) complex64, newest last, and their shares of time, (K,).

        Without modulation, repeated frames form a cycle in which all have equal shares. If the newest frame has not
        occurred before, it is a transition and counts alone. With modulation, the share is how often the frame was
        seen. Empty in silence.
        """
        if not self._frames:
            return b"", ()
        newest = self._frames[-1][0]
        modulated = self._technique != SIMULTANEOUS or any(self._modulated.values())
        begin = max(newest - (MODULATED_SPAN if modulated else SPAN), self._moved)
        if modulated:
            begin = min(begin, newest - MOVING_SPAN)
        counts: dict[bytes, int] = {}  # newest first
        for time, gains in reversed(self._frames):
            known = gains in counts
            if counts and (time < begin or (len(counts) == MAX_FRAMES and not known)):
                break  # older frames would get too small a share
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
        """Return the new reference: `before` while all of `now` is within `STILL` of it, else `now`."""
        if len(before) == len(now) and (not len(now) or np.abs(now - before).max() <= STILL):
            return before
        self._moved = time
        return now


def is_modulated(item: Object) -> bool:
    """Whether an object's pressure varies in time by its own envelope or technique."""
    return item.envelope != STEADY or not isinstance(item.technique, Simultaneous | None)
