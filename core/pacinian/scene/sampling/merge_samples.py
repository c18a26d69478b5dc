"""Merge samples of different objects where they are too close for the array to resolve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import merge
from pacinian.region_numbers import ISOLATED
from pacinian.scene.sampling.sample_counts import MERGED
from pacinian.scene.sampling.samples import join_samples
from pacinian.scene.sampling.spacing import SPACING_WITHOUT_ARRAY

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.sampling.samples import Samples

# Isolated samples of different objects merge if they are nearer than this fraction of the spacing.
MERGE_SPACING_FRACTION = 0.5
# Largest distance of samples at the same place [m]. Samples of regions, and with `strict` all samples, merge only then.
SAME_PLACE_DISTANCE = 1e-6
MAX_MERGE_SAMPLES = 2048  # largest number of samples that are considered for merging


def merge_samples(
    parts: list[Samples], items: list[Object], spacing: float | None, counts: SampleCounts, *, strict: bool = False
) -> Samples:  # fmt: skip
    """Join the samples of all objects, and merge those of different objects that the array cannot resolve.

    A merged sample has the sum of the areas and of the forces. Only samples of equal envelope and technique are merged.

    parts: the samples of each of `items`, most important first; at least one. spacing: of isolated samples [m], or None
    for the default. counts: gets the number of samples that are merged into others. strict: merge only samples at the
    same place.
    """
    whole = join_samples(parts)
    M = len(whole)
    if len(parts) == 1 or M > MAX_MERGE_SAMPLES:
        return whole
    sizes = [len(part) for part in parts]
    source = np.repeat(np.arange(len(parts)), sizes)
    group = np.repeat(_number_groups(items), sizes)
    apart = MERGE_SPACING_FRACTION * (SPACING_WITHOUT_ARRAY if spacing is None else spacing)
    radius = np.full(M, SAME_PLACE_DISTANCE if strict else apart)
    radius[whole.regions != ISOLATED] = SAME_PLACE_DISTANCE
    P, area, kept = np.empty(M), np.empty(M), np.empty(M, dtype=np.bool_)
    gone = merge(
        whole.positions, whole.radiation_pressure, whole.area, source, group, radius,
        P, area, kept,
    )  # fmt: skip
    if not gone:
        return whole
    counts.note_rows(MERGED, whole, ~kept & (whole.radiation_pressure > 0.0))
    return whole.changed(radiation_pressure=P, area=area).only(kept)


def _number_groups(items: list[Object]) -> list[int]:
    """Number the items so that items of equal envelope and technique share a number."""
    seen: list[tuple[object, object]] = []
    numbers = list[int]()
    for item in items:
        group = item.envelope, item.technique
        if group not in seen:
            seen.append(group)
        numbers.append(seen.index(group))
    return numbers
