"""What is felt of regions, at places between and beside the samples: those that the solver was not given."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.errors import PointOnTransducer

if TYPE_CHECKING:
    from numpy.random import Generator
    from scipy.spatial import KDTree

    from pacinian.solving.problem import Targets
    from pacinian.solving.propagator import Propagator
    from pacinian.types import Complexes, Flags, Floats, Indices, Longs

NEIGHBOURS = 1.5  # times as far as the nearest sample that lies elsewhere
SAME = 1e-4  # [m]: samples that are no farther apart lie in one place
CELLS = 28  # one sample, those that may be so near in cells of that width, and one that is not
ON = 1e-5  # [m]: a place that is no farther from a transducer lies on it
BESIDE = 0.003, 0.004, 0.005  # [m]
AROUND = 12  # directions in which is looked there
HOLE = 0.5  # of what was asked: less is a hole
EVEN_FORCE, EVEN_RMS = 0.05, 0.10  # off by more is not what was asked


class FeltRegion(NamedTuple):
    """What is felt of one region, against what was asked; pressures are radiation pressures.

    force: over what was asked, 1 if right. rms: root mean square of the difference, over that of what
    was asked. holes: the share of the region with less than half. spill: the highest pressure 3 to 5 mm beside
    it, over the mean that was asked. All between the samples; 1, 0, 0, 0 of a region where nothing is asked.
    """

    force: float = 1.0
    rms: float = 0.0
    holes: float = 0.0
    spill: float = 0.0

    def __str__(self) -> str:
        return (
            f"force {self.force:.1%} of what was asked, rms error {self.rms:.1%}, "
            f"{self.holes:.1%} holes, {self.spill:.0%} beside it"
        )

    @property
    def even(self) -> bool:
        """Whether that is what was asked: force within 5 %, rms at most 0.10, no holes."""
        return abs(self.force - 1.0) <= EVEN_FORCE and self.rms <= EVEN_RMS and not self.holes


class FeltSums(NamedTuple):
    """What `FeltRegion` is made of, so that looks at different moments can be added.

    places: how many, half way between samples. made, asked: sums of the squares of the sound pressure amplitudes
    [Pa^2]. errors, squares: sums of the squares of their difference, and of what was asked [Pa^4]. holes: places with
    less than half. beside: the highest square beside the region [Pa^2].
    """

    places: int = 0
    made: float = 0.0
    asked: float = 0.0
    errors: float = 0.0
    squares: float = 0.0
    holes: int = 0
    beside: float = 0.0

    def plus(self, other: FeltSums) -> FeltSums:
        """Both together."""
        return FeltSums(
            self.places + other.places,
            self.made + other.made,
            self.asked + other.asked,
            self.errors + other.errors,
            self.squares + other.squares,
            self.holes + other.holes,
            max(self.beside, other.beside),
        )

    @property
    def felt(self) -> FeltRegion:
        """The figures."""
        if not self.asked:
            return FeltRegion()
        rms = math.sqrt(self.errors / self.squares)
        mean = self.asked / self.places
        return FeltRegion(self.made / self.asked, rms, self.holes / self.places, self.beside / mean)


@dataclass(frozen=True, eq=False)
class FeltPlaces:
    """Places between the samples of regions, and beside these.

    points: (K, 3) [m]. asked: square of the sound pressure amplitude, (K,) [Pa^2]; 0 beside. region: of
    each, (K,). facing: of the skin there. count: of regions.
    """

    points: Floats
    asked: Floats
    region: Longs
    beside: Flags
    facing: SkinFacing | None
    count: int

    @classmethod
    def of(cls, points: Floats, targets: Targets, facing: SkinFacing | None) -> FeltPlaces:
        """For samples at `points`, (M, 3) [m]: half way between neighbours, and 3 to 5 mm beside the region.

        Half way, the mean of both is asked. A region of one sample is looked at there.
        """
        from scipy.spatial import KDTree

        assert targets.regions is not None
        sounding = ~targets.beside
        tree = KDTree(points[sounding])
        first, second = np.empty((2, 0), np.intp)
        outside, of = np.empty((0, 3)), np.empty(0, np.intp)
        for number in range(int(targets.regions.max()) + 1):
            own = np.flatnonzero((targets.regions == number) & sounding)
            if not len(own):
                continue
            a, b, spacing = _neighbours(points[own])
            first, second = np.append(first, own[a]), np.append(second, own[b])
            if len(own) > 1:
                near, at = _around(points[own], NEIGHBOURS * spacing, tree)
                outside, of = np.concatenate([outside, near]), np.append(of, own[at])
        return cls._at(points, targets, facing, (first, second), outside, of)

    @classmethod
    def some(
        cls,
        points: Floats,
        targets: Targets,
        facing: SkinFacing | None,
        count: int,
        chance: Generator,
    ) -> FeltPlaces | None:
        """At random a few of those that `of` has: `count` half way, fewer beside; None without a region.

        Beside is outward from a neighbour. Takes a tenth of a millisecond, where `of` takes tens.
        """
        assert targets.regions is not None
        sounding = np.flatnonzero(~targets.beside)
        own = np.flatnonzero(targets.regions[sounding] >= 0)
        if not len(own):
            return None
        first = chance.choice(own, 2 * count)
        d = points[sounding[first]][:, None] - points[sounding]
        square = np.einsum("mok,mok->mo", d, d)
        apart = targets.regions[sounding[first]][:, None] != targets.regions[sounding]
        apart[np.arange(2 * count), first] = True
        apart |= square <= SAME * SAME
        within = np.where(apart, np.inf, square)
        near = within <= NEIGHBOURS**2 * within.min(axis=1, keepdims=True)
        near &= np.isfinite(within)
        second = np.where(
            near.any(axis=1), (chance.random(near.shape) * near).argmax(axis=1), first
        )
        first, second = sounding[first], sounding[second]
        a, b = first[:count], second[:count]
        # the others: outward from the neighbour
        m, n = first[count:], second[count:]
        away = points[m] - points[n]
        size = np.sqrt((away * away).sum(axis=1, keepdims=True))
        r = chance.uniform(BESIDE[0], BESIDE[-1], (count, 1))
        beside = points[m] + r * away / np.where(size > 0.0, size, 1.0)
        d = beside[:, None] - points[sounding]
        nearest = np.einsum("mok,mok->mo", d, d).min(axis=1)
        free = np.flatnonzero((nearest >= (0.99 * r[:, 0]) ** 2) & (size[:, 0] > 0.0))
        return cls._at(points, targets, facing, (a, b), beside[free], m[free])

    @classmethod
    def _at(
        cls, points: Floats, targets: Targets, facing: SkinFacing | None,
        pairs: tuple[Indices, Indices], outside: Floats, of: Indices,
    ) -> FeltPlaces:  # fmt: skip
        """Half way between pairs of samples, and outside, beside the samples `of`."""
        assert targets.regions is not None
        P, (first, second) = targets.amplitudes**2, pairs
        inside = len(first)
        seen = None
        if facing is not None:
            n = facing.normals
            between = n[first] + n[second]
            size = np.sqrt((between * between).sum(axis=1, keepdims=True))
            between = np.where(size > 0.0, between / np.where(size > 0.0, size, 1.0), n[first])
            seen = SkinFacing(np.concatenate([between, n[of]]), facing.capsules, facing.edge)
        region = targets.regions[np.append(first, of)]
        return cls(
            np.concatenate([(points[first] + points[second]) / 2.0, outside]),
            np.concatenate([(P[first] + P[second]) / 2.0, np.zeros(len(of))]),
            region,
            np.arange(inside + len(of)) >= inside,
            seen,
            int(targets.regions.max()) + 1,
        )

    def heard_by(self, propagator: Propagator) -> FeltPlaces:
        """Put the propagator's points here; what lies on a transducer is left out. Returns what is left."""
        try:
            propagator.set_points(self.points, self.facing)
        except PointOnTransducer:
            from scipy.spatial import KDTree

            away = KDTree(propagator.array.positions).query(self.points)[0]
            left = np.flatnonzero(away > ON)
        else:
            return self
        facing = self.facing
        if facing is not None:
            facing = SkinFacing(facing.normals[left], facing.capsules, facing.edge)
        places = replace(
            self, points=self.points[left], asked=self.asked[left], region=self.region[left],
            beside=self.beside[left], facing=facing,
        )  # fmt: skip
        propagator.set_points(places.points, facing)
        return places

    def felt(self, p: Complexes | Floats, multiple: float = 1.0) -> tuple[FeltRegion, ...]:
        """The figures of each region, in their order, for sound pressures p, (K,) [Pa].

        multiple: of the amplitudes that count as asked.
        """
        return tuple(sums.felt for sums in self.sums(p, multiple))

    def sums(self, p: Complexes | Floats, multiple: float = 1.0) -> list[FeltSums]:
        """The sums of each region, in their order; arguments as for `felt`."""
        made, asked = np.abs(p).astype(np.float64) ** 2, self.asked * multiple**2
        found: list[FeltSums] = []
        for number in range(self.count):
            own = self.region == number
            inside = own & ~self.beside
            P, t = made[inside], asked[inside]
            e = P - t
            holes = int(((HOLE * t > P) & (t > 0.0)).sum())
            beside = float(made[own & self.beside].max(initial=0.0))
            found.append(
                FeltSums(
                    len(t),
                    float(P.sum()),
                    float(t.sum()),
                    float(e @ e),
                    float(t @ t),
                    holes,
                    beside,
                )
            )
        return found


def _neighbours(points: Floats) -> tuple[Indices, Indices, float]:
    """Pairs of neighbours among the samples of a region, (M, 3) [m], and how far apart they are, in the median [m].

    Of samples in one place one counts. A region that is all in one place is a pair of that sample with itself.
    """
    from scipy.spatial import KDTree

    kept = np.unique(np.round(points / SAME), axis=0, return_index=True)[1]
    tree = KDTree(points[kept])
    away = np.asarray(tree.query(points[kept], CELLS)[0])
    nearest = np.where((away > SAME) & np.isfinite(away), away, np.inf).min(axis=1)
    others = np.flatnonzero(np.isfinite(nearest))
    if not len(others):
        return kept[:1], kept[:1], 0.0
    near = tree.query_ball_point(points[kept[others]], NEIGHBOURS * nearest[others])
    pairs = np.array([(i, j) for i, of in zip(others, near, strict=True) for j in of])
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    first, second = pairs[pairs[:, 0] < pairs[:, 1]].T
    return kept[first], kept[second], float(np.median(nearest[others]))


def _around(points: Floats, radius: float, every: KDTree) -> tuple[Floats, Indices]:
    """Places 3 to 5 mm from samples of a region, along its surface, and no nearer to any other of `every`.

    radius: in which neighbours tell how the surface lies [m]. Returns also beside which sample each is.
    """
    from scipy.spatial import KDTree

    tree = KDTree(points)
    turns = 2.0 * np.pi * np.arange(AROUND) / AROUND
    places, at = [np.empty((0, 3))], [np.empty(0, np.intp)]
    for i, near in enumerate(tree.query_ball_point(points, radius)):
        away = points[near] - points[i]
        _, axes = np.linalg.eigh(away.T @ away)
        u, v = axes[:, 2], axes[:, 1]
        ring = np.cos(turns)[:, None] * u + np.sin(turns)[:, None] * v
        places.append(np.concatenate([points[i] + r * ring for r in BESIDE]))
        at.append(np.full(len(BESIDE) * AROUND, i))
    found, which = np.concatenate(places), np.concatenate(at)
    wanted = np.tile(np.repeat(BESIDE, AROUND), len(points))
    free = every.query(found)[0] >= 0.99 * wanted
    return found[free], which[free]
