"""Evaluate the pressure of regions between and beside their samples, at places that the solver was not given."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import SAMPLE_TOUCHING_DISTANCE
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.errors import PointOnTransducer
from pacinian.neighbours import find_nearest
from pacinian.solving.felt_figures import MIN_FELT_SHARE, FeltRegion, FeltSums

if TYPE_CHECKING:
    from numpy.random import Generator
    from scipy.spatial import KDTree

    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes, Flags, Floats, Indices, Longs

# Largest distance of neighbouring samples, relative to the distance to the nearest other sample.
MAX_NEIGHBOUR_DISTANCE = 1.5
MERGE_DISTANCE = 1e-4  # samples up to this far apart count as one place [m]
# Number of nearest samples to query: the sample itself, up to 26 in the adjacent cells of the grid that may be within
# MERGE_DISTANCE, and one that is not.
NEAREST_QUERIED = 28
# Distances of the places beside a region from the nearest sample [m].
BESIDE_DISTANCES = 0.003, 0.004, 0.005
BESIDE_DIRECTIONS = 12  # number of directions from a sample to places beside its region


@dataclass(frozen=True, eq=False)
class FeltPlaces:
    """Places between the samples of regions, and beside the regions.

    points: (K, 3) [m]. asked: square of the target amplitude, (K,) [Pa^2]; 0 beside a region. region: number of each
    place's region, (K,). beside: whether each place is beside it, (K,). facing: of the skin at the places. count:
    number of regions. weight: of each place, relative to the area that it represents, (K,).
    """

    points: Floats
    asked: Floats
    region: Longs
    beside: Flags
    facing: SkinFacing | None
    count: int
    weight: Floats

    @classmethod
    def between_samples(
        cls, points: Floats, targets: Targets, facing: SkinFacing | None
    ) -> FeltPlaces:
        """Return places half way between neighbouring samples, and 3 to 5 mm beside their region.

        points: the samples, (M, 3) [m]. Half way, the target is the mean of both samples. A region of one sample is
        evaluated at that sample. Places on the outline of the samples have half the weight of others, as in the
        midpoint rule over triangles.
        """
        from scipy.spatial import KDTree

        assert targets.regions is not None
        sounding = ~targets.beside
        tree = KDTree(points[sounding])
        pairs, weight = np.empty((0, 2), np.intp), np.empty(0)
        outside, of = np.empty((0, 3)), np.empty(0, np.intp)
        for number in range(int(targets.regions.max()) + 1):
            own = np.flatnonzero((targets.regions == number) & sounding)
            if not len(own):
                continue
            found, spacing = _find_neighbours(points[own])
            pairs = np.concatenate([pairs, own[found]])
            weight = np.append(weight, _weigh_pairs(points[own], found))
            if len(own) > 1:
                near, at = _find_places_around(points[own], MAX_NEIGHBOUR_DISTANCE * spacing, tree)
                outside, of = np.concatenate([outside, near]), np.append(of, own[at])
        return cls._at(
            points, targets, facing, (pairs, np.full(pairs.shape, 0.5)), outside, of, weight
        )

    @classmethod
    def random_places(
        cls,
        points: Floats,
        targets: Targets,
        facing: SkinFacing | None,
        count: int,
        rng: Generator,
        area: Floats,
    ) -> FeltPlaces:
        """Return random places: `count` among the samples, evenly by area, and at most as many 3 to 5 mm beside.

        area: of the samples, (M,), in any unit; 0 where there shall be no places. Some samples with regions have an
        area. A place is in the part of a triangle of a sample and two of its neighbours that is nearest to the sample,
        and its target is interpolated. A place beside a region lies outward from a sample and its neighbour. Takes
        0.1 ms, where `between_samples` takes tens of ms.
        """
        assert targets.regions is not None
        sounding = np.flatnonzero(~targets.beside)
        chance = area[sounding] / area[sounding].sum()
        first = rng.choice(len(sounding), 2 * count, p=chance)
        d = points[sounding[first]][:, None] - points[sounding]
        square = np.einsum("mok,mok->mo", d, d)
        apart = targets.regions[sounding[first]][:, None] != targets.regions[sounding]
        apart[np.arange(2 * count), first] = True
        apart |= square <= MERGE_DISTANCE * MERGE_DISTANCE
        within = np.where(apart, np.inf, square)
        near = within <= MAX_NEIGHBOUR_DISTANCE**2 * within.min(axis=1, keepdims=True)
        near &= np.isfinite(within)
        second, third = (
            sounding[
                np.where(near.any(axis=1), (rng.random(near.shape) * near).argmax(axis=1), first)
            ]
            for _ in range(2)
        )
        first = sounding[first]
        shares = rng.uniform(0.0, 0.5, (count, 2))
        shares = np.column_stack([1.0 - shares.sum(axis=1), shares])
        corners = np.column_stack([first, second, third])[:count]
        # places beside: outward from the neighbour
        m, n = first[count:], second[count:]
        away = points[m] - points[n]
        size = np.sqrt((away * away).sum(axis=1, keepdims=True))
        r = rng.uniform(BESIDE_DISTANCES[0], BESIDE_DISTANCES[-1], (count, 1))
        beside = points[m] + r * away / np.where(size > 0.0, size, 1.0)
        d = beside[:, None] - points[sounding]
        nearest = np.einsum("mok,mok->mo", d, d).min(axis=1)
        free = np.flatnonzero((nearest >= (0.99 * r[:, 0]) ** 2) & (size[:, 0] > 0.0))
        return cls._at(
            points, targets, facing, (corners, shares), beside[free], m[free], np.ones(count)
        )

    @classmethod
    def _at(
        cls, points: Floats, targets: Targets, facing: SkinFacing | None,
        mixed: tuple[Indices, Floats], outside: Floats, of: Indices, weight: Floats,
    ) -> FeltPlaces:  # fmt: skip
        """Return places among samples of one region each, and `outside`, which lie beside the samples `of`.

        mixed: the C samples of each place, and their shares, both (K, C). weight: of these places, (K,).
        """
        assert targets.regions is not None
        P, (corners, shares) = targets.amplitudes**2, mixed
        inside, first = len(corners), corners[:, 0]
        seen = None
        if facing is not None:
            n = facing.normals
            between = np.einsum("kc,kcj->kj", shares, n[corners])
            size = np.sqrt((between * between).sum(axis=1, keepdims=True))
            between = np.where(size > 0.0, between / np.where(size > 0.0, size, 1.0), n[first])
            seen = SkinFacing(np.concatenate([between, n[of]]), facing.capsules, facing.edge)
        region = targets.regions[np.append(first, of)]
        return cls(
            np.concatenate([np.einsum("kc,kcj->kj", shares, points[corners]), outside]),
            np.concatenate([np.einsum("kc,kc->k", shares, P[corners]), np.zeros(len(of))]),
            region,
            np.arange(inside + len(of)) >= inside,
            seen,
            int(targets.regions.max()) + 1,
            np.append(weight, np.ones(len(of))),
        )

    def set_points_of(self, propagator: Propagator) -> FeltPlaces:
        """Move the propagator's points to these places, without those on a transducer. Returns the places used."""
        try:
            propagator.set_points(self.points, self.facing)
        except PointOnTransducer:
            away = find_nearest(propagator.array.positions, self.points)[0]
            left = np.flatnonzero(away > SAMPLE_TOUCHING_DISTANCE)
        else:
            return self
        facing = self.facing
        if facing is not None:
            facing = SkinFacing(facing.normals[left], facing.capsules, facing.edge)
        places = replace(
            self, points=self.points[left], asked=self.asked[left], region=self.region[left],
            beside=self.beside[left], facing=facing, weight=self.weight[left],
        )  # fmt: skip
        propagator.set_points(places.points, facing)
        return places

    def measure_felt(self, p: Complexes | Floats, multiple: float = 1.0) -> tuple[FeltRegion, ...]:
        """Return the figures of each region, in order, for sound pressures p, (K,) [Pa].

        multiple: factor by which the target amplitudes are multiplied first.
        """
        return tuple(sums.felt for sums in self.sums(p, multiple))

    def sums(self, p: Complexes | Floats, multiple: float = 1.0) -> list[FeltSums]:
        """Return the sums of each region, in order; arguments as for `measure_felt`."""
        made, asked = np.abs(p).astype(np.float64) ** 2, self.asked * multiple**2
        found: list[FeltSums] = []
        for number in range(self.count):
            own = self.region == number
            inside = own & ~self.beside
            P, t, w = made[inside], asked[inside], self.weight[inside]
            e = P - t
            holes = (MIN_FELT_SHARE * t > P) & (t > 0.0)
            beside = float(made[own & self.beside].max(initial=0.0))
            found.append(
                FeltSums(
                    float(w.sum()),
                    float(w @ P),
                    float(w @ t),
                    float(w @ (e * e)),
                    float(w @ (t * t)),
                    float(w @ holes),
                    beside,
                )
            )
        return found


def _find_neighbours(points: Floats) -> tuple[Indices, float]:
    """Return pairs of neighbouring samples of a region, (P, 2), and the median distance to the nearest [m].

    points: (M, 3) [m]. Samples in one place count as one. If all are in one place, the pair is that sample and itself.
    """
    from scipy.spatial import KDTree

    kept = np.unique(np.round(points / MERGE_DISTANCE), axis=0, return_index=True)[1]
    tree = KDTree(points[kept])
    away = np.asarray(tree.query(points[kept], NEAREST_QUERIED)[0])
    nearest = np.where((away > MERGE_DISTANCE) & np.isfinite(away), away, np.inf).min(axis=1)
    others = np.flatnonzero(np.isfinite(nearest))
    if not len(others):
        return kept[None, [0, 0]], 0.0
    near = tree.query_ball_point(points[kept[others]], MAX_NEIGHBOUR_DISTANCE * nearest[others])
    pairs = np.array([(i, j) for i, of in zip(others, near, strict=True) for j in of])
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    return kept[pairs], float(np.median(nearest[others]))


def _weigh_pairs(points: Floats, pairs: Indices) -> Floats:
    """Return the weight of the place half way between the samples of each pair, (P,): 1 inside, 1/2 on an outline.

    A pair lies on an outline if all neighbours that its samples have in common are on one side. points: (M, 3) [m].
    pairs: of neighbours, (P, 2).
    """
    from scipy.sparse import coo_array

    P, M = len(pairs), len(points)
    ends = np.concatenate([pairs, pairs[:, ::-1]]).T
    adjacent = coo_array((np.ones(2 * P), (ends[0], ends[1])), (M, M)).tocsr()
    pair, common = (adjacent[pairs[:, 0]] * adjacent[pairs[:, 1]]).nonzero()
    along, middle = np.diff(points[pairs], axis=1)[:, 0], points[pairs].mean(axis=1)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), MERGE_DISTANCE)
    side = points[common] - middle[pair]
    side -= (side * along[pair]).sum(axis=1, keepdims=True) * along[pair]
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), MERGE_DISTANCE)
    total = np.stack([np.bincount(pair, axis, P) for axis in side.T], axis=1)
    count = np.maximum(np.bincount(pair, minlength=P), 1.0)
    return np.asarray(1.0 - 0.5 * np.linalg.norm(total, axis=1) / count)


def _find_places_around(
    points: Floats, radius: float, all_samples: KDTree
) -> tuple[Floats, Indices]:
    """Return places 3 to 5 mm from a sample, along the surface, and no nearer to any sample in `all_samples`.

    points: samples of one region, (M, 3) [m]. radius: neighbours within it determine the tangent plane [m]. Returns
    the index of each place's sample, too.
    """
    from scipy.spatial import KDTree

    tree = KDTree(points)
    turns = 2.0 * np.pi * np.arange(BESIDE_DIRECTIONS) / BESIDE_DIRECTIONS
    places, at = [np.empty((0, 3))], [np.empty(0, np.intp)]
    for i, near in enumerate(tree.query_ball_point(points, radius)):
        away = points[near] - points[i]
        _, axes = np.linalg.eigh(away.T @ away)
        u, v = axes[:, 2], axes[:, 1]
        ring = np.cos(turns)[:, None] * u + np.sin(turns)[:, None] * v
        places.append(np.concatenate([points[i] + r * ring for r in BESIDE_DISTANCES]))
        at.append(np.full(len(BESIDE_DISTANCES) * BESIDE_DIRECTIONS, i))
    found, which = np.concatenate(places), np.concatenate(at)
    wanted = np.tile(np.repeat(BESIDE_DISTANCES, BESIDE_DIRECTIONS), len(points))
    free = all_samples.query(found)[0] >= 0.99 * wanted
    return found[free], which[free]
