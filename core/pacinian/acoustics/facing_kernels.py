"""The kernel of `facing`: rows of B times the weights, tile by tile, in single precision.

What lies below a plane through a sample hides nothing that comes from above that plane. So a capsule is
computed only where no such plane is found between it and a tile of transducers.

Arguments shared by all: w: weights. tile, (4, T): of each transducer how far it is from the sample [m], and
the unit vector to it. near, (9, C): of each capsule, seen from the sample, one end of the axis, the way
to the other, the radius there, by how much the other is larger [m], and where on that way the axis is nearest, 0..1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled
from pacinian.acoustics.tapered import from_axis

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats, Gains, Indices, Singles

LANES = 16  # in whole vectors more is done for nothing, and sooner
NEAREST = f4(1e-30)  # [m^2]; keeps quotients finite
PARALLEL = f4(1e-6)  # squared sine of an angle that rounding could make
FAINT = f4(1e-3)  # as in `facing`
SLACK = f4(1e-3)  # of the edge: what rises by this does not count
FAR = 1e3  # [m]; no hand is as far from its array

POINT = numba.types.Array(numba.float64, 1, "C", readonly=True)
POINTS = numba.types.Array(numba.float64, 2, "C", readonly=True)
SOME, TABLE = numba.float32[::1], numba.float32[:, ::1]


@compiled(numba.void(SOME, SOME, TABLE, numba.int64, numba.int64, SOME))
def look(q: Singles, normal: Singles, r: Singles, first: int, count: int, w: Singles) -> None:
    """Write the weights at q of the transducers first..first + count, without a hand."""
    x, y, z, nx, ny, nz = q[0], q[1], q[2], normal[0], normal[1], normal[2]
    free = f4(1.0) if nx == f4(0.0) and ny == f4(0.0) and nz == f4(0.0) else f4(0.0)
    rx, ry, rz = (
        r[0, first : first + count],
        r[1, first : first + count],
        r[2, first : first + count],
    )
    for i in range(count):
        dx, dy, dz = rx[i] - x, ry[i] - y, rz[i] - z
        inverse = f4(1.0) / np.sqrt(dx * dx + dy * dy + dz * dz + NEAREST)
        cosine = (dx * nx + dy * ny + dz * nz) * inverse + free
        w[i] = cosine if cosine > f4(0.0) else f4(0.0)


@compiled(numba.void(SOME, TABLE, numba.int64, numba.int64, TABLE))
def aim(q: Singles, r: Singles, first: int, count: int, tile: Singles) -> None:
    """Write how far the transducers first..first + count are from q, and where, to `tile`."""
    rx, ry, rz = (
        r[0, first : first + count],
        r[1, first : first + count],
        r[2, first : first + count],
    )
    away = tile[0]
    for i in range(count):
        dx, dy, dz = rx[i] - q[0], ry[i] - q[1], rz[i] - q[2]
        away[i] = np.sqrt(dx * dx + dy * dy + dz * dz + NEAREST)
    for k in range(3):
        u, x, rx = tile[1 + k], q[k], r[k, first : first + count]
        for i in range(count):
            u[i] = (rx[i] - x) / away[i]


@compiled("f4(f4, f4, f4, f4)")
def _deepest(t: np.float32, gap: np.float32, across: np.float32, grows: np.float32) -> np.float32:
    """Where on an axis a way is deepest, if it is nearest at t, `gap` away: as in `facing._depth`."""
    room = across * max(across - grows * grows, f4(0.0)) + NEAREST
    return min(max(t + grows * gap / np.sqrt(room), f4(0.0)), f4(1.0))


@compiled("f4(f4, f4)")
def _passing(deep: np.float32, sharp: np.float32) -> np.float32:
    """What passes a capsule so deep [m]. sharp: one over the edge [1/m]."""
    u = min(max(f4(1.0) - deep * sharp, f4(0.0)), f4(1.0))
    return u * u * (f4(3.0) - f4(2.0) * u)


@compiled(numba.void(TABLE, numba.int64, numba.float32, TABLE, SOME))
def _shade_ends(near: Singles, c: int, sharp: np.float32, tile: Singles, w: Singles) -> None:
    """Multiply weights by what a capsule lets through to transducers in it or before it: there the way is deepest."""
    a, e, grows = near[0:3, c], near[3:6, c], near[7, c]
    ee, ae = np.sum(e * e) + NEAREST, np.sum(a * e)
    for i in range(w.size):
        end, u = tile[0, i], tile[1:4, i]
        eu, au = np.sum(e * u), np.sum(a * u)
        across = max(ee - eu * eu, PARALLEL * ee)
        t = (eu * au - ae) / across
        gap = a + t * e - (au + eu * t) * u
        t = _deepest(t, np.sqrt(np.sum(gap * gap)), across, grows)
        if au + eu * t > end:
            t = (eu * end - ae) / ee
            gap = a + t * e - end * u
            t = _deepest(t, np.sqrt(np.sum(gap * gap)), ee, grows)
            gap = a + t * e - end * u
            w[i] *= _passing(near[6, c] + t * grows - np.sqrt(np.sum(gap * gap)), sharp)


@compiled(numba.void(TABLE, numba.int64, numba.float32, TABLE, SOME))
def shade(near: Singles, c: int, edge: np.float32, tile: Singles, w: Singles) -> None:
    """Multiply weights by what a capsule lets through: see `facing._depth`."""
    ax, ay, az, ex, ey, ez, radius, grows, nearest = (
        near[0, c], near[1, c], near[2, c], near[3, c], near[4, c], near[5, c], near[6, c], near[7, c], near[8, c],
    )  # fmt: skip
    away, ux, uy, uz = tile[0], tile[1], tile[2], tile[3]
    ee = ex * ex + ey * ey + ez * ez + NEAREST
    ae = ax * ex + ay * ey + az * ez
    sharp, least = f4(1.0) / edge, PARALLEL * ee
    for i in range(w.size):
        eu = ex * ux[i] + ey * uy[i] + ez * uz[i]
        au = ax * ux[i] + ay * uy[i] + az * uz[i]
        across = max(ee - eu * eu, least)
        t = (eu * au - ae) / across  # where the lines are nearest
        s = au + eu * t
        x, y, z = ax + t * ex - s * ux[i], ay + t * ey - s * uy[i], az + t * ez - s * uz[i]
        t = _deepest(t, np.sqrt(x * x + y * y + z * z), across, grows)
        t = t if au + eu * t > f4(0.0) else nearest  # deepest at the sample
        s = max(au + eu * t, f4(0.0))
        x, y, z = ax + t * ex - s * ux[i], ay + t * ey - s * uy[i], az + t * ez - s * uz[i]
        passing = _passing(radius + t * grows - np.sqrt(x * x + y * y + z * z), sharp)
        w[i] *= passing if s <= away[i] else f4(1.0)  # else deepest at the transducer: below
    aa, shortest = ax * ax + ay * ay + az * az, np.min(away[: w.size])
    if max(aa, aa + f4(2.0) * ae + ee) >= shortest * shortest:
        _shade_ends(near, c, sharp, tile, w)


@compiled("f4(f4, f4, f4)")
def tangent(along: np.float32, across: np.float32, r: np.float32) -> np.float32:
    """Sine of the angle by which a ray turns from straight ahead until it touches a circle of radius r.

    along, across: how far ahead and to that side the circle's middle is. 1 where it turns by 90 degrees
    or more, -1 where it begins in the circle.
    """
    square = along * along + across * across + NEAREST
    k = np.sqrt(max(square - r * r, f4(0.0)))
    sine = (k * across - r * along) / square
    sine = sine if r * across + k * along >= f4(0.0) else f4(1.0)
    return sine if square > r * r else f4(-1.0)


@compiled(numba.void(TABLE, numba.int64, SOME, numba.float32, numba.boolean[::1]))
def sift(near: Singles, count: int, box: Singles, slack: np.float32, hides: Flags) -> None:
    """Write whether each capsule may hide something of a box: its middle and half of its sides, (6,) [m].

    Two planes are tried for each that touch it on the box's side: the nearest place of its axis decides
    to which side one leans, its middle the other.
    """
    bx, by, bz = box[0], box[1], box[2]
    inverse = f4(1.0) / np.sqrt(bx * bx + by * by + bz * bz + NEAREST)
    ux, uy, uz = bx * inverse, by * inverse, bz * inverse
    ax, ay, az, ex, ey, ez = near[0], near[1], near[2], near[3], near[4], near[5]
    radius, grows, nearest = near[6], near[7], near[8]
    for c in range(count):
        hidden = True
        rp, rq = max(radius[c], f4(0.0)), max(radius[c] + grows[c], f4(0.0))
        px, py, pz = ax[c], ay[c], az[c]
        qx, qy, qz = px + ex[c], py + ey[c], pz + ez[c]
        p, q = px * ux + py * uy + pz * uz, qx * ux + qy * uy + qz * uz
        for t in (f4(0.5), nearest[c]):
            x, y, z = px + t * ex[c], py + t * ey[c], pz + t * ez[c]
            along = x * ux + y * uy + z * uz
            x, y, z = x - along * ux, y - along * uy, z - along * uz
            inverse = f4(1.0) / np.sqrt(x * x + y * y + z * z + NEAREST)
            x, y, z = x * inverse, y * inverse, z * inverse
            sine = min(
                tangent(p, px * x + py * y + pz * z, rp), tangent(q, qx * x + qy * y + qz * z, rq)
            )
            cosine = np.sqrt(max(f4(0.0), f4(1.0) - sine * sine))
            x, y, z = sine * ux - cosine * x, sine * uy - cosine * y, sine * uz - cosine * z
            low = bx * x + by * y + bz * z - box[3] * abs(x) - box[4] * abs(y) - box[5] * abs(z)
            high = max(px * x + py * y + pz * z + rp, qx * x + qy * y + qz * z + rq)
            hidden = hidden and bool(sine <= f4(0.0) or low < f4(0.0) or high > slack)
        hides[c] = hidden


@compiled(numba.int64(POINT, POINTS, SOME, POINT, numba.float32, TABLE))
def gather(
    q: Floats, capsules: Floats, normal: Singles, origin: Floats, slack: np.float32, near: Singles
) -> int:  # fmt: skip
    """Write the capsules that rise above the tangent plane at q, as seen from there; return how many.

    One that q lies in ends at q.
    """
    free = normal[0] == f4(0.0) and normal[1] == f4(0.0) and normal[2] == f4(0.0)
    found = 0
    for c in range(capsules.shape[0]):
        a_high, e_high, far = 0.0, 0.0, 0.0
        for k in range(3):
            a, e = capsules[c, k] - q[k], capsules[c, 3 + k] - capsules[c, k]
            near[k, found], near[3 + k, found] = f4(a), f4(e)
            a_high += a * normal[k]
            e_high += e * normal[k]
            far = max(far, abs(capsules[c, k] - origin[k]))
        grows = capsules[c, 7] - capsules[c, 6]
        high = a_high + max(e_high + grows, 0.0)
        if far >= FAR or not (free or high + capsules[c, 6] > slack):
            continue
        _, _, _, away, radius, t = from_axis(capsules, c, q[0], q[1], q[2])
        r = capsules[c, 6] - max(radius - away, 0.0)
        near[6, found], near[7, found], near[8, found] = f4(r), f4(grows), f4(t)
        if free or high + r > slack:
            found += 1
    return found


@compiled("i8(i8)")
def _whole(count: int) -> int:
    """So many, rounded up to whole vectors."""
    return (count + LANES - 1) // LANES * LANES


@compiled(
    numba.void(
        POINTS, POINTS, POINTS, numba.float64, POINT, TABLE, TABLE, numba.int64[::1],
        numba.complex64[:, ::1],
    )
)  # fmt: skip
def weigh(
    points: Floats, normals: Floats, capsules: Floats, edge: float, origin: Floats,
    r: Singles, boxes: Singles, rows: Indices, out: Gains,
) -> None:  # fmt: skip
    """Multiply rows of B, `out`, (M, N), by the weights of samples at `points`, (K, 3) for rows (K,).

    normals: (M, 3). capsules: (C, 8). origin: of r, the transducers' positions (3, N) [m]. boxes: around
    equal tiles of them, (tiles, 6).
    """
    N, C, tiles = r.shape[1], capsules.shape[0], boxes.shape[0]
    step = (N + tiles - 1) // tiles
    tile, near = np.empty((4, step + LANES), np.float32), np.zeros((9, C + LANES), np.float32)
    weights, box = np.empty(N + LANES, np.float32), np.empty(6, np.float32)
    hides = np.zeros(C + LANES, np.bool_)
    q, normal = np.empty(3, np.float32), np.empty(3, np.float32)
    slack = SLACK * f4(edge)
    for k in range(points.shape[0]):
        m = rows[k]
        for axis in range(3):
            q[axis] = f4(points[k, axis] - origin[axis])
            normal[axis] = f4(normals[m, axis])
        found = gather(points[k], capsules, normal, origin, slack, near)
        for j in range(tiles):
            first = j * step
            count = min(_whole(step), N - first)  # the next tile begins anew where this one ends
            w, high = weights[first : first + count], f4(0.0)
            for axis in range(3):
                box[axis], box[3 + axis] = boxes[j, axis] - q[axis], boxes[j, 3 + axis]
                high += box[axis] * normal[axis] + box[3 + axis] * abs(normal[axis])
            if high < f4(0.0):
                w[:] = f4(0.0)
                continue
            look(q, normal, r, first, count, w)
            if not found:
                continue
            sift(near, _whole(found), box, slack, hides)
            aimed = False
            for c in range(found):
                if hides[c]:
                    if not aimed:
                        aim(q, r, first, count, tile)
                    aimed = True
                    shade(near, c, f4(edge), tile, w)
        row, size = out[m], f4(0.0)
        for n in range(N):
            row[n] = complex(row[n].real * weights[n], row[n].imag * weights[n])
            size += weights[n] * weights[n]
        if size < FAINT * FAINT:
            row[:] = 0.0
