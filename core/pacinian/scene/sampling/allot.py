"""A budget of samples, shared out by priority."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.sampling.covers import estimate
from pacinian.scene.sampling.resolving import COARSER
from pacinian.scene.sampling.sources import Whole, apart

if TYPE_CHECKING:
    from collections import Counter
    from collections.abc import Callable

    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.sampling.sources import Source

FINER = 1.3  # times as many as there would be must fit before the spacing gets finer again
COARSEST = 40  # levels


def allot(
    sources: list[tuple[Source, float]],
    budget: int,
    levels: dict[int, int],
    cut: Callable[[Samples], Samples],
    skipped: Counter[str],
) -> list[Samples]:
    """Samples of each source, at most `budget` in all.

    sources: with the spacing wanted [m], highest priority first. Those of one priority are made coarser
    together until they fit into what the higher ones leave. Of the first that does not fit then the
    weakest are dropped, of equals the last in order, and all after it. Samples that are sounded one at a
    time count as one. levels: how coarse each priority is, kept from tick to tick so that it does not
    flicker. cut: leaves out what may not be sounded.
    """
    parts: list[Samples] = []
    left = budget
    for priority, group in itertools.groupby(sources, key=lambda s: s[0].item.priority):
        members = list(group)
        made, levels[priority] = _fitting(members, left, levels.get(priority, 0), cut)
        for (source, _), samples in zip(members, made, strict=True):
            count = _sounded(source, samples)
            kept = samples if count <= left else _strongest(samples, left)
            skipped["samples over budget"] += len(samples) - len(kept)
            left -= min(count, left)
            parts.append(kept)
    return parts


def _sounded(source: Source, samples: Samples) -> int:
    """How many there are at a time."""
    return min(1, len(samples)) if apart(source.item) else len(samples)


def _strongest(samples: Samples, count: int) -> Samples:
    force = samples.radiation_pressure * samples.area
    return samples.only(np.sort(np.argsort(-force, kind="stable")[:count]))


def _fitting(
    members: list[tuple[Source, float]], left: int, level: int, cut: Callable[[Samples], Samples]
) -> tuple[list[Samples], int]:
    """Samples of sources of one priority, and the level at which they number at most `left`."""

    def every(level: int) -> list[Samples]:
        return [
            cut(source.at(spacing if apart(source.item) else spacing * COARSER**level))
            for source, spacing in members
        ]

    def number(made: list[Samples]) -> int:
        return sum(_sounded(m, s) for (m, _), s in zip(members, made, strict=True))

    def more(level: int) -> bool:
        """Whether it makes sense to be coarser than at `level`."""
        reach = max(source.item.reach for source, _ in members)
        finest = min(spacing for _, spacing in members)
        return finest * COARSER**level < 2.0 * reach and level < COARSEST

    many = 2.0 * left
    while _whole(members, level) > many and more(level):
        level += 1
    made = every(level)
    count = number(made)
    if level and count * FINER <= left and _whole(members, level - 1) <= many:
        finer = every(level - 1)
        if FINER * number(finer) <= left:
            return finer, level - 1
    while count > left and more(level):
        level += 1
        made = every(level)
        count = number(made)
    return made, level


def _whole(members: list[tuple[Source, float]], level: int) -> float:
    """About how many samples those have that are rendered whole."""
    return sum(
        estimate(source.item, spacing * COARSER**level)
        for source, spacing in members
        if isinstance(source, Whole) and not apart(source.item)
    )
