"""Where samples come from: an object as a whole, or what of it a hand touches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from pacinian.scene.objects import Body
from pacinian.scene.sampling.array_resolution import grazing
from pacinian.scene.sampling.samples import ISOLATED, Samples

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Pose
    from pacinian.scene.haptic_object import HapticObject
    from pacinian.scene.objects import Object, Particles, Path, Point, Surface, Volume
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.distance_cache import DistanceCache
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.sample_cache import SampleCache
    from pacinian.types import Floats, Indices, Longs


ANYWHERE = np.empty((0, 3))
UNTURNED = np.zeros((1, 3))
LONE = np.array([ISOLATED])
UNTURNED.flags.writeable = LONE.flags.writeable = False
FINEST = 1e-4  # [m], a hundredth of a wavelength


class Source(Protocol):
    """Gives samples, as finely as asked."""

    @property
    def item(self) -> Object:
        """Whose samples they are."""
        ...

    @property
    def faint(self) -> int:
        """How many samples it left out because no one feels them."""
        ...

    def at(self, spacing: float) -> Samples:
        """Samples about `spacing` [m] apart."""
        ...


@dataclass
class WholeObject:
    """An object rendered whole, without a hand. index: in the scene. name: of its samples' keys."""

    item: Object
    index: int
    name: int
    pose: Pose
    covers: SampleCache
    items: tuple[Object, ...]
    faint: int = 0

    def at(self, spacing: float) -> Samples:
        """As for every source."""
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
    """A point without a hand: as `WholeObject`, in a fifth of the time, as scenes have many that move."""

    def at(self, spacing: float) -> Samples:
        """As for every source."""
        item = cast("Point", self.item)
        P = np.array([item.pressure])
        return Samples(
            np.array([self.pose.position]), P, UNTURNED, np.array([item.area]),
            np.array([self.index]), np.array([self.name << 31]), P, LONE, self.items,
        )  # fmt: skip


@dataclass
class PointContacts:
    """Points, paths and particles where they touch a hand: each on the skin where that is nearest."""

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

    def at(self, spacing: float) -> Samples:
        """As for every source."""
        item = self.item
        local = self.covers.get(item, spacing)
        points = local.points @ self.pose.matrix.T + self.pose.position
        reach = item.radius + item.material.reach
        near = self.hand.about(points, reach)
        on, normals, d = self.hand.closest(points[near])
        depth = reach - np.maximum(d, 0.0)  # inside of a hand is touched
        P = self.share * item.material.pressure(depth, item.pressure)
        if self.resolving is not None and P.any():
            P *= grazing(self.resolving.seen(on, normals))
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
    """Where the skin of a hand is inside, or within reach, of a surface or a volume.

    touched: indices of the skin's points. force: on each [N]. Samples at most `fine` [m] apart press as the
    material does there. Farther apart, the force of each point is shared out among the nodes of a level of the skin,
    so that the total is kept and nothing jumps as the contact moves. least: what no one feels below [Pa]; faint: how
    many nodes that leaves out.
    """

    item: Surface | Volume
    index: int
    name: int
    hand: PosedSkin
    items: tuple[Object, ...]
    touched: Indices
    force: Floats
    least: float
    fine: float = 0.0
    faint: int = 0

    @property
    def extent(self) -> float:
        """Area of the skin that is touched [m^2]."""
        return float(self.hand.area[self.touched].sum())

    def at(self, spacing: float) -> Samples:
        """As for every source."""
        hand = self.hand
        fine = spacing <= self.fine
        among = hand.thinned if fine else hand.shared
        nodes, force, area = among(self.touched, self.force, spacing)
        P = force / area
        felt = self.least <= P
        K = int(felt.sum())
        self.faint = len(nodes) - K
        if self.faint:
            nodes, P, area = nodes[felt], P[felt], area[felt]
        return Samples(
            hand.points[nodes], P, hand.normals[nodes], area, np.full(K, self.index),
            make_keys(self.name, 0.0, nodes), np.full(K, self.item.pressure),
            np.full(K, number_region(self.item, self.name)), self.items, self.hand.capsules,
        )  # fmt: skip


def find_contact(
    item: Surface | Volume, pose: Pose, index: int, name: int, hand: PosedSkin,
    items: tuple[Object, ...], share: float, least: float, resolving: ArrayResolution | None, distances: DistanceCache,
) -> Contact | None:  # fmt: skip
    """What of a hand touches `item`, pressed by its material's law, along the skin's normal.

    share: of its pressure. least: what no one feels below [Pa]. resolving: of the array; skin that it
    hardly sees is pressed less.
    """
    material, most = item.material, item.pressure
    reach = material.reach
    corners = ANYWHERE if resolving is None else resolving.corners
    which, local = hand.near(pose, item.bounding_radius + reach, corners)
    if not len(which):
        return None
    d = distances.of(item, name, hand, which, local, reach, material.enough(most))
    some = ANYWHERE if resolving is None else resolving.some
    inside, force = hand.pressed(which, d, reach, material.per_metre(most), most, some)
    if not len(inside):
        return None
    if item.texture is not None:
        force *= item.texture.at(local[inside])
    if share < 1.0:
        force *= share
    if item.texture is not None and not force.any():
        return None
    return Contact(item, index, name, hand, items, which[inside], force, least)


def make_keys(name: int, spacing: float, which: Indices) -> Longs:
    """Keys of samples: what they belong to, how far apart [m] (0 where that is all the same), which, (K,)."""
    level = 1 + round(2.0 * math.log2(spacing / FINEST)) if spacing else 0
    return (name << 31) + (level << 25) + which.astype(np.int64)


def _apart(item: Object, spacing: float) -> float:
    return spacing if hasattr(item, "shape") else 0.0


def is_dense(item: HapticObject) -> bool:
    """Whether an object's samples are of one surface that all sounds at once, so that they are a region."""
    return isinstance(item, Body) and not measure_spacing(item)


def number_region(item: HapticObject, name: int) -> int:
    """The region of an object's samples, `name` being a number of its own; -1 if they are isolated."""
    return name if is_dense(item) else ISOLATED


def measure_spacing(item: HapticObject) -> bool:
    """Whether an object's samples are sounded one at a time, so that many of them cost little."""
    return bool(getattr(item.technique, "single", False))
