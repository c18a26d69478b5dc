"""The recent frames: a modulated field is a sequence of frames, each of which shows only one instant."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.viewing.time_shares import Modulation, find_mean_strength, share_time
from pacinian.wire.modulation import Constant

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from pacinian.types import Floats, Singles
    from pacinian.wire.modulation import Technique
    from pacinian.wire.objects import Object

CYCLE_SPAN = 0.3  # time in which the frames of a cycle are looked for [s]
MODULATED_SPAN = 1.0  # averaging time of a modulation while nothing moves [s]
MOVING_SPAN = 0.12  # minimum averaging time while something moves [s]; a longer one would smear
MAX_FRAMES = 64  # maximum number of frames that count
MAX_KEPT = 128  # maximum number of stored frames
STILL = 0.001  # movement of joints and objects that counts as none [m]
SIMULTANEOUS = "simultaneous"


class Emitted(NamedTuple):
    """A frame that was emitted: when [s], and its gains, (1, N) complex64; empty in silence.

    scene_time, part, parts: as in `FrameState`.
    """

    time: float
    gains: bytes
    scene_time: float
    part: int
    parts: int


class RecentFrames:
    """Collects the gains of frames, for the mean and the peak of the field.

    While something moves and nothing is modulated, only the newest frame of each part of a cycle counts, because these
    are the whole field.
    """

    def __init__(self) -> None:
        self._frames: deque[Emitted] = deque(maxlen=MAX_KEPT)
        self._modulations: dict[str, Modulation] = {}
        self._technique = SIMULTANEOUS
        self._presentation: Technique | None = None
        self._hands: Singles = np.zeros(0, np.float32)
        self._poses: Singles = np.zeros(0, np.float32)
        self._moved = -np.inf  # time of the last movement [s]

    def clear(self) -> None:
        """Forget all frames, for another array or after an emergency stop or a fault."""
        self._frames.clear()

    def add(
        self, time: float, gains: bytes, scene_time: float = 0.0, part: int = 0, parts: int = 0
    ) -> None:
        """Add a frame that was emitted. Arguments as in `Emitted`."""
        if self._frames and time < self._frames[-1].time:
            self._frames.clear()  # a recording jumped back
            self._moved = -np.inf
        self._frames.append(Emitted(time, gains, scene_time, part, parts))

    def see_state(
        self, time: float, technique: str, hands: bytes, presentation: Technique | None = None
    ) -> None:
        """Note the technique and the hands of a state. hands: joints, float32 [m]."""
        self._technique, self._presentation = technique or SIMULTANEOUS, presentation
        self._hands = self._compare(self._hands, np.frombuffer(hands, "<f4"), time)

    def see_scene(
        self, time: float, objects: Mapping[str, Object], poses: Mapping[str, bytes]
    ) -> None:
        """Note the objects of the scene. objects: new objects. poses: poses of all objects, float32."""
        known = self._modulations | {name: Modulation.of(item) for name, item in objects.items()}
        self._modulations = {name: known[name] for name in poses if name in known}
        joined = np.frombuffer(b"".join(poses.values()), "<f4")
        self._poses = self._compare(self._poses, joined, time)

    def gains(self) -> tuple[bytes, tuple[float, ...]]:
        """Return the gains of the frames that count, (K, N) complex64, newest last, and their shares of time, (K,).

        Empty in silence.
        """
        if not self._frames:
            return b"", ()
        chosen = self._modulated() if self._is_modulated() else self._cycle()
        size = max(map(len, chosen))
        if not size:
            return b"", ()
        chosen = {gains: share for gains, share in chosen.items() if len(gains) in (0, size)}
        total = sum(chosen.values())
        rows = (gains or bytes(size) for gains in reversed(chosen))
        return b"".join(rows), tuple(share / total for share in reversed(chosen.values()))

    def find_strengths(self, names: Iterable[str]) -> Floats:
        """Return the mean strength of each object over its modulation, 0..1; 1 if it is not known."""
        times = np.array([frame.scene_time for frame in self._frames if frame.scene_time])
        constant = Modulation(Constant())
        found = (self._present(self._modulations.get(name, constant)) for name in names)
        return np.array([find_mean_strength(each, times) for each in found])

    def _present(self, modulation: Modulation) -> Modulation:
        """Give an object that has no technique of its own the server's."""
        if modulation.technique:
            return modulation
        return modulation._replace(technique=self._presentation)

    def _is_modulated(self) -> bool:
        own = (not modulation.steady for modulation in self._modulations.values())
        return self._technique != SIMULTANEOUS or any(own)

    def _modulated(self) -> dict[bytes, float]:
        """Return the share of time of each frame of a modulation, newest first."""
        newest = self._frames[-1].time
        begin = max(newest - MODULATED_SPAN, min(self._moved, newest - MOVING_SPAN))
        seen: list[Emitted] = []
        different: set[bytes] = set()
        for frame in reversed(self._frames):
            if seen and (frame.time < begin or len(different | {frame.gains}) > MAX_FRAMES):
                break  # older frames would get too small a share
            seen.append(frame)
            different.add(frame.gains)
        shares = self._share(seen)
        found: dict[bytes, float] = {}
        for frame, share in zip(seen, shares, strict=True):
            found[frame.gains] = found.get(frame.gains, 0.0) + share
        return found

    def _share(self, frames: list[Emitted]) -> list[float]:
        """Return the share of time of each frame: equal ones if their times in the scene are not known."""
        times = np.array([frame.scene_time for frame in frames])
        known = (
            all(frame.parts or frame.scene_time for frame in frames) and np.isfinite(times).all()
        )
        if not known or np.ptp(times) > 2.0 * MODULATED_SPAN:  # the scene has begun anew
            return [1.0 / len(frames)] * len(frames)
        modulations = {self._present(modulation) for modulation in self._modulations.values()}
        shares = share_time(times, modulations, np.array([frame.part for frame in frames]))
        return list(shares.tolist())

    def _cycle(self) -> dict[bytes, float]:
        """Return the frames of the cycle with equal shares, newest first.

        If it is not known which frame is which part, frames that repeat form a cycle. A frame that has not occurred
        before is then a transition, and counts alone.
        """
        newest = self._frames[-1]
        recent = [
            frame for frame in reversed(self._frames) if frame.time >= newest.time - CYCLE_SPAN
        ]
        if newest.parts:
            parts: dict[int, bytes] = {}
            for frame in recent:
                if frame.parts == newest.parts and bool(frame.gains) == bool(newest.gains):
                    parts.setdefault(frame.part, frame.gains)
            return dict.fromkeys(parts.values(), 1.0)
        counts: dict[bytes, int] = {}
        for frame in recent:
            if frame.time >= self._moved or frame is newest:
                counts[frame.gains] = counts.get(frame.gains, 0) + 1
        again = [gains for gains, count in counts.items() if gains and count > 1]
        return dict.fromkeys(again if newest.gains in again else [newest.gains], 1.0)

    def _compare(self, before: Singles, now: Singles, time: float) -> Singles:
        """Return the new reference: `before` while all of `now` is within `STILL` of it, else `now`."""
        if len(before) == len(now) and (not len(now) or np.abs(now - before).max() <= STILL):
            return before
        self._moved = time
        return now
