"""Contact: the skin that touches a surface or a volume, how strongly it is pressed, and its samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import press_on
from pacinian.neighbours import find_nearest
from pacinian.scene.hands.skin_lod import FINEST_SKIN_SPACING
from pacinian.scene.objects import Surface
from pacinian.scene.sampling.sample_sources import number_region
from pacinian.scene.sampling.samples import Samples
from pacinian.scene.shapes.texture import apply_texture

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.pose import Pose
    from pacinian.scene.objects import Object, Volume
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.distance_cache import DistanceCache
    from pacinian.scene.sampling.posed_skin import FineSkin, PosedSkin
    from pacinian.types import Floats, Indices

# Largest distance of neighbouring points of a skin [m].
NEIGHBOUR_DISTANCE = 1.5 * FINEST_SKIN_SPACING
ANYWHERE = np.empty((0, 3))  # no places that skin must face


@dataclass
class Contact:
    """The part of a hand's skin that is inside a surface or a volume, or within reach of it.

    touched: indices of the skin's points. force: on each of them [N]. candidates: indices of all points of the skin
    near the object, (I,). distance: of these from it, negative inside, (I,) [m]. press: presses points between those
    of the skin as the material does; returns the indices of those that are pressed, and the force on each [N]. fine:
    spacing [m] up to which the material's law gives the pressure of each sample. At a coarser spacing, the force of
    each point is distributed among the nodes of one level of detail of the skin. This keeps the total, and nothing
    jumps as the contact moves. least: pressure below which nobody feels a sample [Pa]. faint: number of nodes left
    out for that reason.
    """

    item: Surface | Volume
    index: int
    name: int
    hand: PosedSkin
    items: tuple[Object, ...]
    touched: Indices
    force: Floats
    least: float
    candidates: Indices
    distance: Floats
    press: Callable[[FineSkin], tuple[Indices, Floats]]
    fine: float = 0.0
    faint: int = 0

    @property
    def place(self) -> tuple[float, float, float]:
        """See `SampleSource`."""
        return self.hand.centre

    @property
    def region(self) -> int:
        """Region number of the samples."""
        return number_region(self.item, self.name)

    @property
    def extent(self) -> float:
        """Area of the touched skin [m^2]."""
        return float(self.hand.area[self.touched].sum())

    def find_bordering(self, some: Indices) -> Indices:
        """Return those points of the skin that may have touched points beside them. some: of `candidates`, by index.

        A point between those of the skin may be touched although the nearest of those is not.
        """
        close = self.distance[some] < self.item.material.reach + FINEST_SKIN_SPACING
        if isinstance(self.item, Surface) and not close.all():
            # behind a sheet, the distance jumps at its outline
            points, rest = self.hand.points, np.flatnonzero(~close)
            away = find_nearest(points[self.touched], points[self.candidates[some[rest]]])[0]
            close[rest] = away < NEIGHBOUR_DISTANCE
        return self.candidates[some[close]]

    def at(self, spacing: float) -> Samples:
        """Return samples about `spacing` [m] apart."""
        hand, of, skin = self.hand, None, (self.hand.points, self.hand.normals)
        level = hand.find_fine_level(spacing) if spacing <= self.fine else None
        if level is not None:
            of = hand.refine(self.find_bordering(np.arange(len(self.candidates))), level)
            nodes, force = self.press(of)
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
            np.full(kept, self.region), self.items, hand.capsules,
        )  # fmt: skip


def touches_unseen(
    item: Surface | Volume, pose: Pose, name: int, hand: PosedSkin, resolving: ArrayResolution, distances: DistanceCache
) -> bool:  # fmt: skip
    """Return whether `item` touches skin of a hand, but only skin that faces away from the array."""
    material = item.material
    which, local = hand.find_near(pose, item.bounding_radius + material.reach, ANYWHERE)
    if not len(which):
        return False
    d = distances.of(item, name, hand, which, local, material.reach)
    seen, pressed = (
        hand.find_pressed(which, d, material, item.pressure, places)[0]
        for places in (resolving.viewpoints, ANYWHERE)
    )
    return len(pressed) > 0 and not len(seen)


def find_contact(
    item: Surface | Volume, pose: Pose, index: int, name: int, hand: PosedSkin,
    items: tuple[Object, ...], share: float, least: float, resolving: ArrayResolution | None, distances: DistanceCache,
) -> Contact | None:  # fmt: skip
    """Find the skin that touches `item`, and its forces, which follow the material's law along the skin's normal.

    share: factor on the pressure, 0..1. least: pressure below which nobody feels a sample [Pa]. resolving: resolution
    and visibility of the array; skin that the array hardly sees is pressed less. Returns None without a contact.
    """
    material, most = item.material, item.pressure
    corners = ANYWHERE if resolving is None else resolving.corners
    viewpoints = ANYWHERE if resolving is None else resolving.viewpoints
    margin = material.reach + FINEST_SKIN_SPACING
    which, local = hand.find_near(pose, item.bounding_radius + margin, corners)
    if not len(which):
        return None
    d = distances.of(item, name, hand, which, local, margin)
    inside, force = hand.find_pressed(which, d, material, most, viewpoints)
    if not len(inside):
        return None

    apply_texture(item.texture, local[inside], force)
    force *= share
    if item.texture is not None and not force.any():
        return None

    def press(fine: FineSkin) -> tuple[Indices, Floats]:
        at = (fine.points - pose.position) @ pose.matrix
        apart = distances.of(item, name, hand, fine.which, at, material.reach)
        every = np.arange(len(apart))
        nodes, force = hand.find_pressed(every, apart, material, most, viewpoints, fine)
        apply_texture(item.texture, at[nodes], force)
        force *= share
        return nodes, force

    return Contact(item, index, name, hand, items, which[inside], force, least, which, d, press)
