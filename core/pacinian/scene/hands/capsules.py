"""The hand's flesh as a union of tapered capsules, one around each bone and some that fill the palm.

Two that share a joint share its sphere, so that the skin of a straight finger has no steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.compiled import compiled
from pacinian.acoustics.tapered import from_axis
from pacinian.scene.hands.bones import ENDS

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.types import Flags, Floats, Indices

ROUNDING = 1e-10  # [m]: what lies so deep inside may be on it
SEARCH = 1000  # steps from inside of the union to its surface
TURNS = 50  # of them may each go out of the capsule that is deepest there
ARRIVED = 1e-12  # [m]
TINY = 1e-15  # [m]; nearer to an axis than this, there is no direction away from it


class Nearest(NamedTuple):
    """The nearest skin to each of P points.

    points: on the skin, (P, 3) [m]. normals: its outward normals there, (P, 3). distance: to the skin,
    negative inside, (P,) [m]. bone: whose skin, (P,).
    """

    points: Floats
    normals: Floats
    distance: Floats
    bone: Indices


def capsules(hand: Hand) -> Floats:
    """A hand's C capsules, (C, 8) [m]: both ends of the axis, and the radius at either, the mean of its joints'."""
    if hand.joints is None:
        return np.empty((0, 8))
    out = np.empty((len(ENDS), 8))
    _capsules(hand.joints.copy(), hand.radii.copy(), ENDS, out)
    return out


def bounds(capsules: Floats) -> Floats:
    """A sphere around each capsule: its centre and radius, (C, 4) [m]."""
    out = np.empty((len(capsules), 4))
    _bounds(capsules, out)
    return out


def distance_to_skin(capsules: Floats, points: Floats) -> Floats:
    """Signed distance of points, (P, 3), to the union of the capsules, (P,) [m]; negative inside.

    Exact outside; inside it is the depth within the capsule that the point is deepest in, and the skin
    may be further away.
    """
    return _found(capsules, points, 0).distance


def closest(capsules: Floats, points: Floats) -> Nearest:
    """The nearest skin of the union of the capsules to points, (P, 3).

    Exact outside. From inside, the way goes out of the capsule that the point is deepest in, and on out
    of the next if that ends in another; if that goes round in circles, straight on. The distance is as of
    `distance_to_skin`. From an axis, where all ways are the same, it goes to some side.
    """
    return _found(capsules, points, SEARCH)


def _found(capsules: Floats, points: Floats, steps: int) -> Nearest:
    """`closest` in at most so many steps; with 0 the distances alone are to be used."""
    P = len(points)
    out = Nearest(np.empty((P, 3)), np.empty((P, 3)), np.empty(P), np.empty(P, dtype=np.intp))
    _nearest(np.ascontiguousarray(capsules), np.ascontiguousarray(points), steps, *out)
    return out


def buried(capsules: Floats, points: Floats, bone: Indices, slack: Floats, which: Indices) -> Flags:
    """Whether each of the points `which`, (K,), lies inside of a capsule, deeper than its slack, (K,).

    points: (P, 3). bone: each point's own capsule, which does not count, (P,). slack: (P,) [m].
    """
    out = np.empty(len(which), dtype=np.bool_)
    buried_in(capsules, points, bone, slack, np.ascontiguousarray(which), out)
    return out


@compiled("void(f8[:, ::1], f8[::1], i8[:, ::1], f8[:, ::1])")
def _capsules(joints: Floats, radii: Floats, ends: Indices, out: Floats) -> None:
    for c in range(ends.shape[0]):
        i, j, k, m = ends[c, 0], ends[c, 1], ends[c, 2], ends[c, 3]
        for x in range(3):
            out[c, x] = (joints[i, x] + joints[j, x]) / 2.0
            out[c, 3 + x] = (joints[k, x] + joints[m, x]) / 2.0
        out[c, 6], out[c, 7] = (radii[i] + radii[j]) / 2.0, (radii[k] + radii[m]) / 2.0


@compiled("void(f8[:, ::1], f8[:, ::1])")
def _bounds(capsules: Floats, out: Floats) -> None:
    for c in range(capsules.shape[0]):
        square = 0.0
        for x in range(3):
            half = (capsules[c, 3 + x] - capsules[c, x]) / 2.0
            out[c, x] = capsules[c, x] + half
            square += half * half
        out[c, 3] = np.sqrt(square) + max(capsules[c, 6], capsules[c, 7])


@compiled("Tuple((f8, i8))(f8[:, ::1], f8, f8, f8)")
def _union(capsules: Floats, x: float, y: float, z: float) -> tuple[float, int]:
    """Signed distance of a point to the union [m], and the capsule it is nearest to or deepest in."""
    best, bone = 1e300, 0
    for c in range(capsules.shape[0]):
        _, _, _, away, radius, _ = from_axis(capsules, c, x, y, z)
        if away - radius < best:
            best, bone = away - radius, c
    return best, bone


@compiled("UniTuple(f8, 3)(f8[:, ::1], i8)")
def _side(capsules: Floats, c: int) -> tuple[float, float, float]:
    """A direction across a capsule's axis."""
    ux, uy, uz = (
        capsules[c, 3] - capsules[c, 0],
        capsules[c, 4] - capsules[c, 1],
        capsules[c, 5] - capsules[c, 2],
    )
    if abs(ux) > abs(uz):
        size = np.sqrt(ux * ux + uy * uy)
        return -uy / size, ux / size, 0.0
    size = np.sqrt(uy * uy + uz * uz)
    return (0.0, -uz / size, uy / size) if size > 0.0 else (0.0, 0.0, 1.0)


@compiled("Tuple((f8, f8, f8, f8))(f8[:, ::1], i8, f8, f8, f8)")
def _outward(
    capsules: Floats, c: int, x: float, y: float, z: float
) -> tuple[float, float, float, float]:
    """The direction from a capsule's axis to a point, and how far that way its surface is [m]."""
    nx, ny, nz, size, radius, _ = from_axis(capsules, c, x, y, z)
    if size > TINY:
        nx, ny, nz = nx / size, ny / size, nz / size
    else:
        nx, ny, nz = _side(capsules, c)
    return nx, ny, nz, radius - size


@compiled("void(f8[:, ::1], f8[:, ::1], i8, f8[:, ::1], f8[:, ::1], f8[::1], i8[::1])")
def _nearest(
    capsules: Floats, points: Floats, steps: int,
    surface: Floats, normals: Floats, distance: Floats, bone: Indices,
) -> None:  # fmt: skip
    for p in range(points.shape[0]):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        away, c = _union(capsules, x, y, z)
        distance[p] = away
        nx, ny, nz = 0.0, 0.0, 0.0
        for step in range(steps):
            if step < TURNS:
                nx, ny, nz, out = _outward(capsules, c, x, y, z)
            else:
                out = -away
            x, y, z, bone[p] = x + out * nx, y + out * ny, z + out * nz, c
            away, c = _union(capsules, x, y, z)
            if away > -ARRIVED:
                if step >= TURNS:
                    bone[p] = c
                    nx, ny, nz, _ = _outward(capsules, c, x, y, z)
                break
        surface[p, 0], surface[p, 1], surface[p, 2] = x, y, z
        normals[p, 0], normals[p, 1], normals[p, 2] = nx, ny, nz


@compiled("void(f8[:, ::1], f8[:, ::1], i8[::1], f8[::1], i8[::1], b1[::1])")
def buried_in(
    capsules: Floats, points: Floats, bone: Indices, slack: Floats, which: Indices, out: Flags
) -> None:
    """The kernel of `buried`. out: (I,). `from_axis`, but what is the same for all points is done once."""
    C = capsules.shape[0]
    balls = np.empty((C, 4))
    _bounds(capsules, balls)
    touching, touched = np.empty((C, C), dtype=np.int64), np.zeros(C, dtype=np.int64)
    for c in range(C):
        for other in range(C):
            dx, dy, dz = (
                balls[c, 0] - balls[other, 0],
                balls[c, 1] - balls[other, 1],
                balls[c, 2] - balls[other, 2],
            )
            reach = balls[c, 3] + balls[other, 3]
            if c != other and dx * dx + dy * dy + dz * dz < reach * reach:
                touching[c, touched[c]] = other
                touched[c] += 1
    start, u, inverse, tilt = np.empty((C, 3)), np.zeros((C, 3)), np.zeros(C), np.zeros(C)
    radius, grows = np.maximum(capsules[:, 6], capsules[:, 7]), np.zeros(C)
    for c in range(C):
        difference, square = capsules[c, 7] - capsules[c, 6], 0.0
        for x in range(3):
            square += (capsules[c, 3 + x] - capsules[c, x]) ** 2
        first = 3 if difference > 0.0 else 0
        if square > difference * difference:  # else one sphere holds the other
            first, radius[c], grows[c], inverse[c] = 0, capsules[c, 6], difference, 1.0 / square
            tilt[c] = difference / np.sqrt(square * (square - difference * difference))
            for x in range(3):
                u[c, x] = capsules[c, 3 + x] - capsules[c, x]
        for x in range(3):
            start[c, x] = capsules[c, first + x]
    for i in range(which.size):
        k = which[i]
        c = bone[k]
        out[i] = False
        for n in range(touched[c]):
            other = touching[c, n]
            dx = points[k, 0] - start[other, 0]
            dy = points[k, 1] - start[other, 1]
            dz = points[k, 2] - start[other, 2]
            t = (dx * u[other, 0] + dy * u[other, 1] + dz * u[other, 2]) * inverse[other]
            vx, vy, vz = dx - t * u[other, 0], dy - t * u[other, 1], dz - t * u[other, 2]
            t += tilt[other] * np.sqrt(vx * vx + vy * vy + vz * vz)
            t = min(max(t, 0.0), 1.0)
            dx, dy, dz = dx - t * u[other, 0], dy - t * u[other, 1], dz - t * u[other, 2]
            within = radius[other] + t * grows[other] - max(slack[k], ROUNDING)
            if within > 0.0 and dx * dx + dy * dy + dz * dz < within * within:
                out[i] = True
                break
