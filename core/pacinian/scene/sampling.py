"""From a scene to samples: where on the skin how much pressure is wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.checks import integer, length, number
from pacinian.scene.objects import Point, Volume
from pacinian.scene.shapes import Local
from pacinian.scene.solids import SDF

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.scene.objects import Object, Scene, Surface, Workspace
    from pacinian.types import Flags, Floats, Indices

COARSER = 2.0**0.25  # step of the spacing while a scene has more samples than the budget
KEPT = 1024  # coverings in their own frames that are kept
FINEST = 1e-4  # [m], a hundredth of a wavelength
NOTHING = Local(np.empty((0, 3)), np.empty((0, 3)))


@dataclass(frozen=True, eq=False)
class Samples:
    """M samples of a scene.

    positions: (M, 3) [m]. radiation_pressure: at full envelope, (M,) [Pa]. normals: (M, 3), zero for
    points. objects: index of each sample's object, (M,). spacing: [m]. culled: how many more lay
    outside of the workspace (an object that is wholly outside counts as one). dropped:
    how many more there was no budget for.
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
    _placed: dict[int, tuple[Object, float, Local]] = field(default_factory=dict, repr=False)
    _last: tuple[tuple[Scene, int, float], Samples] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        self.budget = integer("budget", self.budget, low=1)
        self.spacing = number("spacing", length("spacing", self.spacing), low=FINEST)

    def sample(self, scene: Scene) -> Samples:
        """Samples of `scene`; the same object as before for the same scene."""
        key = scene, self.budget, self.spacing
        if self._last is None or self._last[0] != key:
            self._last = key, self._sample(scene)
        return self._last[1]

    def _sample(self, scene: Scene) -> Samples:
        near = [item for item in scene.objects if _touches(item, scene.workspace)]
        spacing = self.spacing
        reaches = [item.shape.reach for item in near if not isinstance(item, Point)]
        largest = max(reaches, default=0.0)
        while _estimate(near, spacing) > 2.0 * self.budget and spacing < 2.0 * largest:
            spacing *= COARSER
        whole = self._whole(scene, spacing)
        while len(whole) > self.budget and spacing < 2.0 * largest:
            spacing *= COARSER
            whole = self._whole(scene, spacing)
        self._placed = {id(item): self._placed[id(item)] for item in near}
        over = len(whole) - self.budget
        if over <= 0:
            return whole
        kept = whole.only(np.arange(len(whole)) < self.budget)
        return replace(kept, culled=whole.culled, dropped=over)

    def _whole(self, scene: Scene, spacing: float) -> Samples:
        """All samples of a scene inside of its workspace."""
        parts = [
            self._part(item, spacing) if _touches(item, scene.workspace) else NOTHING
            for item in scene.objects
        ]
        counts = [len(part.points) for part in parts]
        samples = Samples(
            np.concatenate([NOTHING.points, *(part.points for part in parts)]),
            np.repeat(
                np.array([item.pressure for item in scene.objects], dtype=np.float64), counts
            ),
            np.concatenate([NOTHING.normals, *(part.normals for part in parts)]),
            np.repeat(np.arange(len(parts)), counts),
            spacing,
            culled=sum(part is NOTHING for part in parts),
        )
        if scene.workspace is None:
            return samples
        return samples.only(scene.workspace.holds(samples.positions))

    def _part(self, item: Object, spacing: float) -> Local:
        """Samples of an object in the world; those of the last scene are at hand."""
        kept = self._placed.get(id(item))
        if kept is not None and kept[0] is item and kept[1] == spacing:
            return kept[2]
        if isinstance(item, Point):
            part = Local(np.array([item.position]), np.zeros((1, 3)))
        else:
            local, R = self._cover(item, spacing), item.pose.matrix.T
            part = Local(local.points @ R + item.pose.position, local.normals @ R)
        self._placed[id(item)] = item, spacing, part
        return part

    def _cover(self, item: Surface | Volume, spacing: float) -> Local:
        key = (id(item.shape), getattr(item, "felt", ""), spacing)
        kept = self._covers.pop(key, None)
        if kept is None:
            while len(self._covers) >= KEPT:  # the one that was not used for longest
                del self._covers[next(iter(self._covers))]
            kept = item.shape, item.cover(spacing)  # the shape too: its id stays taken
        self._covers[key] = kept
        return kept[1]


def _touches(item: Object, workspace: Workspace | None) -> bool:
    """Whether any of an object may be inside of a workspace, by its bounding sphere."""
    if workspace is None or isinstance(item, Point):
        return True
    away = 0.0  # [m^2] from the box to the sphere's centre
    for x, low, high in zip(item.pose.position, workspace.lower, workspace.upper, strict=True):
        away += max(low - x, x - high, 0.0) ** 2
    return away <= item.shape.reach**2


def _estimate(items: list[Object], spacing: float) -> float:
    """About how many samples objects have, `spacing` [m] apart."""
    total = 0.0
    for item in items:
        if isinstance(item, Point):
            total += 1.0
        elif isinstance(item, Volume) and item.felt == "interior":
            total += max(1.0, 8.0 * math.prod(item.shape.extent) / spacing**3)
        else:
            area = _box_area(item.shape) if isinstance(item.shape, SDF) else item.shape.area
            total += max(1.0, area / spacing**2)
    return total


def _box_area(shape: SDF) -> float:
    x, y, z = shape.extent
    return 8.0 * (x * y + y * z + z * x)


def envelopes(objects: Sequence[Object], t: Floats) -> Floats:
    """Envelope of each object at times t [s], (K,): shape (objects, K); whatever it gives, in 0..1."""
    factors = np.empty((len(objects), len(t)))
    for row, item in zip(factors, objects, strict=True):
        row[:] = item.envelope.at(t)
    return np.asarray(np.fmin(np.fmax(factors, 0.0), 1.0))  # NaN is 0
