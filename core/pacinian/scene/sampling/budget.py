"""A budget of samples, shared out by priority."""

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

FINER = 1.3  # times as many as there would be must fit before the spacing gets finer again
COARSEST = 40  # levels


def allot_budget(
    sources: list[tuple[Source, float]],
    budget: int,
    levels: dict[int, int],
    cut: Callable[[Samples], Samples],
    skipped: Counter[str],
    bands: int = 1,
) -> list[Samples]:
    """Samples of each source, at most `budget` in all at a time.

    sources: with the spacing wanted [m], highest priority first. Those of one priority are made coarser
    together until they fit into what the higher ones leave. Of the first that does not fit then the
    weakest are dropped, of equals the last in order, and all after it. Samples that are sounded one at a
    time count as one. levels: how coarse each priority is, kept from tick to tick so that it does not
    flicker. cut: leaves out what may not be sounded. bands: into so many, which sound in turn, regions may be divided;
    one level coarser comes first, as it is still even between its samples.
    """
    parts: list[Samples] = []
    left = budget
    for priority, group in itertools.groupby(sources, key=lambda s: s[0].item.priority):
        members = list(group)
        made, levels[priority] = _fitting(members, left, levels.get(priority, 0), cut, bands)
        for (source, _), samples in zip(members, made, strict=True):
            count = _sounded(source, samples, bands if levels[priority] else 1)
            kept = samples if count <= left else _strongest(samples, left)
            skipped["samples over budget"] += len(samples) - len(kept)
            left -= min(count, left)
            parts.append(kept)
    return parts


def _sounded(source: Source, samples: Samples, bands: int) -> int:
    """How many there are at a time, in so many bands."""
    if measure_spacing(source.item):
        return min(1, len(samples))
    divided = bands > 1 and is_dense(source.item) and len(samples) > MIN_DIVIDED_SAMPLES
    return math.ceil(len(samples) * WIDER / bands) if divided else len(samples)


def _strongest(samples: Samples, count: int) -> Samples:
    force = samples.radiation_pressure * samples.area
    return samples.only(np.sort(np.argsort(-force, kind="stable")[:count]))


def _fitting(
    members: list[tuple[Source, float]], left: int, level: int,
    cut: Callable[[Samples], Samples], bands: int,
) -> tuple[list[Samples], int]:  # fmt: skip
    """Samples of sources of one priority, and the level at which they number at most `left`."""

    def every(level: int) -> list[Samples]:
        return [
            cut(source.at(spacing if measure_spacing(source.item) else spacing * COARSER**level))
            for source, spacing in members
        ]

    def number(made: list[Samples], level: int) -> int:
        """How many there are at a time: in one if that does, else in bands, from level 1 on."""
        counts = [
            sum(_sounded(m, s, most) for (m, _), s in zip(members, made, strict=True))
            for most in ({1, bands} if level else {1})
        ]
        return min(counts)

    def more(level: int) -> bool:
        """Whether it makes sense to be coarser than at `level`."""
        reach = max(source.item.bounding_radius for source, _ in members)
        finest = min(spacing for _, spacing in members)
        return finest * COARSER**level < 2.0 * reach and level < COARSEST

    def too_many(level: int) -> bool:
        """Whether there would be so many that it makes no sense to make them."""
        return _whole(members, level) > 2.0 * left * (bands if level else 1)

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


def _whole(members: list[tuple[Source, float]], level: int) -> float:
    """About how many samples those have that are rendered whole."""
    return sum(
        estimate_samples(source.item, spacing * COARSER**level)
        for source, spacing in members
        if isinstance(source, WholeObject) and not measure_spacing(source.item)
    )
