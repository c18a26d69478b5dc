"""Divide a budget of samples among objects by priority."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.sampling.array_resolution import COARSER
from pacinian.scene.sampling.bands import MIN_DIVIDED_SAMPLES, WIDER
from pacinian.scene.sampling.sample_cache import estimate_samples
from pacinian.scene.sampling.sources import WholeObject, is_dense, measure_spacing

if TYPE_CHECKING:
    from collections import Counter
    from collections.abc import Callable

    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.sampling.sources import Source

FINER = 1.3  # the spacing gets finer again only if this many times the samples would fit
COARSEST = 40  # largest level, in steps of sqrt(2) of the spacing


def allot_budget(
    sources: list[tuple[Source, float]],
    budget: int,
    levels: dict[int, int],
    cut: Callable[[Samples], Samples],
    skipped: Counter[str],
    bands: int = 1,
) -> list[Samples]:
    """Return samples of each source, at most `budget` simultaneous samples in all.

    sources: with their intended spacings [m], highest priority first. The sources of one priority are made coarser
    together until they fit into the budget that the higher priorities leave. If a source still does not fit, its
    weakest samples are dropped (of equals, the last), and so are all sources after it. Samples that sound one at a
    time count as one. levels: coarseness of each priority; it is kept from tick to tick to prevent flicker. cut: drops
    samples that must not sound. bands: maximum number of bands, which sound in turn, per region. Regions become one
    level coarser before they are divided, because the pressure between their samples is still even then.
    """
    parts: list[Samples] = []
    left = budget
    for priority, group in itertools.groupby(sources, key=lambda s: s[0].item.priority):
        members = list(group)
        made, levels[priority] = _fit_level(members, left, levels.get(priority, 0), cut, bands)
        for (source, _), samples in zip(members, made, strict=True):
            count = _count_simultaneous(source, samples, bands if levels[priority] else 1)
            kept = samples if count <= left else _strongest(samples, left)
            skipped["samples over budget"] += len(samples) - len(kept)
            left -= min(count, left)
            parts.append(kept)
    return parts


def _count_simultaneous(source: Source, samples: Samples, bands: int) -> int:
    """Return the number of simultaneous samples of a source, given the number of bands."""
    if measure_spacing(source.item):
        return min(1, len(samples))
    divided = bands > 1 and is_dense(source.item) and len(samples) > MIN_DIVIDED_SAMPLES
    return math.ceil(len(samples) * WIDER / bands) if divided else len(samples)


def _strongest(samples: Samples, count: int) -> Samples:
    force = samples.radiation_pressure * samples.area
    return samples.only(np.sort(np.argsort(-force, kind="stable")[:count]))


def _fit_level(
    members: list[tuple[Source, float]], left: int, level: int,
    cut: Callable[[Samples], Samples], bands: int,
) -> tuple[list[Samples], int]:  # fmt: skip
    """Return the samples of sources of one priority, and the level at which they are at most `left`."""

    def every(level: int) -> list[Samples]:
        return [
            cut(source.at(spacing if measure_spacing(source.item) else spacing * COARSER**level))
            for source, spacing in members
        ]

    def number(made: list[Samples], level: int) -> int:
        """Return the smallest number of simultaneous samples: in one band or, from level 1 on, in several."""
        counts = [
            sum(_count_simultaneous(m, s, most) for (m, _), s in zip(members, made, strict=True))
            for most in ({1, bands} if level else {1})
        ]
        return min(counts)

    def more(level: int) -> bool:
        """Return whether a coarser level than `level` still reduces the samples."""
        reach = max(source.item.bounding_radius for source, _ in members)
        finest = min(spacing for _, spacing in members)
        return finest * COARSER**level < 2.0 * reach and level < COARSEST

    def too_many(level: int) -> bool:
        """Return whether `level` clearly gives too many samples, judged by an estimate."""
        return _estimate_whole(members, level) > 2.0 * left * (bands if level else 1)

    while too_many(level) and more(level):
        level += 1
    made = every(level)
    count = number(made, level)
    if level and count * FINER <= left and not too_many(level - 1):
        finer = every(level - 1)
        if FINER * number(finer, level - 1) <= left:
            return finer, level - 1
    while count > left and more(level):
        level += 1
        made = every(level)
        count = number(made, level)
    return made, level


def _estimate_whole(members: list[tuple[Source, float]], level: int) -> float:
    """Estimate the number of samples of the sources that are rendered whole."""
    return sum(
        estimate_samples(source.item, spacing * COARSER**level)
        for source, spacing in members
        if isinstance(source, WholeObject) and not measure_spacing(source.item)
    )
