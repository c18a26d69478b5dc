"""Divide a budget of samples among objects by priority.

The default budget is `DEFAULT_BUDGET` in scene/config_sections.py.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.errors import ArgumentError
from pacinian.scene.sampling.array_resolution import SPACING_RATIO
from pacinian.scene.sampling.region_bands import MIN_DIVIDED_SAMPLES, WIDER
from pacinian.scene.sampling.sample_cache import estimate_samples
from pacinian.scene.sampling.sample_counts import (
    COARSENED,
    FAINT,
    OUTSIDE,
    OVER_BUDGET,
    label_object,
)
from pacinian.scene.sampling.sample_sources import WholeObject, forms_region, is_sequential

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.sampling.sample_sources import SampleSource
    from pacinian.scene.sampling.samples import Samples

    Cut = Callable[[Samples], Samples]


class Allowance(NamedTuple):
    """How many samples a frame may have, relative to the budget, and when regions are divided into bands.

    shares: at coarseness 0, 1, 2 and so on; the last one holds for larger ones, too. divided_from: coarseness from
    which regions are divided into bands.
    """

    shares: tuple[float, ...]
    divided_from: int

    def find_limit(self, budget: int, coarseness: int) -> int:
        """Return the largest number of samples of a frame at a `coarseness`."""
        return max(1, round(self.shares[min(coarseness, len(self.shares) - 1)] * budget))


PLAIN = Allowance((1.0,), 1)  # points, and several objects in free air
# Touched skin takes time: to find, and to find the highest pressure on it. So a contact becomes coarser first; a wide
# one may then have more samples, because the pressure between samples that are farther apart is not even (decision 79).
ON_SKIN = Allowance((0.8, 1.2), 1)
# The same if solves may take long (decision 80).
FINE_ON_SKIN = Allowance((1.5,), 1)
# One object in free air: its field can be steered, so its solves may take longer.
ALONE = Allowance((1.0, 1.6, 2.0), 2)
FINER = 1.3  # the spacing gets finer again only if this many times the samples would fit
MAX_COARSENESS = 40  # largest coarseness: the spacing is enlarged by SPACING_RATIO to this power
MAX_ESTIMATE_RATIO = 2.0  # samples are not made where an estimate of their number is beyond this many times the budget


class SourceSamples(NamedTuple):
    """Samples of one source. faint, outside: samples left out because of perception, and of the workspace."""

    samples: Samples
    faint: int
    outside: int

    @property
    def asked(self) -> int:
        """Number of samples that press, those left out included."""
        return count_pressing(self.samples) + self.faint + self.outside


def allot_budget(
    sources: list[tuple[SampleSource, float]],
    budget: int,
    coarseness: dict[int, int],
    cut: Cut,
    counts: SampleCounts,
    bands: int = 1,
    full: int = 0,
    *,
    allowance: Allowance = PLAIN,
) -> list[Samples]:
    """Return samples of each source, at most as many simultaneous samples in all as the `allowance` says.

    sources: with their intended spacings [m], highest priority first. The sources of one priority are made coarser
    together until they fit into the budget that the higher priorities leave. If a source still does not fit, its
    weakest samples are dropped (of equals, the last), and so are all sources after it. Samples that sound one at a
    time count as one. coarseness: of each priority: by how many steps its spacings are enlarged. It is kept from tick
    to tick to prevent flicker. cut: drops samples that must not sound. bands: maximum number of bands, which sound in
    turn, per region. Regions become coarser before they are divided, because the pressure between their samples is
    still even then.

    counts: gets what each object asks for, and what is left out. full: the budget if there were time; `budget` may
    be less.
    """
    parts: list[Samples] = []
    used, full = 0, max(budget, full)
    for priority, members in itertools.groupby(sources, key=lambda s: s[0].item.priority):
        group = _SourceGroup(list(members), budget, used, cut, bands, allowance)
        made, own = group.fit(coarseness.get(priority, 0))
        coarseness[priority] = own
        left, parallel = group.find_limit(own), group.count_bands(own)
        for (source, spacing), one in zip(group.members, made, strict=True):
            samples = one.samples
            count = _count_simultaneous(source, samples, parallel)
            kept = samples if count <= left else _strongest(samples, left)
            asked = one.asked
            if own and not is_sequential(source.item):
                asked = _count_asked(source, spacing, cut, MAX_ESTIMATE_RATIO * full * bands)
            _note_samples(counts, source, one, asked)
            counts.note(OVER_BUDGET, source.index, count_pressing(samples) - count_pressing(kept))
            left, used = left - min(count, left), used + min(count, left)
            parts.append(kept)
    return parts


def make_all_samples(
    sources: list[tuple[SampleSource, float]],
    budget: int,
    cut: Cut,
    counts: SampleCounts,
    bands: int = 1,
    *,
    allowance: Allowance = PLAIN,
) -> list[Samples]:
    """Return all samples of each source, at the intended spacings; arguments as for `allot_budget`.

    Raises ArgumentError, which names the first object that exceeds what the `allowance` leaves.
    """
    group = _SourceGroup(sources, budget, 0, cut, bands, allowance)
    left = group.find_limit(0)
    group.check_estimate()
    parts: list[Samples] = []
    for (source, _), one in zip(sources, group.make(0), strict=True):
        count = _count_simultaneous(source, one.samples, bands)
        if count > left:
            raise group.too_many(source, count, left)
        _note_samples(counts, source, one, one.asked)
        left -= count
        parts.append(one.samples)
    return parts


@dataclass
class _SourceGroup:
    """Sources that are made coarser together, with their intended spacings [m].

    budget, cut, bands, allowance: those of `allot_budget`. used: number of samples of higher priorities.
    """

    members: list[tuple[SampleSource, float]]
    budget: int
    used: int
    cut: Cut
    bands: int
    allowance: Allowance

    def find_limit(self, coarseness: int) -> int:
        """Return the largest number of samples at `coarseness`."""
        return max(0, self.allowance.find_limit(self.budget, coarseness) - self.used)

    def count_bands(self, coarseness: int) -> int:
        """Return the largest number of bands of a region at `coarseness`."""
        return self.bands if coarseness >= self.allowance.divided_from else 1

    def fit(self, coarseness: int) -> tuple[list[SourceSamples], int]:
        """Return the samples, and the coarseness at which they fit the budget. coarseness: that of the last tick."""
        while self._exceeds_limit(coarseness) and self._can_coarsen(coarseness):
            coarseness += 1
        made = self.make(coarseness)
        count, below = self._count(made, coarseness), coarseness - 1
        fits_below = coarseness > 0 and count * FINER <= self.find_limit(below)
        if fits_below and not self._exceeds_limit(below):
            finer = self.make(below)
            if FINER * self._count(finer, below) <= self.find_limit(below):
                return finer, below
        while count > self.find_limit(coarseness) and self._can_coarsen(coarseness):
            coarseness += 1
            made = self.make(coarseness)
            count = self._count(made, coarseness)
        return made, coarseness

    def make(self, coarseness: int) -> list[SourceSamples]:
        """Return the samples of each source at `coarseness`."""
        ratio = SPACING_RATIO**coarseness
        return [
            _make(source, spacing if is_sequential(source.item) else spacing * ratio, self.cut)
            for source, spacing in self.members
        ]

    def check_estimate(self) -> None:
        """Raise ArgumentError if there are clearly too many samples, before they are made."""
        left = self.find_limit(0)
        if _estimate_whole(self.members, 0) > MAX_ESTIMATE_RATIO * left * self.bands:
            count, source = max(
                ((_estimate_whole([member], 0), member[0]) for member in self.members),
                key=lambda c: c[0],
            )
            raise self.too_many(source, round(count), left)

    def too_many(self, source: SampleSource, count: int, left: int) -> ArgumentError:
        """Return the error for a source of `count` samples at once where the budget leaves fewer."""
        label, share = label_object(source.item, source.index), self.allowance.shares[0]
        return ArgumentError(
            "scene",
            f"has an object that cannot be rendered in full: {label!r} needs {count} samples at once, and the budget "
            f"leaves {left}; raise `Sampler(budget=...)`, of which this scene may use {share:.0%}, or make the object "
            "smaller",
        )

    def _count(self, made: list[SourceSamples], coarseness: int) -> int:
        """Return the smallest number of simultaneous samples: in one band or, where regions are divided, in several."""
        return min(
            sum(
                _count_simultaneous(source, one.samples, bands)
                for (source, _), one in zip(self.members, made, strict=True)
            )
            for bands in {1, self.count_bands(coarseness)}
        )

    def _can_coarsen(self, coarseness: int) -> bool:
        """Return whether a larger `coarseness` still reduces the samples."""
        reach = max(source.item.bounding_radius for source, _ in self.members)
        finest = min(spacing for _, spacing in self.members)
        return finest * SPACING_RATIO**coarseness < 2.0 * reach and coarseness < MAX_COARSENESS

    def _exceeds_limit(self, coarseness: int) -> bool:
        """Return whether `coarseness` clearly gives too many samples, judged by an estimate."""
        most = MAX_ESTIMATE_RATIO * self.find_limit(coarseness) * self.count_bands(coarseness)
        return _estimate_whole(self.members, coarseness) > most


def count_pressing(samples: Samples) -> int:
    """Return the number of samples that press."""
    return int(np.count_nonzero(samples.radiation_pressure))


def _make(source: SampleSource, spacing: float, cut: Cut) -> SourceSamples:
    samples = source.at(spacing)
    inside = cut(samples)
    outside = 0 if inside is samples else count_pressing(samples) - count_pressing(inside)
    return SourceSamples(inside, source.faint, outside)


def _count_asked(source: SampleSource, spacing: float, cut: Cut, most: float) -> int:
    """Return the number of samples at the intended spacing; an estimate if that is more than `most`."""
    if isinstance(source, WholeObject):
        count = estimate_samples(source.item, spacing)
        if count > most:
            return round(count)
        if not source.textured:
            return source.count(spacing)
    return _make(source, spacing, cut).asked


def _note_samples(
    counts: SampleCounts, source: SampleSource, made: SourceSamples, asked: int
) -> None:
    """Note how many samples an object asks for, and why fewer are made."""
    counts.ask(source.index, asked)
    counts.note(COARSENED, source.index, asked - made.asked)
    counts.note(FAINT, source.index, made.faint)
    counts.note(OUTSIDE, source.index, made.outside)


def _count_simultaneous(source: SampleSource, samples: Samples, bands: int) -> int:
    """Return the number of simultaneous samples of a source, given the number of bands."""
    if is_sequential(source.item):
        return min(1, len(samples))
    divided = bands > 1 and forms_region(source.item) and len(samples) > MIN_DIVIDED_SAMPLES
    return math.ceil(len(samples) * WIDER / bands) if divided else len(samples)


def _strongest(samples: Samples, count: int) -> Samples:
    force = samples.radiation_pressure * samples.area
    return samples.only(np.sort(np.argsort(-force, kind="stable")[:count]))


def _estimate_whole(members: list[tuple[SampleSource, float]], coarseness: int) -> float:
    """Estimate the number of samples of the sources that are rendered whole."""
    return sum(
        estimate_samples(source.item, spacing * SPACING_RATIO**coarseness)
        for source, spacing in members
        if isinstance(source, WholeObject) and not is_sequential(source.item)
    )
