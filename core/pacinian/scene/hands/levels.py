"""Points spread evenly over a skin, coarse ones among the fine, and what fine ones share with coarse.

Two points are on the same side of the skin if their normals are less than 90 degrees apart and they are
not on two different fingers. Only points on the same side keep their distance, and only they share.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

FINEST = 1.75e-3  # [m], a fifth of a wavelength: pressure falls from full to nothing within 3 mm of a rim
SPACINGS = FINEST * np.sqrt(2.0) ** np.arange(9)
"""Of the levels, fine to coarse, (9,) [m]."""
GRAIN = 0.9e-3  # [m] between the points that those of a skin are chosen from
SHARERS = 3  # nodes that a point is shared among
FAR = 1e150  # its square is a number


class Surface(NamedTuple):
    """N points of a skin at rest. points: (N, 3) [m]. normals: (N, 3). fingers: 0 if none, (N,)."""

    points: Floats
    normals: Floats
    fingers: Indices

    def only(self, kept: Indices) -> Surface:
        """Those points, in the order wanted."""
        return Surface(self.points[kept], self.normals[kept], self.fingers[kept])


class Share(NamedTuple):
    """What each of K points gives to the nodes of a level: indices (K, 3), weights (K, 3), summing to 1."""

    indices: Indices
    weights: Floats


def spread(surface: Surface, spacing: float = FINEST) -> tuple[Indices, Floats, Indices]:
    """Choose points one after the other, each the one farthest from those before it.

    Stops when none on the same side is `spacing` [m] away from all. Returns which, (K,); how far each
    then was from those before, (K,) [m], never growing; and of all N points, (N,), the nearest chosen.
    """
    N = len(surface.points)
    order, apart = np.empty(N, dtype=np.intp), np.empty(N)
    nearest = np.zeros(N, dtype=np.intp)
    K = _spread(*surface, spacing, order, apart, nearest)
    return order[:K].copy(), apart[:K].copy(), nearest


def gathered(to: Indices, area: Floats, count: int = 0) -> Floats:
    """The sums of the areas, (N,), given to each of at least `count` points."""
    return np.asarray(np.bincount(to, area, count), dtype=np.float64)


def share(surface: Surface, nodes: int) -> Share:
    """Share every point among the nearest of the first so many.

    Weights are (1/D - 1/D_4)^2, normalised, with D the distance over the cosine between the normals, and
    D_4 that of the fourth nearest node, so that a node counts for nothing when it comes or goes [1]; a
    node's own point goes to it alone.

    [1] Franke and Nielson, Smooth interpolation of large sets of scattered data, 1980 (modified Shepard).
    """
    K = len(surface.points)
    out = Share(np.zeros((K, SHARERS), dtype=np.intp), np.zeros((K, SHARERS)))
    _share(*surface, nodes, *out)
    return out


@compiled("f8(f8[:, ::1], f8[:, ::1], i8[::1], i8, i8)")
def _cosine(points: Floats, normals: Floats, fingers: Indices, i: int, j: int) -> float:
    """Between the normals of two points on the same side, else 0."""
    if fingers[i] != fingers[j] and fingers[i] and fingers[j]:
        return 0.0
    dot = (
        normals[i, 0] * normals[j, 0]
        + normals[i, 1] * normals[j, 1]
        + normals[i, 2] * normals[j, 2]
    )
    return dot if dot > 0.0 else 0.0


@compiled("i8(f8[:, ::1], f8[:, ::1], i8[::1], f8, i8[::1], f8[::1], i8[::1])")
def _spread(
    points: Floats, normals: Floats, fingers: Indices, spacing: float,
    order: Indices, apart: Floats, nearest: Indices,
) -> int:  # fmt: skip
    N = points.shape[0]
    square = np.full(N, FAR)
    chosen, K = 0, 0
    while K < N and square[chosen] >= spacing * spacing:
        order[K], apart[K] = chosen, np.sqrt(square[chosen])
        best, following = -1.0, 0
        for i in range(N):
            dx = points[i, 0] - points[chosen, 0]
            dy = points[i, 1] - points[chosen, 1]
            dz = points[i, 2] - points[chosen, 2]
            away = dx * dx + dy * dy + dz * dz
            if away < square[i] and _cosine(points, normals, fingers, i, chosen) > 0.0:
                square[i], nearest[i] = away, K
            if square[i] > best:
                best, following = square[i], i
        chosen = following
        K += 1
    return K


@compiled("void(f8[:, ::1], f8[:, ::1], i8[::1], i8, i8[:, ::1], f8[:, ::1])")
def _share(
    points: Floats, normals: Floats, fingers: Indices, nodes: int,
    indices: Indices, weights: Floats,
) -> None:  # fmt: skip
    best, which = np.empty(SHARERS + 1), np.empty(SHARERS + 1, dtype=np.int64)
    for k in range(points.shape[0]):
        if k < nodes:
            indices[k], weights[k, 0] = k, 1.0
            continue
        best[:] = FAR
        for n in range(nodes):
            dx = points[k, 0] - points[n, 0]
            dy = points[k, 1] - points[n, 1]
            dz = points[k, 2] - points[n, 2]
            square, i = dx * dx + dy * dy + dz * dz, SHARERS
            if best[i] * best[i] <= square:  # D is no less
                continue
            cosine = _cosine(points, normals, fingers, k, n)
            if cosine <= 0.0:
                continue
            D = np.sqrt(square / cosine)
            if best[i] <= D:
                continue
            while i > 0 and best[i - 1] > D:
                best[i], which[i] = best[i - 1], which[i - 1]
                i -= 1
            best[i], which[i] = D, n
        indices[k] = which[0]
        beyond = (1.0 - 1e-6) / best[SHARERS]
        total = 0.0
        for i in range(SHARERS):
            if best[i] < FAR:
                indices[k, i] = which[i]
                weights[k, i] = (1.0 / best[i] - beyond) ** 2
                total += weights[k, i]
        for i in range(SHARERS):
            weights[k, i] /= total
