"""Measure the growth of a tick's time with the number of objects, of which three are in the hand's reach."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msgspec.structs import replace

from pacinian import gallery
from pacinian.acoustics.pose import Pose
from pacinian.skip_reasons import AWAY_FROM_HANDS
from pacinian_lab.scenes.savings import At, Side, take_turns

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.acoustics.array import Array
    from pacinian.scene.scene import Scene

COUNTS = (1, 10, 100, 1000, 10_000)
STEP = 0.001  # [m] amplitude of the replaced object's motion


@dataclass(frozen=True)
class Growth:
    """Median tick times [ms]: when only the hand moves, and when each tick also replaces an object.

    near: objects that pass the broad phase.
    """

    objects: int
    near: float
    still_ms: float
    replaced_ms: float

    def linear(self, first: Growth) -> float:
        """Return the growth from `first` relative to linear growth: 1 for fully linear."""
        return (self.still_ms / first.still_ms) / (self.objects / first.objects)


class Game:
    """A scene in which every tick replaces the last ball."""

    def __init__(self, objects: int) -> None:
        self._scene = gallery.balls(objects)
        self._last = self._scene.objects[-1]

    def __call__(self, t: float) -> Scene:
        """Return the scene at time t [s]."""
        x, y, z = self._last.pose.position
        at = Pose((x + STEP * math.sin(20.0 * math.pi * t), y, z))
        self._scene = self._scene.put(replace(self._last, pose=at))
        return self._scene.with_hands(*gallery.crowd(t).hands)


def measure(array: Array, ticks: int, counts: Sequence[int] = COUNTS) -> list[Growth]:
    """Measure `ticks` ticks of each count, in turn."""
    still = [Side(array, _add_crowd(gallery.balls(count))) for count in counts]
    games = [Side(array, Game(count)) for count in counts]
    take_turns([*still, *games], ticks)
    return [
        Growth(count, count - _count_far(one), one.median_ms, game.median_ms)
        for count, one, game in zip(counts, still, games, strict=True)
    ]


def _add_crowd(scene: Scene) -> At:
    return lambda t: scene.with_hands(*gallery.crowd(t).hands)


def _count_far(side: Side) -> float:
    report = side.renderer.report
    return report.skipped[AWAY_FROM_HANDS] / report.ticks
