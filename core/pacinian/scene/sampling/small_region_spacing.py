"""Refine small regions. They need a finer spacing than large ones, because most of a small region is rim."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.scene.objects import Volume
from pacinian.scene.sampling.array_resolution import SPACING_RATIO
from pacinian.scene.sampling.sample_cache import estimate_samples
from pacinian.scene.sampling.sample_sources import forms_region, is_sequential

if TYPE_CHECKING:
    from pacinian.scene.sampling.sample_sources import SampleSource

TARGET_SAMPLES = 90  # number of samples up to which a region is refined
MAX_REFINED_SAMPLES = 128  # number of samples up to which all regions together are refined
MAX_STEPS = 3  # largest number of refinement steps, each by sqrt(2)
MARGIN = 1.3  # this many times the estimated samples must fit into the budget


def refine(
    sources: list[tuple[SampleSource, float]], budget: int
) -> list[tuple[SampleSource, float]]:
    """Return the sources with their spacings [m], finer for regions with few samples if the budget allows it.

    For a disc of 12 mm and nine units at half drive, the rms error between the samples is 0.11 with 20 samples, and
    0.03 with 108 (decision 33).
    """
    regions = sum(forms_region(source.item) for source, _ in sources)
    if not 0 < regions <= MAX_REFINED_SAMPLES:
        return sources
    few = min(TARGET_SAMPLES, MAX_REFINED_SAMPLES // regions)
    finer = [(source, _finer(source, spacing, few)) for source, spacing in sources]
    count = sum(
        1.0 if is_sequential(source.item) else estimate_samples(source.item, spacing)
        for source, spacing in finer
    )
    return finer if MARGIN * count <= budget else sources


def _finer(source: SampleSource, spacing: float, few: int) -> float:
    """Return the spacing at which a source has about `few` samples [m], if that is finer than `spacing`."""
    item = source.item
    if not forms_region(item):
        return spacing
    dimensions = 3.0 if isinstance(item, Volume) and item.felt == "interior" else 2.0
    share = (estimate_samples(item, spacing) / few) ** (1.0 / dimensions)
    steps = round(math.log(share) / math.log(SPACING_RATIO))
    return spacing * SPACING_RATIO ** min(0, max(-MAX_STEPS, steps))
