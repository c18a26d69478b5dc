"""How a tick's time grows with the number of objects, of which three are in the hand's reach."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msgspec.structs import replace

from pacinian import gallery
from pacinian.acoustics.pose import Pose
from pacinian_lab.scenes.savings import At, Side, take_turns

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.acoustics.array import Array
    from pacinian.scene.scene import Scene

COUNTS = (1, 10, 100, 1000, 10_000)
STEP = 0.001  # [m] by which one moves to and fro


@dataclass(frozen=True)
class Growth:
    """Median tick times [ms]: where only the hand moves, and where an object is replaced in each tick too.

    near: objects that the broad phase lets through.
    """

    objects: int
    near: float
    still_ms: float
    replaced_ms: float

    def linear(self, first: Growth) -> float:
        """How much of linear growth from `first` there is: 1 for all."""
        return (self.still_ms / first.still_ms) / (self.objects / first.objects)


class Game:
    """Puts another ball in the place of the last in every tick."""

    def __init__(self, objects: int) -> None:
        self._scene = gallery.balls(objects)
        self._last = self._scene.objects[-1]

    def __call__(self, t: float) -> Scene:
        """The scene at time t [s]."""
        x, y, z = self._last.pose.position
        at = Pose((x + STEP * math.sin(20.0 * math.pi * t), y, z))
        self._scene = self._scene.put(replace(self._last, pose=at))
        return self._scene.held(*gallery.crowd(t).hands)


def measure(array: Array, ticks: int, counts: Sequence[int] = COUNTS) -> list[Growth]:
    """So many ticks of each, in turn."""
    still = [Side(array, _held(gallery.balls(count))) for count in counts]
    games = [Side(array, Game(count)) for count in counts]
    take_turns([*still, *games], ticks)
    return [
        Growth(count, count - _far(one), one.median_ms, game.median_ms)
        for count, one, game in zip(counts, still, games, strict=True)
    ]


def _held(scene: Scene) -> At:
    return lambda t: scene.held(*gallery.crowd(t).hands)


def _far(side: Side) -> float:
    report = side.renderer.report
    return report.skipped["objects out of reach"] / report.ticks
