"""The kernels of contact: which points of a skin may touch an object, and who takes their forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.compiled import compiled
from pacinian.scene.hands.capsules import buried_in as buried

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

TINY = 1e-300


@compiled(
    "i8(f8[:, ::1], f8[:, ::1], i8[::1], f8[:, ::1], f8[::1], f8, f8[:, ::1], f8[:, ::1],"
    " i8[::1], f8[:, ::1])"
)
def candidates(
    points: Floats, normals: Floats, bone: Indices, bounds: Floats,
    centre: Floats, radius: float, R: Floats, corners: Floats,
    which: Indices, local: Floats,
) -> int:  # fmt: skip
    """Write which points of a skin lie in a sphere and face any of the corners, and where in its frame.

    points, normals: (K, 3). bone: of each, (K,). bounds: sphere of each bone, (C, 4). R: the frame's axes as
    columns, (3, 3). corners: (V, 3); without any, points need not face anything. which: (K,). local:
    (K, 3). Returns how many there are.
    """
    C = bounds.shape[0]
    touches = np.empty(C, dtype=np.bool_)
    for c in range(C):
        square = 0.0
        for k in range(3):
            square += (bounds[c, k] - centre[k]) ** 2
        touches[c] = square <= (bounds[c, 3] + radius) ** 2
    count = 0
    for i in range(points.shape[0]):
        if not touches[bone[i]]:
            continue
        x, y, z = points[i, 0] - centre[0], points[i, 1] - centre[1], points[i, 2] - centre[2]
        if x * x + y * y + z * z > radius * radius:
            continue
        faces = corners.shape[0] == 0
        for v in range(corners.shape[0]):
            along = 0.0
            for k in range(3):
                along += normals[i, k] * (corners[v, k] - points[i, k])
            if along > 0.0:
                faces = True
                break
        if faces:
            which[count] = i
            for k in range(3):
                local[count, k] = x * R[0, k] + y * R[1, k] + z * R[2, k]
            count += 1
    return count


@compiled("UniTuple(f8, 6)(f8[:, ::1], f8[::1])")
def box(bounds: Floats, out: Floats) -> tuple[float, float, float, float, float, float]:
    """Write, and return, the lower and the upper corner of the box around spheres, (C, 4)."""
    for k in range(3):
        out[k], out[3 + k] = 1e300, -1e300
        for c in range(bounds.shape[0]):
            out[k] = min(out[k], bounds[c, k] - bounds[c, 3])
            out[3 + k] = max(out[3 + k], bounds[c, k] + bounds[c, 3])
    return out[0], out[1], out[2], out[3], out[4], out[5]


@compiled("f8(f8[::1], f8[::1], f8[:, ::1], f8)")
def _seen(point: Floats, normal: Floats, some: Floats, enough: float) -> float:
    """The mean of cos^2 of the incidence from some places, (V, 3); at least `enough` where it is more."""
    V = some.shape[0]
    total = 0.0
    for v in range(V):
        along, away = 0.0, 0.0
        for k in range(3):
            d = some[v, k] - point[k]
            along += normal[k] * d
            away += d * d
        if along > 0.0:
            total += along * along / max(away, TINY)
            if total >= enough * V:
                break
    return float(total / V)


@compiled(
    "i8(f8[::1], i8[::1], f8, f8, f8, f8[:, ::1], f8[:, ::1], f8[::1], i8[::1], f8[::1], f8[:, ::1],"
    " f8[:, ::1], f8, f8, i8[::1], f8[::1])"
)
def press(
    d: Floats, which: Indices, reach: float, stiffness: float, most: float,
    points: Floats, normals: Floats, area: Floats, bone: Indices, slack: Floats, capsules: Floats,
    some: Floats, hardly: float, well: float,
    inside: Indices, force: Floats,
) -> int:  # fmt: skip
    """Write which points of a skin are pressed, and with how much.

    d: signed distance of the points `which`, (I,) [m]. reach [m], stiffness [Pa/m], most [Pa]: the material's
    law. points, normals, area, bone, slack: of the skin, (K, 3), (K,). capsules: of the hand, (C, 8), inside of
    which, deeper than the slack, there is no skin; none for a mesh. some: places that must see the skin, (V, 3);
    none for any. hardly, well: as in `resolving.grazing`. inside: indices into `which`, (I,). force: of each [N],
    (I,). Returns how many are pressed.
    """
    count = 0
    touched = np.empty(which.size, dtype=np.int64)
    for i in range(which.size):
        depth = reach - d[i]
        if depth > 0.0:
            inside[count], touched[count] = i, which[i]
            force[count] = min(depth * stiffness, most)
            count += 1
    deep = np.zeros(count, dtype=np.bool_)
    if capsules.shape[0]:
        buried(capsules, points, bone, slack, touched[:count], deep)
    kept = 0
    for n in range(count):
        k = touched[n]
        share = 0.0 if deep[n] else 1.0
        if some.shape[0] and not deep[n]:
            x = (_seen(points[k], normals[k], some, well) - hardly) / (well - hardly)
            x = min(max(x, 0.0), 1.0)
            share = x * x * (3.0 - 2.0 * x)
        if share > 0.0 and force[n] * area[k] > 0.0:
            inside[kept] = inside[n]
            force[kept] = share * force[n] * area[k]
            kept += 1
    return kept


@compiled("i8(i8[::1], f8[:, ::1], f8[:, ::1], f8[::1], f8, f8, f8[::1], i8[::1])")
def stale(
    which: Indices, local: Floats, places: Floats, known: Floats, beyond: float, deep: float,
    d: Floats, ask: Indices,
) -> int:  # fmt: skip
    """Write distances of points as far as those known of where they were suffice.

    A distance changes by no more than the point has moved. which: points, (I,). local: where they are,
    (I, 3). places, known: of all points, where each distance was asked, far away if never, and what it was,
    (K, 3), (K,). d: (I,), if farther outside than `beyond` or deeper inside than `deep` [m] not exactly. ask: the
    places in `which` of the others, (I,). Returns how many these are.
    """
    count = 0
    for i in range(which.size):
        k = which[i]
        away = 0.0
        for x in range(3):
            away += (local[i, x] - places[k, x]) ** 2
        away = np.sqrt(away)
        if known[k] - away > beyond:
            d[i] = known[k] - away
        elif known[k] + away < -deep:
            d[i] = known[k] + away
        else:
            ask[count] = i
            count += 1
    return count


@compiled("i8(i8[::1], f8[::1], i8[:, ::1], f8[:, ::1], f8, f8[::1], i8[::1])")
def share_out(
    touched: Indices, force: Floats, indices: Indices, weights: Floats, least: float,
    got: Floats, nodes: Indices,
) -> int:  # fmt: skip
    """Share forces on points out among the nodes of a level; write which nodes got any, in order.

    touched: (T,). force: (T,) [N]. indices, weights: of every point, (K, 3). least: share of the largest that
    counts as any. got: by node, (count,) [N]. nodes: (count,). Returns how many got any.
    """
    got[:] = 0.0
    for t in range(touched.size):
        k = touched[t]
        for j in range(indices.shape[1]):
            got[indices[k, j]] += weights[k, j] * force[t]
    most = np.max(got)
    count = 0
    for n in range(got.size):
        if got[n] > least * most:
            nodes[count] = n
            count += 1
    return count


@compiled("i8(f8[:, ::1], f8[:, ::1], i8, f8[:, ::1], f8[::1], f8, f8, i8[::1], i8[::1])")
def around(
    points: Floats, normals: Floats, count: int, q: Floats, centre: Floats, inner: float,
    outer: float, which: Indices, nearest: Indices,
) -> int:  # fmt: skip
    """Write which of the first `count` points of a skin lie beside q, (K, 3), and by which of these they are nearest.

    points, normals: (N, 3). inner, outer: how far away the nearest of q is [m]. centre: (3,); points that face away
    from it are left out. which, nearest: (count,). Returns how many there are.
    """
    low, high = q[0].copy(), q[0].copy()
    for k in range(len(q)):
        for i in range(3):
            low[i], high[i] = min(low[i], q[k, i]), max(high[i], q[k, i])
    found = 0
    for n in range(count):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        if not (
            low[0] - outer < x < high[0] + outer
            and low[1] - outer < y < high[1] + outer
            and low[2] - outer < z < high[2] + outer
        ):
            continue
        faces = normals[n, 0] * (centre[0] - x) + normals[n, 1] * (centre[1] - y)
        if faces + normals[n, 2] * (centre[2] - z) <= 0.0:
            continue
        best, at = outer * outer, -1
        for k in range(len(q)):
            square = (q[k, 0] - x) ** 2 + (q[k, 1] - y) ** 2 + (q[k, 2] - z) ** 2
            if square < best:
                best, at = square, k
                if square < inner * inner:
                    break
        if at >= 0 and best >= inner * inner:
            which[found], nearest[found] = n, at
            found += 1
    return found
