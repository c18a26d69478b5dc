"""Sources of samples: whole objects, and points, paths and particles that touch a hand. For bodies see `contact`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.region_numbers import BESIDE, ISOLATED
from pacinian.scene.objects import Body, Volume
from pacinian.scene.sampling.array_resolution import weigh_incidence
from pacinian.scene.sampling.sample_keys import make_keys
from pacinian.scene.sampling.samples import Samples
from pacinian.scene.shapes.sphere_capsule import Sphere
from pacinian.scene.shapes.texture import apply_texture

if TYPE_CHECKING:
    from pacinian.scene.haptic_object import HapticObject
    from pacinian.scene.objects import Object, Particles, Path, Point
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.sample_cache import SampleCache


UNTURNED = np.zeros((1, 3))
LONE = np.array([ISOLATED])
UNTURNED.flags.writeable = LONE.flags.writeable = False


class SampleSource(Protocol):
    """Makes samples at a given spacing."""

    @property
    def item(self) -> Object:
        """The object that is sampled."""
        ...

    @property
    def index(self) -> int:
        """Index of the object in the scene."""
        ...

    @property
    def place(self) -> tuple[float, float, float]:
        """Where it is, roughly: the object's own place, or the middle of the hand that touches it, (3,) [m]."""
        ...

    @property
    def faint(self) -> int:
        """Number of samples that the last call of `at` left out because they are too faint to feel."""
        ...

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        ...


@dataclass
class WholeObject:
    """An object rendered whole, without a hand. index: in the scene. name: number that goes into its samples' keys."""

    item: Object
    index: int
    name: int
    pose: Pose
    covers: SampleCache
    items: tuple[Object, ...]
    faint: int = 0

    @property
    def place(self) -> tuple[float, float, float]:
        """See `SampleSource`."""
        return self.item.pose.position

    @property
    def textured(self) -> bool:
        """Whether a texture presses some samples less, or not at all."""
        return getattr(self.item, "texture", None) is not None

    def count(self, spacing: float) -> int:
        """Return the number of samples about `spacing` [m] apart; 0 if they do not press."""
        return len(self.covers.get(self.item, spacing).points) if self.item.pressure > 0.0 else 0

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        item, pose = self.item, self.pose
        if forms_region(item):
            local, factor, silent = self.covers.get_textured(item, spacing)
        else:
            local = self.covers.get(item, spacing)
            factor, silent = np.ones(len(local.points)), np.zeros(len(local.points), np.bool_)
            apply_texture(getattr(item, "texture", None), local.points, factor)
        if isinstance(getattr(item, "shape", None), Sphere) and not self.textured:
            pose = Pose(pose.position)  # a ball that rolls presses like one that moves as one
        K, R = len(local.points), pose.matrix.T
        normals = local.normals @ R if local.normals.any() else local.normals
        regions = np.where(silent, BESIDE, number_region(item, self.name))
        return Samples(
            local.points @ R + self.pose.position, factor * item.pressure, normals, local.area,
            np.full(K, self.index), make_keys(self.name, _apart(item, spacing), np.arange(K)),
            np.full(K, item.pressure), regions, self.items,
        )  # fmt: skip


class SinglePoint(WholeObject):
    """A point without a hand. Takes a fifth of the time of `WholeObject`, because scenes have many moving points."""

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        item = cast("Point", self.item)
        P = np.array([item.pressure])
        return Samples(
            np.array([self.pose.position]), P, UNTURNED, np.array([item.area]),
            np.array([self.index]), np.array([self.name << 31]), P, LONE, self.items,
        )  # fmt: skip


@dataclass
class PointContacts:
    """Points, paths and particles that touch a hand. Each sample lies on the nearest point of the skin."""

    item: Point | Path | Particles
    index: int
    name: int
    pose: Pose
    covers: SampleCache
    items: tuple[Object, ...]
    hand: PosedSkin
    share: float
    resolving: ArrayResolution | None
    least: float
    faint: int = 0

    @property
    def place(self) -> tuple[float, float, float]:
        """See `SampleSource`."""
        return self.hand.centre

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        item = self.item
        local = self.covers.get(item, spacing)
        points = local.points @ self.pose.matrix.T + self.pose.position
        reach = item.radius + item.material.reach
        near = self.hand.about(points, reach)
        on, normals, d = self.hand.closest(points[near])
        depth = reach - np.maximum(d, 0.0)  # full depth for points inside the hand
        P = self.share * item.material.pressure(depth, item.pressure)
        if self.resolving is not None and P.any():
            P *= weigh_incidence(self.resolving.compute_incidence(on, normals))
        kept = np.flatnonzero((P > 0.0) & (self.least <= P))
        self.faint = int((P > 0.0).sum()) - len(kept)
        return Samples(
            on[kept], P[kept], normals[kept], local.area[near[kept]],
            np.full(len(kept), self.index), make_keys(self.name, _apart(item, spacing), near[kept]),
            np.full(len(kept), item.pressure), np.full(len(kept), ISOLATED),
            self.items, self.hand.capsules,
        )  # fmt: skip


def _apart(item: Object, spacing: float) -> float:
    return spacing if hasattr(item, "shape") else 0.0


def forms_region(item: HapticObject) -> bool:
    """Return whether an object's samples form a region: one surface, all of which sounds at once."""
    return isinstance(item, Body) and not is_sequential(item)


def lacks_surface(item: HapticObject) -> bool:
    """Whether an object is a volume whose shape has no surface, such as an intersection of solids that do not meet."""
    return isinstance(item, Volume) and not item.shape.area > 0.0


def number_region(item: HapticObject, name: int) -> int:
    """Return the region number of an object's samples: the object's number `name`, or -1 if they are isolated."""
    return name if forms_region(item) else ISOLATED


def is_sequential(item: HapticObject) -> bool:
    """Return whether an object's samples sound one at a time, so that many of them cost little."""
    return bool(getattr(item.technique, "single", False))
