"""Levels of detail of a skin: evenly spread points, of which coarse levels use a part, and how nodes share forces.

Two points are on the same side of the skin if their normals are less than 90 degrees apart and they are not on two
different fingers. Points keep their distance from, and share forces with, only points on the same side.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.errors import ArgumentError
from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.types import Floats, Indices

# Finest spacing, a fifth of a wavelength [m]. Pressure falls from full to 0 within 3 mm of a rim.
FINEST_SKIN_SPACING = 1.75e-3
SPACINGS = FINEST_SKIN_SPACING * np.sqrt(2.0) ** np.arange(9)
"""Spacings of the levels, fine to coarse, (9,) [m]."""
GRAIN = 0.9e-3  # spacing of the candidates for the points of a skin [m]
# Spacings of the levels between the points of a skin, over that of its finest level. The first has all candidates.
BETWEEN = 0.4, 0.5, 0.6
SHARERS = 3  # number of nodes that share a point's force


class SkinNodes(NamedTuple):
    """N points of a skin at rest. points: (N, 3) [m]. normals: (N, 3). fingers: 0 for the palm, (N,)."""

    points: Floats
    normals: Floats
    fingers: Indices

    def only(self, kept: Indices) -> SkinNodes:
        """Return the points `kept`, in that order."""
        return SkinNodes(self.points[kept], self.normals[kept], self.fingers[kept])


class Share(NamedTuple):
    """The nodes of a level that share the force of each of K points: indices, (K, 3), and weights, (K, 3).

    The weights of a point sum to 1.
    """

    indices: Indices
    weights: Floats


class Between(NamedTuple):
    """E points between the K points of a skin, sorted by the nearest of those.

    first: where the points nearest to each of the K points begin, and where the last end, (K + 1,). apart: distance of
    each from those chosen before it, 0 for those that only the finest level uses, (E,) [m]. levels: spacing of each
    level, fine to coarse [m]. area: for each level, the area at rest that each of the K + E points represents, 0 for
    those that it does not use, (K + E,) [m^2].
    """

    first: Indices
    apart: Floats
    levels: tuple[float, ...]
    area: tuple[Floats, ...]

    def find(self, near: Indices, level: int) -> Indices:
        """Return the numbers, from 0 on, of the level's points that are nearest to the points `near`, (I,)."""
        start, count = self.first[near], self.first[near + 1] - self.first[near]
        ends = np.cumsum(count)
        which: Indices = np.arange(int(ends[-1]) if len(ends) else 0) + np.repeat(
            start - ends + count, count
        )
        return which[np.flatnonzero(self.apart[which] >= self.levels[level])] if level else which


class FineSpread(NamedTuple):
    """Evenly spread points, and those between them.

    order: which of the candidates they are, first the K points, then those between them, sorted by the nearest of
    these, (K + E,). apart: of the K points, (K,) [m]. area: that each of the K points represents, (K,) [m^2].
    """

    order: Indices
    apart: Floats
    area: Floats
    between: Between


def spread_finely(surface: SkinNodes, area: Floats, spacing: float) -> FineSpread:
    """Choose points as `spread_pressure` does. All other candidates lie between them.

    area: of each of the N candidates, (N,) [m^2].
    """
    N, shares = len(area), (1.0, *reversed(BETWEEN[1:]))
    order, apart, (K, *counts), (nearest, *others) = spread_pressure(
        surface, [share * spacing for share in shares]
    )
    away = np.zeros(N)  # from the points chosen before
    away[order] = apart
    rest = np.ones(N, np.bool_)
    rest[order[:K]] = False
    more = np.flatnonzero(rest)
    more = more[np.argsort(nearest[more], kind="stable")]
    every = np.concatenate([order[:K], more])
    place = np.empty(N, np.intp)  # of each candidate, in the result
    place[every] = np.arange(N)
    areas = [area[every]]
    for count, near in zip(reversed(counts), reversed(others), strict=True):
        areas.append(gather_pressure(place[order[:count]][near], area, N))
    first = np.searchsorted(nearest[more], np.arange(K + 1))
    spacings = tuple(share * spacing for share in BETWEEN)
    between = Between(first, away[more], spacings, tuple(areas))
    return FineSpread(every, apart[:K], gather_pressure(nearest, area, K), between)


def join_between(parts: list[Between], counts: list[int]) -> Between:
    """Join the points between those of several surfaces, of K points each, whose own points come first."""
    sizes = [len(part.apart) for part in parts]
    starts = np.cumsum([0, *sizes])
    ends = [part.first[:-1] + start for part, start in zip(parts, starts, strict=False)]
    first = np.concatenate([*ends, starts[-1:]])
    areas = [
        np.concatenate(
            [part.area[n][:K] for part, K in zip(parts, counts, strict=True)]
            + [part.area[n][K:] for part, K in zip(parts, counts, strict=True)]
        )
        for n in range(len(BETWEEN))
    ]
    return Between(
        first, np.concatenate([part.apart for part in parts]), parts[0].levels, tuple(areas)
    )


class Spread(NamedTuple):
    """Points chosen one after the other.

    order: which points, (K,). apart: distance of each from those before it, which never increases, (K,) [m]. counts:
    how many of them belong to each level, (L,). nearest: the chosen point nearest to each of the N points, of those of
    each level, (L, N).
    """

    order: Indices
    apart: Floats
    counts: tuple[int, ...]
    nearest: Indices


def spread_pressure(surface: SkinNodes, spacings: Sequence[float]) -> Spread:
    """Choose points one after the other, each the farthest from those already chosen.

    spacings: of L levels, coarse to fine, above 0 [m]. A level ends when no point is its spacing away from all chosen
    points on its side. Raises ArgumentError.
    """
    N, L = len(surface.points), len(spacings)
    if not np.isfinite(surface.points).all():
        raise ArgumentError("points", "must be finite")
    order, apart = np.empty(N, dtype=np.intp), np.empty(N)
    nearest, counts = np.zeros((L, N), dtype=np.intp), np.empty(L, dtype=np.intp)
    kernels.spread(*surface, np.array(spacings), order, apart, nearest, counts)
    K = int(counts[-1])
    return Spread(order[:K].copy(), apart[:K].copy(), tuple(counts.tolist()), nearest)


def gather_pressure(to: Indices, area: Floats, count: int = 0) -> Floats:
    """Sum the areas, (N,), that go to each of at least `count` points."""
    return np.asarray(np.bincount(to, area, count), dtype=np.float64)


def share_pressure(surface: SkinNodes, nodes: int, spacing: float) -> Share:
    """Share every point among the nearest of the first `nodes` points, which are about `spacing` [m] apart.

    The weights are (1/D - 1/D_4)^2, normalised. D is the distance over the square root of the cosine between the
    normals, and D_4 is D of the fourth nearest node, so that the weight of a node is 0 when it enters or leaves the
    nearest three [1]. A point that is a node belongs to itself alone. `spacing` changes only the time that this takes.

    [1] Franke and Nielson, Smooth interpolation of large sets of scattered data, 1980 (modified Shepard).
    """
    K = len(surface.points)
    out = Share(np.zeros((K, SHARERS), dtype=np.intp), np.zeros((K, SHARERS)))
    kernels.share(*surface, nodes, spacing, *out)
    return out
