"""From a scene to samples: where on the skin how much pressure is wanted."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.checks import integer, length
from pacinian.scene.objects import Point
from pacinian.scene.shapes import Local

if TYPE_CHECKING:
    from pacinian.scene.objects import Object, Scene, Surface, Volume
    from pacinian.types import Flags, Floats, Indices

COARSER = 2.0**0.25  # step of the spacing while a scene has more samples than the budget
KEPT = 512  # coverings in their own frames that are kept


@dataclass(frozen=True, eq=False)
class Samples:
    """M samples of a scene.

    positions: (M, 3) [m]. radiation_pressure: at full envelope, (M,) [Pa]. normals: (M, 3), zero for
    points. objects: index of each sample's object, (M,). spacing: [m]. culled: how many more lay
    outside of the workspace. dropped: how many more there was no budget for.
    """

    positions: Floats
    radiation_pressure: Floats
    normals: Floats
    objects: Indices
    spacing: float
    culled: int = 0
    dropped: int = 0

    def __len__(self) -> int:
        return len(self.positions)

    def only(self, kept: Flags) -> Samples:
        """Those samples where `kept`, (M,); the others count as culled."""
        return replace(
            self,
            positions=self.positions[kept],
            radiation_pressure=self.radiation_pressure[kept],
            normals=self.normals[kept],
            objects=self.objects[kept],
            culled=self.culled + int(len(kept) - kept.sum()),
        )


@dataclass
class Sampler:
    """Samples scenes; keeps how each shape is covered, so that a moved object costs a transform.

    budget: at most so many samples; where a scene has more, all its objects are covered more coarsely,
    and the points that are left over are dropped last in order. spacing: [m]; 8.5 mm, one wavelength,
    is about what an array can resolve. Raises ArgumentError.
    """

    budget: int = 256
    spacing: float = 0.0085
    _covers: dict[tuple[int, str, float], tuple[object, Local]] = field(
        default_factory=dict, repr=False
    )
    _last: tuple[Scene, Samples] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        integer("budget", self.budget, low=1)
        length("spacing", self.spacing)

    def sample(self, scene: Scene) -> Samples:
        """Samples of `scene`; the same object as before for the same scene."""
        if self._last is None or self._last[0] is not scene:
            self._last = scene, self._sample(scene)
        return self._last[1]

    def _sample(self, scene: Scene) -> Samples:
        spacing = self.spacing
        whole = self._whole(scene, spacing)
        spread = any(not isinstance(item, Point) for item in scene.objects)
        while spread and len(whole) > self.budget and spacing < 1.0:
            spacing *= COARSER
            whole = self._whole(scene, spacing)
        over = len(whole) - self.budget
        if over <= 0:
            return whole
        kept = whole.only(np.arange(len(whole)) < self.budget)
        return replace(kept, culled=whole.culled, dropped=over)

    def _whole(self, scene: Scene, spacing: float) -> Samples:
        """All samples of a scene inside of its workspace."""
        parts = [self._part(item, spacing) for item in scene.objects]
        counts = [len(part.points) for part in parts]
        samples = Samples(
            np.concatenate([np.empty((0, 3)), *(part.points for part in parts)]),
            np.repeat(np.array([item.pressure for item in scene.objects]), counts),
            np.concatenate([np.empty((0, 3)), *(part.normals for part in parts)]),
            np.repeat(np.arange(len(parts)), counts),
            spacing,
        )
        if scene.workspace is None:
            return samples
        return samples.only(scene.workspace.holds(samples.positions))

    def _part(self, item: Object, spacing: float) -> Local:
        """Samples of an object in the world."""
        if isinstance(item, Point):
            return Local(np.array([item.position]), np.zeros((1, 3)))
        local = self._cover(item, spacing)
        return Local(item.pose.points(local.points), item.pose.directions(local.normals))

    def _cover(self, item: Surface | Volume, spacing: float) -> Local:
        key = (id(item.shape), getattr(item, "felt", ""), spacing)
        if key not in self._covers:
            while len(self._covers) >= KEPT:
                del self._covers[next(iter(self._covers))]
            self._covers[key] = item.shape, item.cover(spacing)  # the shape too: its id stays taken
        return self._covers[key][1]


def envelopes(objects: tuple[Object, ...], t: Floats) -> Floats:
    """Envelope of each object at times t [s], (K,): shape (objects, K), in 0..1."""
    return np.array([item.envelope.at(t) for item in objects]).reshape(len(objects), len(t))
