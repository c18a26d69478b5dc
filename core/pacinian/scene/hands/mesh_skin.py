"""The skin of a hand given as a triangle mesh: points fixed to its faces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import check_count
from pacinian.errors import ArgumentError
from pacinian.native import scene as kernels
from pacinian.scene.hands.capsules import Nearest
from pacinian.scene.hands.skin import PosedPoints, Skin
from pacinian.scene.hands.skin_lod import FINEST_SKIN_SPACING, GRAIN, SkinNodes, spread_finely
from pacinian.scene.shapes.triangle_points import find_barycentric, pick_points

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.types import Flags, Floats, Indices

PATCHES = 24  # number of patches, which take the place of bones
MIN_LENGTH = 1e-300
MAX_FLATNESS = 1e-3  # mean cosine between a face's normal and the direction from the middle, below which a hand is flat


class MeshSkin(Skin):
    """The skin of all hands that have the same faces as `hand`, which gives the rest pose.

    Each point keeps its barycentric coordinates on its face. Outward is the side on which most faces look away from
    the middle; on a flat sheet, it is the side from which the corners of a face go anticlockwise. Patches take the
    place of bones: each consists of the faces nearest to one of the first 24 points. Only the normals distinguish
    fingers, so on coarse levels, points on neighbouring fingers may share nodes. A face without area has the normal
    0.
    """

    def __init__(self, hand: Hand) -> None:
        V, F = _mesh(hand)
        if hand.lost:
            raise ArgumentError("hand", "must not be lost when it is first seen")
        corners = V[F]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.doubled = np.linalg.norm(across, axis=1)  # twice each face's area
        total = float(self.doubled.sum()) / 2.0
        if not total > 0.0:
            raise ArgumentError("faces", "must have an area")
        middle = corners.mean(axis=1)
        self.outward = _find_outward(middle - V.mean(axis=0), across)
        N = max(1, round(check_count(total, GRAIN, 2)))
        points, face = pick_points(corners, self.doubled / 2.0, N)
        normals = self.outward * across[face] / self.doubled[face, None]
        surface = SkinNodes(points, normals, np.zeros(N, dtype=np.intp))
        order, apart, area, self.between = spread_finely(
            surface, np.full(N, total / N), FINEST_SKIN_SPACING
        )
        K, every = len(apart), surface.only(order)
        self._faces = face[order]
        self._coordinates: Floats = find_barycentric(corners[self._faces], every.points)
        surface, self.face = surface.only(order[:K]), self._faces[:K]
        self.coordinates = self._coordinates[:K]
        away = np.linalg.norm(middle[:, None] - surface.points[:PATCHES], axis=2)
        self.patch = away.argmin(axis=1)
        bone = self.patch[self._faces]
        super().__init__(surface, apart, area, bone[:K], np.zeros(K, np.bool_))
        self.bones_between, self.hidden_between = bone[K:], np.zeros(len(bone) - K, np.bool_)

    def place(self, hand: Hand) -> PosedPoints:
        """Place the points on a hand of this kind, which must not be lost."""
        C = int(self.bone.max()) + 1
        bounds = np.zeros((C, 4))
        at = self._place(hand, self.face, self.coordinates, self.area, self.bone, bounds)
        return PosedPoints(*at, np.empty((0, 8)), bounds)

    def place_between(
        self, hand: Hand, which: Indices, area: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Place the points `which`, (I,), between the others; see `Skin.place_between`."""
        own = which + len(self)
        patch = np.zeros(len(which), np.intp)  # of bounds that nobody needs
        faces, coordinates = self._faces[own], self._coordinates[own]
        return self._place(hand, faces, coordinates, area, patch, np.zeros((1, 4)))

    def _place(
        self, hand: Hand, face: Indices, coordinates: Floats, area: Floats, patch: Indices, bounds: Floats,
    ) -> tuple[Floats, Floats, Floats]:  # fmt: skip
        """Return the positions and normals of points, (K, 3), and the area of each, (K,); write the patches' bounds."""
        V, F = _mesh(hand)
        K = len(face)
        points, normals, now = np.empty((K, 3)), np.empty((K, 3)), np.empty(K)
        kernels.place_on_mesh(
            V.copy(), F[face], coordinates, self.outward, self.doubled[face], area, patch,
            points, normals, now, bounds,
        )  # fmt: skip
        return points, normals, now

    def find_exposed(self, placed: PosedPoints, which: Indices) -> Flags:
        """Return which of the points `which`, (I,), are exposed, (I,): on a mesh, all of them."""
        return np.ones(len(which), dtype=np.bool_)

    def closest(self, hand: Hand, points: Floats) -> Nearest:
        """Find the nearest skin of the hand to points, (P, 3) [m]."""
        import igl

        V, F = _mesh(hand)
        found = igl.signed_distance(points, V, F, igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL)
        distance, face, surface, normals = map(np.asarray, found)
        size = np.linalg.norm(normals, axis=1, keepdims=True)
        out = self.outward * normals / np.maximum(size, MIN_LENGTH)
        return Nearest(surface, out, self.outward * distance, self.patch[face])


def _find_outward(middle: Floats, across: Floats) -> float:
    """Return 1 if the faces look outward, and -1 if they look inward.

    middle: of each face, relative to that of the hand, (F, 3) [m]. across: cross products of their edges, (F, 3) [m^2].
    """
    away = (middle * across).sum(axis=1)
    size = np.linalg.norm(middle, axis=1) @ np.linalg.norm(across, axis=1)
    return -1.0 if float(away.sum()) < -MAX_FLATNESS * float(size) else 1.0


def _mesh(hand: Hand) -> tuple[Floats, Indices]:
    if hand.vertices is None or hand.faces is None:
        raise ArgumentError("hand", "must have vertices and faces")
    return hand.vertices, hand.faces
