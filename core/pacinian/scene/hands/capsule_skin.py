"""The skin of a hand of 26 joints: points that stick to the capsules around its bones."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.compiled import compiled
from pacinian.errors import ArgumentError
from pacinian.scene.hands import capsules as flesh
from pacinian.scene.hands.bones import FINGERS, PARENTS
from pacinian.scene.hands.hand import Hand
from pacinian.scene.hands.levels import FINEST, GRAIN, SPACINGS, Surface, gathered, spread
from pacinian.scene.hands.skin import Placed, Skin
from pacinian.scene.shapes import Capsule

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats, Indices

ON = 1e-10  # [m]; nearer to a surface than this is on it
TINY = 1e-12  # [m]; what is shorter has no direction
STRAIGHT = 1e-18  # squared sine of an angle


class CapsuleSkin(Skin):
    """The skin of a hand of 26 joints.

    Each point keeps its place along the axis of its bone's capsule and its direction from it in the
    bone's own frame, so that it lies on the capsule however long and thick that is. A bone's frame is
    that of its parent, turned by the smallest rotation which takes the bone from its direction at rest to
    the one it has: it never spins about the bone, and jumps only where a joint is bent by 180 degrees.
    The palm's frame has y from the wrist to the middle finger's proximal joint, and x from the index's
    to the little finger's. A bone of no length keeps its parent's frame; a palm of no extent the world's.
    A left hand is placed as the mirror image of a right one.

    At rest the fingers are straight. Bending them uncovers skin on the backs of the joints: of the two capsules'
    spheres there, the larger. Its points are of the finest level only, and inside of the flesh at rest.

    spacing: between points, [m]. grain: between those that they are chosen from [m].
    """

    def __init__(self, spacing: float = FINEST, grain: float = GRAIN) -> None:
        shapes = flesh.capsules(Hand.open())
        every = [_around(shapes, c, grain) for c in range(len(shapes))]
        shown = [part.only(_shown(shapes, c, part.points)) for c, part in enumerate(every)]
        backs = [part.only(_back(shapes, c, part)) for c, part in enumerate(every)]
        kinds = [_Spread.of(parts, spacing) for parts in (shown, backs)]
        surface = Surface(
            *(np.concatenate(v) for v in zip(*(k.surface for k in kinds), strict=True))
        )
        apart, area, bone, along, mantle = (
            np.concatenate(v) for v in zip(*(k[1:] for k in kinds), strict=True)
        )
        self.levels = spacing / FINEST * SPACINGS
        hidden = np.arange(len(bone)) >= len(kinds[0].area)
        super().__init__(surface, np.where(hidden, self.levels[0], apart), area, bone, hidden)
        self.along, self.mantle = along, mantle
        axes = shapes[:, 3:6] - shapes[:, :3]
        self.length = np.linalg.norm(axes, axis=1)
        self.radius = shapes[:, 6].copy()
        self.axes = axes / self.length[:, None]

    def place(self, hand: Hand) -> Placed:
        """Where the points are on a hand of this kind, which is not lost."""
        if hand.joints is None:
            raise ArgumentError("hand", "must have joints")
        K, shapes = len(self), flesh.capsules(hand)
        placed = Placed(
            np.empty((K, 3)), np.empty((K, 3)), np.empty(K), shapes, flesh.bounds(shapes)
        )
        _place(
            hand.joints.copy(), -1.0 if hand.side == "left" else 1.0, shapes, PARENTS,
            self.axes, self.length, self.radius, self.bone, self.along, self.surface.normals,
            self.mantle, self.area, placed.points, placed.normals, placed.area,
        )  # fmt: skip
        return placed

    def exposed(self, placed: Placed, which: Indices) -> Flags:
        """Which of the points `which`, (I,), are not deeper inside of other flesh than their slack, (I,)."""
        return ~flesh.buried(placed.capsules, placed.points, self.bone, self.slack, which)

    def closest(self, hand: Hand, points: Floats) -> flesh.Nearest:
        """The hand's nearest skin to points, (P, 3) [m]."""
        return flesh.closest(flesh.capsules(hand), points)


class _Around(NamedTuple):
    """Points around a capsule.

    points, normals: (N, 3). area: of each, (N,) [m^2]. along: from 0 to 1 along the axis, (N,). mantle:
    whether on the mantle, not on a cap, (N,).
    """

    points: Floats
    normals: Floats
    area: Floats
    along: Floats
    mantle: Flags

    def only(self, kept: Flags) -> _Around:
        """Those of its points."""
        points, normals, area, along, mantle = self
        return _Around(points[kept], normals[kept], area[kept], along[kept], mantle[kept])


class _Spread(NamedTuple):
    """K points that are evenly spread, as for `Skin`, each with its place on its bone's capsule."""

    surface: Surface
    apart: Floats
    area: Floats
    bone: Indices
    along: Floats
    mantle: Flags

    @classmethod
    def of(cls, parts: list[_Around], spacing: float) -> _Spread:
        """Choose among points around each bone."""
        bone = np.repeat(np.arange(len(parts)), [len(part.area) for part in parts])
        points, normals, area, along, mantle = map(np.concatenate, zip(*parts, strict=True))
        surface = Surface(points, normals, FINGERS[bone])
        order, apart, nearest = spread(surface, spacing)
        area = gathered(nearest, area)
        return cls(surface.only(order), apart, area, bone[order], along[order], mantle[order])


def _around(shapes: Floats, c: int, grain: float) -> _Around:
    a, b, r = shapes[c, :3], shapes[c, 3:6], float(shapes[c, 6])
    length = float(np.linalg.norm(b - a))
    shape = Capsule(r, length)
    local = shape.cover(grain)
    up = np.sign(local.normals[:, 2])  # 0 but for the caps
    along = np.where(up == 0.0, local.points[:, 2] / length + 0.5, (1.0 + up) / 2.0)
    z = (b - a) / length
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    normals = np.asarray(local.normals @ np.stack([x, np.cross(z, x), z]), dtype=np.float64)
    points = a + along[:, None] * (b - a) + r * normals
    area = np.full(len(along), shape.area / len(along))
    return _Around(points, normals, area, along, up == 0.0)


def _shown(shapes: Floats, c: int, points: Floats) -> Flags:
    """Which of a capsule's points are not inside of others; where two surfaces coincide the skin is of the first."""
    free = flesh.distance_to_skin(shapes[:c], points) > ON
    free &= flesh.distance_to_skin(shapes[c + 1 :], points) > -ON
    return free


def _back(shapes: Floats, c: int, around: _Around) -> Flags:
    """Which points of a capsule's caps bending may uncover: those that are inside of nothing but what moves there.

    Of the palm's capsules all points that only fingers hide; of a finger's at each joint those that the other
    bone there hides, if its sphere is no larger.
    """
    r, every = shapes[:, 6], np.arange(len(shapes))
    if not FINGERS[c]:
        joints = [(FINGERS > 0, 0.0), (FINGERS > 0, 1.0)]
    else:
        joints = [(every == k, 1.0) for k in np.flatnonzero(c == PARENTS) if r[c] >= r[k]]
        parent = PARENTS[c]
        joints += [(every == parent, 0.0)] if FINGERS[parent] and r[c] > r[parent] else []
    back = np.zeros(len(around.area), dtype=np.bool_)
    for moves, end in joints:
        hidden = flesh.distance_to_skin(shapes[moves], around.points) <= -ON
        free = flesh.distance_to_skin(shapes[~moves & (every != c)], around.points) > -ON
        back |= hidden & free & (around.along == end)
    return back & ~around.mantle


@compiled("void(f8[:, ::1], f8, f8[:, ::1])")
def _palm(joints: Floats, mirror: float, out: Floats) -> None:
    """Write the palm's frame, its axes as columns."""
    x, y = joints[22] - joints[7], joints[12] - joints[1]
    x[0] *= mirror
    y[0] *= mirror
    y /= max(np.sqrt(np.sum(y * y)), TINY)
    x -= np.sum(x * y) * y
    x /= max(np.sqrt(np.sum(x * x)), TINY)
    out[:, 0], out[:, 1], out[:, 2] = x, y, np.cross(x, y)
    if np.sum(out * out) < 2.5:
        out[:] = np.eye(3)


@compiled("void(f8[:, ::1], f8[::1], f8[::1], f8[:, ::1])")
def _turn(parent: Floats, rest: Floats, now: Floats, out: Floats) -> None:
    """Write the frame `parent` turned by the smallest rotation that takes `rest`, in it, to `now`."""
    out[:] = parent
    size = np.sqrt(np.sum(now * now))
    if size < TINY:
        return
    d = np.zeros(3)
    for i in range(3):
        for j in range(3):
            d[i] += parent[j, i] * now[j] / size
    v = np.cross(rest, d)
    cosine, square = np.sum(rest * d), np.sum(v * v)
    R = np.zeros((3, 3))
    if cosine > 0.0 or square > STRAIGHT:
        half = 1.0 / (1.0 + cosine) if cosine > 0.0 else (1.0 - cosine) / square
        R[0, 1], R[1, 0], R[0, 2], R[2, 0], R[1, 2], R[2, 1] = -v[2], v[2], v[1], -v[1], -v[0], v[0]
    else:  # half a turn about an axis across
        v[:] = 0.0
        v[np.argmin(np.abs(rest))] = 1.0
        v -= np.sum(v * rest) * rest
        half, cosine = 2.0 / np.sum(v * v), np.float64(-1.0)
    for i in range(3):
        R[i, i] += cosine
        for j in range(3):
            R[i, j] += half * v[i] * v[j]
    for i in range(3):
        for j in range(3):
            out[i, j] = parent[i, 0] * R[0, j] + parent[i, 1] * R[1, j] + parent[i, 2] * R[2, j]


@compiled(
    "void(f8[:, ::1], f8, f8[:, ::1], i8[::1], f8[:, ::1], f8[::1], f8[::1], i8[::1], f8[::1],"
    " f8[:, ::1], b1[::1], f8[::1], f8[:, ::1], f8[:, ::1], f8[::1])"
)
def _place(
    joints: Floats, mirror: float, capsules: Floats, parents: Indices,
    axes: Floats, length: Floats, radius: Floats,
    bone: Indices, along: Floats, normals: Floats, mantle: Flags, area: Floats,
    at: Floats, facing: Floats, stands: Floats,
) -> None:  # fmt: skip
    """Write where the points of a capsule skin are: `at`, `facing`, and the area each `stands` for."""
    C = capsules.shape[0]
    palm, frames, across = np.empty((3, 3)), np.empty((C, 3, 3)), np.empty((C, 3))
    sides, caps = np.empty(C), np.empty(C)
    _palm(joints, mirror, palm)
    for c in range(C):
        parent = palm if parents[c] < 0 else frames[parents[c]]
        u = across[c]
        u[0] = mirror * (capsules[c, 3] - capsules[c, 0])
        u[1] = capsules[c, 4] - capsules[c, 1]
        u[2] = capsules[c, 5] - capsules[c, 2]
        _turn(parent, axes[c], u, frames[c])
        thick = capsules[c, 6] / radius[c]
        caps[c] = thick * thick
        sides[c] = thick * np.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) / length[c]
    for k in range(bone.size):
        c, s = bone[k], along[k]
        F, r = frames[c], capsules[c, 6]
        x, y, z = normals[k, 0], normals[k, 1], normals[k, 2]
        nx = mirror * (F[0, 0] * x + F[0, 1] * y + F[0, 2] * z)
        ny = F[1, 0] * x + F[1, 1] * y + F[1, 2] * z
        nz = F[2, 0] * x + F[2, 1] * y + F[2, 2] * z
        at[k, 0] = capsules[c, 0] + s * (capsules[c, 3] - capsules[c, 0]) + r * nx
        at[k, 1] = capsules[c, 1] + s * (capsules[c, 4] - capsules[c, 1]) + r * ny
        at[k, 2] = capsules[c, 2] + s * (capsules[c, 5] - capsules[c, 2]) + r * nz
        facing[k, 0], facing[k, 1], facing[k, 2] = nx, ny, nz
        stands[k] = area[k] * (sides[c] if mantle[k] else caps[c])
