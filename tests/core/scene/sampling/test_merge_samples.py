"""Samples of different objects merge where the array cannot resolve them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.region_numbers import ISOLATED
from pacinian.scene.modulation.technique import AM, STM
from pacinian.scene.sampling.merge_samples import (
    MAX_MERGE_SAMPLES,
    MERGE_SPACING_FRACTION,
    SAME_PLACE_DISTANCE,
    merge_samples,
)
from pacinian.scene.sampling.sample_counts import MERGED, SampleCounts
from pacinian.scene.sampling.samples import Samples, no_samples

bounded = settings(max_examples=60)
SPACING = 0.01  # [m]
NEAR = 0.9 * MERGE_SPACING_FRACTION * SPACING  # [m]


def place(item: Any, index: int, *x: float, region: int = ISOLATED) -> Samples:
    """Return samples on the x axis, each with the pressure of its object and an area of 1 mm^2."""
    M = len(x)
    return no_samples((POINT,) * 4).changed(
        positions=np.array([(v, 0.0, 0.2) for v in x]), radiation_pressure=np.full(M, item.pressure),
        normals=np.zeros((M, 3)), area=np.full(M, 1e-6), objects=np.full(M, index),
        keys=np.arange(M) + 1000 * index, most=np.full(M, item.pressure), regions=np.full(M, region),
    )  # fmt: skip


POINT = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=2.0)
STRONG = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=4.0)


def merged(*parts: Samples, items: Any = None, **how: Any) -> tuple[Samples, int]:
    """Return the samples, and how many were counted as merged."""
    counts = SampleCounts((POINT,) * 4)
    items = items or [POINT] * len(parts)
    samples = merge_samples(list(parts), items, how.pop("spacing", SPACING), counts, **how)
    return samples, counts.total(MERGED)


def test_the_first_sample_takes_the_force_and_the_area_of_the_next() -> None:
    samples, count = merged(place(POINT, 0, 0.0, 0.05), place(STRONG, 1, NEAR))
    assert count == 1
    assert samples.positions[:, 0].tolist() == [0.0, 0.05]
    assert samples.radiation_pressure == pytest.approx([3.0, 2.0])
    assert samples.area == pytest.approx([2e-6, 1e-6])
    assert samples.keys.tolist() == [0, 1]


def test_samples_of_one_object_and_those_apart_stay() -> None:
    part = place(POINT, 0, 0.0, NEAR)
    assert merged(part) == (part, 0)
    samples, count = merged(
        place(POINT, 0, 0.0), place(POINT, 1, 1.01 * MERGE_SPACING_FRACTION * SPACING)
    )
    assert (len(samples), count) == (2, 0)


@pytest.mark.parametrize("change", [{"envelope": pc.Sine(50.0)}, {"technique": STM(50.0)}])
def test_another_envelope_or_technique_keeps_samples_apart(change: Any) -> None:
    parts = place(POINT, 0, 0.0), place(POINT, 1, NEAR), place(POINT, 2, 2.0 * NEAR)
    other = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=2.0, **change)
    assert len(merged(*parts, items=[POINT, other, POINT])[0]) == 3
    assert len(merged(*parts, items=[other, other, POINT])[0]) == 2
    # equal values are one group, even if they are other objects
    twin = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=2.0, **change)
    assert len(merged(*parts[:2], items=[other, twin])[0]) == 1


@pytest.mark.parametrize("how", [{"strict": True}, {"region": 7}])
def test_of_regions_and_if_strict_only_samples_at_one_place_merge(how: Any) -> None:
    region = how.pop("region", ISOLATED)
    for away, count in ((0.5 * SAME_PLACE_DISTANCE, 1), (2.0 * SAME_PLACE_DISTANCE, 2)):
        parts = place(POINT, 0, 0.0), place(POINT, 1, away, region=region)
        assert len(merged(*parts, **how)[0]) == count


def test_without_a_spacing_the_default_holds() -> None:
    parts = place(POINT, 0, 0.0), place(POINT, 1, 0.004)
    assert len(merged(*parts, spacing=None)[0]) == 1
    assert len(merged(*parts, spacing=0.006)[0]) == 2


def test_silent_samples_that_merge_are_not_counted() -> None:
    silent = place(POINT, 1, NEAR).with_pressure(np.zeros(1))
    samples, count = merged(place(POINT, 0, 0.0), silent)
    assert (len(samples), count) == (1, 0)


def test_too_many_samples_are_only_joined() -> None:
    half = np.linspace(0.0, 1e-3, MAX_MERGE_SAMPLES // 2)
    assert len(merged(place(POINT, 0, *half), place(POINT, 1, *half))[0]) < MAX_MERGE_SAMPLES
    parts = place(POINT, 0, *half, 0.0), place(POINT, 1, *half)
    assert len(merged(*parts)[0]) == MAX_MERGE_SAMPLES + 1


@given(
    seed=st.integers(0, 2**31), sizes=st.lists(st.integers(0, 20), min_size=1, max_size=4),
)  # fmt: skip
@bounded
def test_merging_keeps_the_force_of_each_envelope(seed: int, sizes: list[int]) -> None:
    rng = np.random.default_rng(seed)
    waves = [pc.Sine(50.0), pc.Sine(60.0)]
    items = [
        pc.Point(
            position=(0.0, 0.0, 0.2), radiation_pressure=float(rng.uniform(1.0, 5.0)),
            envelope=waves[rng.integers(2)], technique=AM(80.0),
        )
        for _ in sizes
    ]  # fmt: skip
    parts = [
        place(item, i, *rng.uniform(0.0, 0.05, size)) if size else no_samples((POINT,) * 4)
        for i, (item, size) in enumerate(zip(items, sizes, strict=True))
    ]
    samples, count = merged(*parts, items=items)
    assert count == sum(sizes) - len(samples)
    for wave in waves:
        own = np.isin(samples.objects, [i for i, item in enumerate(items) if item.envelope == wave])
        force = sum(p.force for p, item in zip(parts, items, strict=True) if item.envelope == wave)
        assert samples.only(own).force == pytest.approx(force)
