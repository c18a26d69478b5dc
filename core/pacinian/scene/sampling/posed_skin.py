"""A hand at one moment, ready to be asked what it touches."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.hands.skin import Skin, skin_of
from pacinian.scene.sampling.array_resolution import HARDLY, WELL

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Pose, Vector
    from pacinian.scene.hands.hand import Hand
    from pacinian.types import Flags, Floats, Indices

SHARED = 1e-9  # of a force: less is rounding
MIN_LENGTH = 1e-300


class PosedSkin:
    """The skin of `hand` where it is now.

    skin: of a hand of its kind, if it is at hand.
    """

    def __init__(self, hand: Hand, skin: Skin | None = None) -> None:
        from pacinian.native import scene as kernels

        self.hand = hand
        self.skin = skin_of(hand) if skin is None else skin
        self.placed = self.skin.place(hand)
        self.points, self.normals, self.area = self.placed[:3]
        self.capsules = self.placed.capsules
        self.box = np.empty(6)
        """Its lower and upper corner [m], (6,)."""
        kernels.box(self.placed.bounds, self.box)
        a, b, c, x, y, z = self.box.tolist()
        self.centre: Vector = ((a + x) / 2.0, (b + y) / 2.0, (c + z) / 2.0)
        self.salt = zlib.crc32(hand.name.encode())
        """Tells the keys of what touches this hand from those of another, whatever hands come and go."""

    def near(self, pose: Pose, radius: float, corners: Floats) -> tuple[Indices, Floats]:
        """Points within `radius` [m] of a pose: which, and where in its frame [m].

        corners: of a box, one of which they must face, (V, 3) [m]; none for anything.
        """
        from pacinian.native.scene import candidates

        K = len(self.points)
        which, local = np.empty(K, dtype=np.intp), np.empty((K, 3))
        count = candidates(
            self.points, self.normals, self.skin.bone, self.placed.bounds,
            np.array(pose.position), radius, pose.matrix, corners, which, local,
        )  # fmt: skip
        return which[:count], local[:count]

    def pressed(
        self, which: Indices, d: Floats, reach: float, stiffness: float, most: float, some: Floats
    ) -> tuple[Indices, Floats]:
        """Which of the points `which`, (I,), are pressed, and with how much.

        d: their signed distances, (I,) [m]. reach [m], stiffness [Pa/m], most [Pa]: the law. some:
        transducers that must see them, (V, 3); none for any. Returns indices into `which`, and forces [N].
        """
        from pacinian.native.scene import press

        inside, force = np.empty(len(which), dtype=np.intp), np.empty(len(which))
        count = press(
            d, which, reach, stiffness, most, self.points, self.normals, self.area, self.skin.bone,
            self.skin.slack, self.capsules, some, HARDLY, WELL, inside, force,
        )  # fmt: skip
        return inside[:count], force[:count]

    def around(
        self, q: Floats, spacing: float, inner: float, outer: float, centre: Floats
    ) -> tuple[Indices, Indices]:
        """Nodes of the level nearest to `spacing` [m] that lie beside q, (K, 3) [m], K > 0, and face `centre`, (3,).

        inner, outer: how far away the nearest of q is [m]. Returns indices of the nodes, (I,), none inside of another
        finger, and of the nearest of q, (I,).
        """
        from pacinian.native.scene import around

        count = self.skin.counts[self.skin.level(spacing)]
        which, nearest = np.empty(count, dtype=np.intp), np.empty(count, dtype=np.intp)
        found = around(
            self.points, self.normals, count, q, centre, inner, outer, which, nearest
        )  # fmt: skip
        shown = self.exposed(which[:found])
        return which[:found][shown], nearest[:found][shown]

    def exposed(self, touched: Indices) -> Flags:
        """Which of the points are not inside of another finger."""
        return self.skin.exposed(self.placed, touched)

    def about(self, points: Floats, radius: float) -> Indices:
        """Indices of those of the points, (K, 3) [m], that are within `radius` [m] of its box."""
        low, high = self.box[:3] - radius, self.box[3:] + radius
        return np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))

    def closest(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Where the skin is nearest to points (K, 3) [m], its normals there, and how far it is [m]."""
        found = self.skin.closest(self.hand, points)
        return found.points, found.normals, found.distance

    def thinned(
        self, touched: Indices, force: Floats, spacing: float
    ) -> tuple[Indices, Floats, Floats]:
        """Those of the points, (K,), that are nodes of the level nearest to `spacing` [m], pressed as they are.

        As for `shared`; the forces [N] are those on the larger areas.
        """
        level = self.skin.level(spacing)
        own = touched < self.skin.counts[level]
        own[own] = self.exposed(touched[own])
        nodes = touched[own]
        stretch = self.skin.node_area[level][nodes] / self.skin.area[nodes]
        return nodes, force[own] * stretch, self.area[nodes] * stretch

    def shared(
        self, touched: Indices, force: Floats, spacing: float
    ) -> tuple[Indices, Floats, Floats]:
        """What the nodes of the level nearest to `spacing` [m] get of forces on points, (K,) [N].

        The nodes that get any and are not inside of other flesh, (M,); the force of each [N], in all what
        was given; the area of skin that each stands for [m^2].
        """
        from pacinian.native.scene import share_out

        skin, level = self.skin, self.skin.level(spacing)
        count = skin.counts[level]
        got, nodes = np.empty(count), np.empty(count, dtype=np.intp)
        nodes = nodes[: share_out(touched, force, *skin.share[level], SHARED, got, nodes)]
        shown = self.exposed(nodes)
        if not shown.all():
            nodes = nodes[shown]
        kept = got[nodes]
        kept *= force.sum() / max(
            kept.sum(), MIN_LENGTH
        )  # what buried nodes would get goes to the others
        area = skin.node_area[level][nodes] * self.area[nodes] / skin.area[nodes]
        uncovered = touched[skin.hidden[touched]]
        if level and len(uncovered):  # skin that was inside of the flesh at rest
            more, which = np.empty(count), np.empty(count, dtype=np.intp)
            share_out(uncovered, self.area[uncovered], *skin.share[level], 0.0, more, which)
            area += more[nodes]
        return nodes, kept, area
