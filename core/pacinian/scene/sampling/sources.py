"""Sources of samples: whole objects, and the parts of objects that a hand touches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from pacinian.native.scene import press_on
from pacinian.scene.hands.skin_lod import FINEST as FINEST_OF_SKIN
from pacinian.scene.objects import Body
from pacinian.scene.sampling.array_resolution import weigh_incidence
from pacinian.scene.sampling.samples import ISOLATED, Samples
from pacinian.scene.setup import FINEST

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.pose import Pose
    from pacinian.scene.haptic_object import HapticObject
    from pacinian.scene.objects import Object, Particles, Path, Point, Surface, Volume
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.distance_cache import DistanceCache
    from pacinian.scene.sampling.posed_skin import FineSkin, PosedSkin
    from pacinian.scene.sampling.sample_cache import SampleCache
    from pacinian.types import Floats, Indices, Longs


ANYWHERE = np.empty((0, 3))
UNTURNED = np.zeros((1, 3))
LONE = np.array([ISOLATED])
UNTURNED.flags.writeable = LONE.flags.writeable = False


class Source(Protocol):
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
        """See `Source`."""
        return self.item.pose.position

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        item = self.item
        local, R = self.covers.get(item, spacing), self.pose.matrix.T
        K = len(local.points)
        normals = local.normals @ R if local.normals.any() else local.normals
        P = np.full(K, item.pressure)
        if (texture := getattr(item, "texture", None)) is not None:
            P *= texture.at(local.points)
        return Samples(
            local.points @ R + self.pose.position, P, normals, local.area,
            np.full(K, self.index), make_keys(self.name, _apart(item, spacing), np.arange(K)),
            np.full(K, item.pressure), np.full(K, number_region(item, self.name)), self.items,
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
        """See `Source`."""
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


@dataclass
class Contact:
    """The part of a hand's skin that is inside a surface or a volume, or within reach of it.

    touched: indices of the skin's points. force: on each of them [N]. finely: presses the points of a level between
    these. fine: largest spacing at which each sample presses as the material does there [m]. At a coarser spacing, the
    force of each point is distributed among the nodes of one level of detail of the skin. This keeps the total, and
    nothing jumps as the contact moves. least: pressure below which nobody feels a sample [Pa]. faint: number of nodes
    left out for that reason.
    """

    item: Surface | Volume
    index: int
    name: int
    hand: PosedSkin
    items: tuple[Object, ...]
    touched: Indices
    force: Floats
    least: float
    finely: Callable[[int], tuple[FineSkin, Indices, Floats]]
    fine: float = 0.0
    faint: int = 0

    @property
    def place(self) -> tuple[float, float, float]:
        """See `Source`."""
        return self.hand.centre

    @property
    def extent(self) -> float:
        """Area of the touched skin [m^2]."""
        return float(self.hand.area[self.touched].sum())

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        hand, of, skin = self.hand, None, (self.hand.points, self.hand.normals)
        level = hand.find_fine_level(spacing) if spacing <= self.fine else None
        if level is not None:
            of, nodes, force = self.finely(level)
            area, skin = of.area[nodes], (of.points, of.normals)
        else:
            among = hand.thin_forces if spacing <= self.fine else hand.share_forces
            nodes, force, area = among(self.touched, self.force, spacing)
        K = len(nodes)
        P, extent, keys = np.empty(K), np.empty(K), np.empty(K, np.int64)
        points, normals = np.empty((K, 3)), np.empty((K, 3))
        kept = press_on(
            nodes, force, area, self.least, *skin, self.name, P, extent, points, normals, keys
        )
        self.faint = int(np.count_nonzero(force)) - int(np.count_nonzero(P[:kept]))
        if of is not None:
            number = self.name << 31
            keys[:kept] = number + of.which[keys[:kept] - number]
        return Samples(
            points[:kept], P[:kept], normals[:kept], extent[:kept], np.full(kept, self.index),
            keys[:kept], np.full(kept, self.item.pressure),
            np.full(kept, number_region(self.item, self.name)), self.items, hand.capsules,
        )  # fmt: skip


def find_contact(
    item: Surface | Volume, pose: Pose, index: int, name: int, hand: PosedSkin,
    items: tuple[Object, ...], share: float, least: float, resolving: ArrayResolution | None, distances: DistanceCache,
) -> Contact | None:  # fmt: skip
    """Find the skin that touches `item`, and its forces, which follow the material's law along the skin's normal.

    share: factor on the pressure, 0..1. least: pressure below which nobody feels a sample [Pa]. resolving: resolution
    and visibility of the array; skin that the array hardly sees is pressed less. Returns None without a contact.
    """
    material, most = item.material, item.pressure
    reach = material.reach
    corners = ANYWHERE if resolving is None else resolving.corners
    which, local = hand.find_near(pose, item.bounding_radius + reach, corners)
    if not len(which):
        return None
    d = distances.of(item, name, hand, which, local, reach, material.enough(most))
    some = ANYWHERE if resolving is None else resolving.some
    inside, force = hand.find_pressed(which, d, reach, material.per_metre(most), most, some)
    if not len(inside):
        return None

    def change(local: Floats, force: Floats) -> None:
        """Change forces as the texture, and the share that sounds, demand."""
        if item.texture is not None:
            force *= item.texture.at(local)
        if share < 1.0:
            force *= share

    change(local[inside], force)
    if item.texture is not None and not force.any():
        return None

    def finely(level: int) -> tuple[FineSkin, Indices, Floats]:
        fine = hand.refine(which[d < reach + FINEST_OF_SKIN], level)
        at = (fine.points - pose.position) @ pose.matrix
        apart = distances.of(item, name, hand, fine.which, at, reach, material.enough(most))
        nodes, force = hand.press_finely(fine, apart, reach, material.per_metre(most), most, some)
        change(at[nodes], force)
        return fine, nodes, force

    return Contact(item, index, name, hand, items, which[inside], force, least, finely)


def make_keys(name: int, spacing: float, which: Indices) -> Longs:
    """Return the keys of samples, (K,), made of an object's number, the spacing and each sample's index.

    name: number of the object. spacing: [m]; 0 if the samples are the same at all spacings. which: indices, (K,).
    """
    level = 1 + round(2.0 * math.log2(spacing / FINEST)) if spacing else 0
    return (name << 31) + (level << 25) + which.astype(np.int64)


def _apart(item: Object, spacing: float) -> float:
    return spacing if hasattr(item, "shape") else 0.0


def is_dense(item: HapticObject) -> bool:
    """Return whether an object's samples form a region: one surface, all of which sounds at once."""
    return isinstance(item, Body) and not measure_spacing(item)


def number_region(item: HapticObject, name: int) -> int:
    """Return the region number of an object's samples: the object's number `name`, or -1 if they are isolated."""
    return name if is_dense(item) else ISOLATED


def measure_spacing(item: HapticObject) -> bool:
    """Return whether an object's samples sound one at a time, so that many of them cost little."""
    return bool(getattr(item.technique, "single", False))
