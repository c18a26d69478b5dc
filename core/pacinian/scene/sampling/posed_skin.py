"""The skin of a hand at one moment, with queries for contact."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native import scene as kernels
from pacinian.scene.hands.skin import CREASE
from pacinian.scene.hands.skin_cache import get_skin
from pacinian.scene.sampling.array_resolution import BLOCKED_COS2, FULL_PRESSURE_COS2

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Pose, Vector
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin import Skin
    from pacinian.scene.material import Material
    from pacinian.types import Flags, Floats, Indices

MIN_SHARE = 1e-9  # nodes that get less than this fraction of the largest force are ignored as rounding errors
MIN_LENGTH = 1e-300
MIN_AREA = 1e-300
# A node of the skin takes over force from buried skin until it is pressed this many times as hard as any touched point.
MAX_CROWDING = 2.0


class FineSkin(NamedTuple):
    """The I points of a level between those of a skin, near some of these.

    which: their numbers, those of the skin's own K points included, whose numbers are less than K, (I,). points: (I, 3)
    [m]. normals: (I, 3). area: that each represents, (I,) [m^2]. bone, slack: as of the skin, (I,).
    """

    which: Indices
    points: Floats
    normals: Floats
    area: Floats
    bone: Indices
    slack: Floats

    def only(self, kept: Indices) -> FineSkin:
        """Return the points `kept`, in that order."""
        return FineSkin(
            self.which[kept],
            self.points[kept],
            self.normals[kept],
            self.area[kept],
            self.bone[kept],
            self.slack[kept],
        )


class PosedSkin:
    """The skin of `hand` at its current pose.

    skin: the skin at rest of this kind of hand, if already made.
    """

    def __init__(self, hand: Hand, skin: Skin | None = None) -> None:
        self.hand = hand
        self.skin = get_skin(hand) if skin is None else skin
        self.placed = self.skin.place(hand)
        self.points, self.normals, self.area = self.placed[:3]
        self.capsules = self.placed.capsules
        self.box = np.empty(6)
        """Lower and upper corner of the bounding box, (6,) [m]."""
        kernels.box(self.placed.bounds, self.box)
        a, b, c, x, y, z = self.box.tolist()
        self.centre: Vector = ((a + x) / 2.0, (b + y) / 2.0, (c + z) / 2.0)
        self.salt = zlib.crc32(hand.name.encode())
        """Number that keeps sample keys of different hands apart. It depends only on the hand's name."""

    def find_near(self, pose: Pose, radius: float, corners: Floats) -> tuple[Indices, Floats]:
        """Find the points within `radius` [m] of a pose. Returns their indices, and their positions in its frame [m].

        corners: points of the skin must face one of these, (V, 3) [m]; if empty, they may face anywhere.
        """
        K = len(self.points)
        which, local = np.empty(K, dtype=np.intp), np.empty((K, 3))
        count = kernels.candidates(
            self.points, self.normals, self.skin.bone, self.placed.bounds,
            np.array(pose.position), radius, pose.matrix, corners, which, local,
        )  # fmt: skip
        return which[:count], local[:count]

    def find_pressed(
        self,
        which: Indices,
        d: Floats,
        material: Material,
        most: float,
        viewpoints: Floats,
        fine: FineSkin | None = None,
    ) -> tuple[Indices, Floats]:
        """Find which of the points `which`, (I,), are pressed, and with what force.

        d: their signed distances, (I,) [m]. material, most: of the object, and its full pressure [Pa]. viewpoints:
        positions of some transducers, (V, 3) [m]; only skin that faces them is pressed, or all if there are none. fine:
        points of a fine level, to which `which` refers instead of the skin's own. Returns indices into `which`, and
        forces [N].
        """
        of = self.points, self.normals, self.area, self.skin.bone, self.skin.slack
        if fine is not None:
            of = fine[1:]
        inside, force = np.empty(len(which), dtype=np.intp), np.empty(len(which))
        count = kernels.press(
            d, which, material.reach, material.compute_stiffness(most), most, *of, self.capsules, viewpoints,
            BLOCKED_COS2, FULL_PRESSURE_COS2, inside, force,
        )  # fmt: skip
        return inside[:count], force[:count]

    def find_fine_level(self, spacing: float) -> int | None:
        """Return the level between the skin's points that is nearest to `spacing` [m].

        None if one of the skin's own levels is nearer.
        """
        between = self.skin.between
        if between is None:
            return None
        levels = np.array([*between.levels, self.skin.levels[0]])
        nearest = int(np.abs(np.log(levels / spacing)).argmin())
        return nearest if nearest < len(between.levels) else None

    def find_finest(self, near: Indices) -> tuple[FineSkin, float]:
        """Return the finest points that there are at the points `near`, (N,), and their spacing [m]."""
        skin = self.skin
        if skin.between is not None:
            return self.refine(near, 0), skin.between.levels[0]
        every = np.arange(len(self.points))
        fine = FineSkin(every, self.points, self.normals, self.area, skin.bone, skin.slack)
        return fine.only(near), float(skin.levels[0])

    def refine(self, near: Indices, level: int) -> FineSkin:
        """Return the points `near`, (N,), and those of a fine level of which one of them is the nearest."""
        skin, K = self.skin, len(self.points)
        assert skin.between is not None
        area = skin.between.area[level]
        more = skin.between.find(near, level)
        points, normals, now = skin.place_between(self.hand, more, area[K + more])
        own = area[near] * self.area[near] / skin.area[near]
        return FineSkin(
            np.concatenate([near, K + more]),
            np.concatenate([self.points[near], points]),
            np.concatenate([self.normals[near], normals]),
            np.concatenate([own, now]),
            np.concatenate([skin.bone[near], skin.bones_between[more]]),
            np.concatenate(
                [skin.slack[near], np.where(skin.hidden_between[more], 0.0, CREASE)]
            ),
        )  # fmt: skip

    def around(
        self, q: Floats, spacing: float, inner: float, outer: float, centre: Floats, most: int
    ) -> tuple[Indices, Indices]:
        """Find the nodes of the level nearest to `spacing` [m] that lie beside the points q and face `centre`.

        q: (K, 3) [m], K > 0. inner, outer: limits of the distance from a node to the nearest point of q [m]. centre:
        (3,) [m]. most: largest number of nodes. Returns the indices of the nodes, (I,), without those inside another
        finger, and of the nearest point of q to each, (I,).
        """
        skin = self.skin
        count = skin.counts[skin.level(spacing)]
        which, nearest = np.empty(count, dtype=np.intp), np.empty(count, dtype=np.intp)
        found = kernels.around(
            self.points, self.normals, count, q, centre, inner, outer, self.capsules, skin.bone, skin.slack,
            most, which, nearest,
        )  # fmt: skip
        return which[:found], nearest[:found]

    def find_exposed(self, touched: Indices) -> Flags:
        """Return which of the points `touched` are not inside another finger."""
        return self.skin.find_exposed(self.placed, touched)

    def about(self, points: Floats, radius: float) -> Indices:
        """Return the indices of the points, (K, 3) [m], that are within `radius` [m] of the bounding box."""
        low, high = self.box[:3] - radius, self.box[3:] + radius
        return np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))

    def closest(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the nearest skin to points (K, 3) [m]: positions [m], normals and signed distances [m]."""
        found = self.skin.closest(self.hand, points)
        return found.points, found.normals, found.distance

    def thin_forces(
        self, touched: Indices, force: Floats, spacing: float
    ) -> tuple[Indices, Floats, Floats]:
        """Keep only the points that are nodes of the level nearest to `spacing` [m], each at its own pressure.

        The arguments and results are those of `share_forces`. Each force is scaled to the larger area of its node [N].
        """
        skin, level = self.skin, self.skin.level(spacing)
        nodes, pressed, area = np.empty_like(touched), np.empty_like(force), np.empty_like(force)
        count = kernels.thin(
            touched, force, skin.counts[level], skin.node_area[level], skin.area, self.area, self.points,
            self.capsules, skin.bone, skin.slack, nodes, pressed, area,
        )  # fmt: skip
        return nodes[:count], pressed[:count], area[:count]

    def share_forces(
        self, touched: Indices, force: Floats, spacing: float
    ) -> tuple[Indices, Floats, Floats]:
        """Distribute forces on points among the nodes of the level nearest to `spacing` [m].

        touched: indices of the points, (K,). force: on each, (K,) [N]. Returns the nodes that get a force and are not
        inside other flesh, (M,); their forces [N]; and the skin area that each represents [m^2]. The forces have the
        same sum, unless so much skin is inside other flesh that the rest would be pressed MAX_CROWDING times as hard.
        """
        skin, level = self.skin, self.skin.level(spacing)
        count = skin.counts[level]
        got, nodes = np.empty(count), np.empty(count, dtype=np.intp)
        held = kernels.share_out(touched, force, *skin.share[level], MIN_SHARE, got, nodes)
        nodes = nodes[:held]
        shown = self.find_exposed(nodes)
        if not shown.all():
            nodes = nodes[shown]
        kept = got[nodes]
        # the other nodes take over the force of the buried ones
        kept *= force.sum() / max(kept.sum(), MIN_LENGTH)
        area = skin.node_area[level][nodes] * self.area[nodes] / skin.area[nodes]
        uncovered = touched[skin.hidden[touched]]
        if level and len(uncovered):  # skin that is inside the flesh at rest
            more, which = np.empty(count), np.empty(count, dtype=np.intp)
            kernels.share_out(uncovered, self.area[uncovered], *skin.share[level], 0.0, more, which)
            area += more[nodes]
        most = (force / np.maximum(self.area[touched], MIN_AREA)).max(initial=0.0)
        return nodes, np.minimum(kept, MAX_CROWDING * most * area), area


def join_capsules(skins: list[PosedSkin]) -> Floats:
    """Return the capsules of all skins, (C, 8) [m]."""
    return np.concatenate([np.empty((0, 8)), *(skin.capsules for skin in skins)])
