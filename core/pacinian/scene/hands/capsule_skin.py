"""The skin of a hand of 26 joints: points fixed to the capsules around its bones."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.errors import ArgumentError
from pacinian.native import scene as kernels
from pacinian.scene.hands import capsules as flesh
from pacinian.scene.hands.bones import FINGERS, PARENTS
from pacinian.scene.hands.hand import Hand
from pacinian.scene.hands.skin import PosedPoints, Skin
from pacinian.scene.hands.skin_lod import (
    FINEST_SKIN_SPACING,
    GRAIN,
    SPACINGS,
    Between,
    SkinNodes,
    gather_pressure,
    join_between,
    spread_finely,
    spread_pressure,
)
from pacinian.scene.shapes import Capsule

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats, Indices

ON = 1e-10  # a point this near to a surface lies on it [m]
MIN_LENGTH = 1e-12  # a shorter vector has no direction [m]


class CapsuleSkin(Skin):
    """The skin of a hand of 26 joints.

    Each point keeps three coordinates: its relative position along the axis of its bone's capsule; its direction from
    the axis in the bone's own frame; and, on a cap, the fraction of the cap's area beyond it. Therefore it stays on the
    capsule for every length, thickness and taper.

    The frame of a bone is that of its parent, rotated by the smallest rotation that takes the bone from its direction
    at rest to its current one. This frame never spins about the bone, and jumps only if a joint bends by 180 degrees.
    The y-axis of the palm's frame points from the wrist to the middle finger's proximal joint, and the x-axis from the
    index finger's to the little finger's. A bone without length keeps its parent's frame, and a palm without extent
    keeps the world's. A left hand is placed as the mirror image of a right one.

    At rest, the fingers are straight. Bending them uncovers skin on the backs of the joints, which is part of the
    sphere there. The points of this skin are inside the flesh at rest, and belong to the finest level only.

    spacing: between points [m]. grain: between the candidates for points [m]. finely: whether to have points between
    them, too.
    """

    def __init__(
        self, spacing: float = FINEST_SKIN_SPACING, grain: float = GRAIN, *, finely: bool = False
    ) -> None:
        shapes = flesh.make_capsules(Hand.open())
        every = [_around(shapes, c, grain) for c in range(len(shapes))]
        shown = [part.only(_shown(shapes, c, part.points)) for c, part in enumerate(every)]
        backs = [part.only(_back(shapes, c, part)) for c, part in enumerate(every)]
        kinds = [_Spread.of(parts, spacing, finely=finely) for parts in (shown, backs)]
        counts = [len(k.area) for k in kinds]
        surface = SkinNodes(
            *(np.concatenate(v) for v in zip(*(k.surface for k in kinds), strict=True))
        )
        apart, area = (
            np.concatenate(v) for v in zip(*((k.apart, k.area) for k in kinds), strict=True)
        )
        parts = [slice(K) for K in counts] + [slice(K, None) for K in counts]
        bone, along, axial, sides = (
            np.concatenate([v[own] for v, own in zip([*values, *values], parts, strict=True)])
            for values in zip(*((k.bone, k.along, k.axial, k.sides) for k in kinds), strict=True)
        )
        K = sum(counts)
        self.levels = spacing / FINEST_SKIN_SPACING * SPACINGS
        hidden = np.arange(K) >= counts[0]
        super().__init__(surface, np.where(hidden, self.levels[0], apart), area, bone[:K], hidden)
        self.along, self.axial, self.sides = along[:K], axial[:K], sides[:K]
        self.bones_between, self._along, self._axial, self._sides = (
            v[K:] for v in (bone, along, axial, sides)
        )
        if finely:
            self.between = join_between([k.between for k in kinds if k.between], counts)
            self.hidden_between = np.arange(len(bone) - K) >= len(kinds[0].bone) - counts[0]
        axes = shapes[:, 3:6] - shapes[:, :3]
        self.length = np.linalg.norm(axes, axis=1)
        self.radii = shapes[:, 6:].copy()
        self.axes = axes / self.length[:, None]

    def place(self, hand: Hand) -> PosedPoints:
        """Place the points on a hand of this kind, which must not be lost."""
        if hand.joints is None:
            raise ArgumentError("hand", "must have joints")
        shapes = flesh.make_capsules(hand)
        at = self._place(hand, shapes, self.bone, self.along, self.axial, self.sides, self.area)
        return PosedPoints(*at, shapes, flesh.find_bounds(shapes))

    def place_between(
        self, hand: Hand, which: Indices, area: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Place the points `which`, (I,), between the others; see `Skin.place_between`."""
        return self._place(
            hand, flesh.make_capsules(hand), self.bones_between[which],
            self._along[which], self._axial[which], self._sides[which], area,
        )  # fmt: skip

    def _place(
        self, hand: Hand, shapes: Floats, bone: Indices, along: Floats, axial: Floats, sides: Floats,
        area: Floats,
    ) -> tuple[Floats, Floats, Floats]:  # fmt: skip
        """Return the positions and normals of points, (K, 3), and the area that each represents, (K,)."""
        assert hand.joints is not None
        K = len(bone)
        points, normals, now = np.empty((K, 3)), np.empty((K, 3)), np.empty(K)
        kernels.place_on_capsules(
            hand.joints.copy(), -1.0 if hand.side == "left" else 1.0, shapes, PARENTS,
            self.axes, self.length, self.radii, bone, along, axial, sides, area, points, normals, now,
        )  # fmt: skip
        return points, normals, now

    def find_exposed(self, placed: PosedPoints, which: Indices) -> Flags:
        """Return which of the points `which`, (I,), are no deeper inside other flesh than their slack: (I,)."""
        return ~flesh.are_buried(placed.capsules, placed.points, self.bone, self.slack, which)

    def closest(self, hand: Hand, points: Floats) -> flesh.Nearest:
        """Find the nearest skin of the hand to points, (P, 3) [m]."""
        return flesh.find_closest(flesh.make_capsules(hand), points)


class _Around(NamedTuple):
    """Points around a capsule.

    points, normals: (N, 3). area: of each point, (N,) [m^2]. along: position along the axis, 0 to 1, (N,). axial: axial
    component of the normal if the capsule did not taper; 0 on the mantle, (N,). sides: unit vectors across the axis,
    (N, 3).
    """

    points: Floats
    normals: Floats
    area: Floats
    along: Floats
    axial: Floats
    sides: Floats

    def only(self, kept: Flags) -> _Around:
        """Return the points `kept`."""
        return _Around(*(values[kept] for values in self))


class _Spread(NamedTuple):
    """K evenly spread points, as for `Skin`, and E between them, with their coordinates on the capsules of their bones.

    surface, apart, area: of the K points. The others: of all.
    """

    surface: SkinNodes
    apart: Floats
    area: Floats
    bone: Indices
    along: Floats
    axial: Floats
    sides: Floats
    between: Between | None

    @classmethod
    def of(cls, parts: list[_Around], spacing: float, *, finely: bool) -> _Spread:
        """Choose evenly spread points from the candidates around each bone."""
        bone = np.repeat(np.arange(len(parts)), [len(part.area) for part in parts])
        points, normals, area, *place = map(np.concatenate, zip(*parts, strict=True))
        surface, between = SkinNodes(points, normals, FINGERS[bone]), None
        if finely:
            order, apart, area, between = spread_finely(surface, area, spacing)
        else:
            order, apart, _, (nearest,) = spread_pressure(surface, [spacing])
            area = gather_pressure(nearest, area)
        nodes = surface.only(order[: len(apart)])
        along, axial, sides = (values[order] for values in place)
        return cls(nodes, apart, area, bone[order], along, axial, sides, between)


def _around(shapes: Floats, c: int, grain: float) -> _Around:
    """Spread points evenly around a capsule of the mean radius, and move them onto the tapered one."""
    a, b, radii = shapes[c, :3], shapes[c, 3:6], shapes[c, 6:]
    length, mean = float(np.linalg.norm(b - a)), float(radii.mean())
    shape = Capsule(mean, length)
    local = shape.sample_surface(grain)
    axial = local.normals[:, 2]
    along = np.where(
        axial == 0.0, local.points[:, 2] / length + 0.5, np.where(axial < 0.0, 0.0, 1.0)
    )
    z = (b - a) / length
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    sides = local.normals[:, :2] @ np.stack([x, np.cross(z, x)])
    size = np.linalg.norm(sides, axis=1, keepdims=True)
    sides = np.where(size > 0.0, sides / np.maximum(size, MIN_LENGTH), x)
    tilted, share = np.empty(len(along)), np.empty(len(along))
    kernels.tilt(axial.copy(), along, radii[0], radii[1], length, tilted, share)
    normals = tilted[:, None] * z + np.sqrt(1.0 - tilted * tilted)[:, None] * sides
    r = radii[0] + along * (radii[1] - radii[0])
    points = a + along[:, None] * (b - a) + r[:, None] * normals
    area = shape.area / len(along) * share / np.where(axial == 0.0, mean * length, mean * mean)
    return _Around(points, normals, area, along, axial, sides)


def _shown(shapes: Floats, c: int, points: Floats) -> Flags:
    """Return which points of a capsule are not inside others. Where surfaces coincide, the first owns the skin."""
    centres, radii = np.split(flesh.find_bounds(shapes), [3], axis=1)
    apart = np.linalg.norm(centres - centres[c], axis=1)
    near = apart <= (radii + radii[c])[:, 0] + ON
    free = flesh.distance_to_skin(shapes[:c][near[:c]], points) > ON
    free[free] = flesh.distance_to_skin(shapes[c + 1 :][near[c + 1 :]], points[free]) > -ON
    return free


def _back(shapes: Floats, c: int, around: _Around) -> Flags:
    """Return which points of a capsule's caps may be uncovered by bending: only moving flesh hides them at rest.

    On the capsules of the palm, these are the points that only fingers hide. On a finger's bone, these are the points
    at its tip that only the next bone hides, which has the same sphere there.
    """
    every = np.arange(len(shapes))
    if not FINGERS[c]:
        joints = [(FINGERS > 0, 0.0), (FINGERS > 0, 1.0)]
    else:
        joints = [(every == k, 1.0) for k in np.flatnonzero(c == PARENTS)]
    back = np.zeros(len(around.area), dtype=np.bool_)
    for moves, end in joints:
        cap = np.flatnonzero((around.along == end) & (around.axial != 0.0))
        covered = cap[flesh.distance_to_skin(shapes[moves], around.points[cap]) <= -ON]
        others = shapes[~moves & (every != c)]
        back[covered] |= flesh.distance_to_skin(others, around.points[covered]) > -ON
    return back
