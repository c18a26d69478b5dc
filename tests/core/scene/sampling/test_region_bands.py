from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.sampling.region_bands import MIN_DIVIDED_SAMPLES, WIDER, Bands
from pacinian.scene.sampling.samples import join_samples

from ..tools import random_pose

bounded = settings(max_examples=40)
AIR, ARRAY = pc.Air(), pc.autd(3, 3)


def samples(*items: pc.Object) -> pc.Samples:
    sampler = pc.Sampler(10_000)
    sampler.prepare(ARRAY, AIR)
    return sampler.sample(pc.Scene(items))


def plate(width: float, height: float, x: float = 0.0) -> pc.Surface:
    pose = pc.Pose((x, 0.0, 0.2))
    return pc.Surface(shape=pc.Rectangle(width, height), pose=pose, radiation_pressure=1.0)


@bounded
@given(
    width=st.floats(0.005, 0.15), height=st.floats(0.005, 0.15), seed=st.integers(0, 99),
    budget=st.integers(1, 500), most=st.integers(1, 6),
)  # fmt: skip
def test_shares_sum_to_one_and_bands_are_as_few_as_do(
    width: float, height: float, seed: int, budget: int, most: int
) -> None:
    shape = pc.Rectangle(width, height)
    found = samples(pc.Surface(shape=shape, pose=random_pose(seed), radiation_pressure=1.0))
    shares = Bands().shares(found, budget, most)
    M, K = shares.shape
    assert len(found) == M
    assert 1 <= K <= most
    assert shares.sum(axis=1) == pytest.approx(np.ones(M))
    assert shares.min() >= 0.0
    counts = (shares > 0.0).sum(axis=0)
    if budget >= M or M <= MIN_DIVIDED_SAMPLES:
        assert K == 1
    elif most > K:
        assert counts.max() <= budget + K
    if K > 2:  # fewer bands would not suffice
        assert budget < M * WIDER / (K - 1)
    assert counts.max() <= M * WIDER / K + 2 or K == 1


def test_bands_lie_across_the_longest_side_and_blend_where_they_meet() -> None:
    found = samples(plate(0.12, 0.03))
    shares = Bands().shares(found, len(found) // 2, 4)
    assert shares.shape[1] == 3
    x = found.positions[:, 0]
    for band in shares.T:
        own = band > 0.0
        assert np.ptp(x[own]) < 0.75 * np.ptp(x)
        assert np.ptp(found.positions[own, 1]) == pytest.approx(0.03, abs=1e-6)
    both = ((shares > 0.0) & (shares < 1.0)).any(axis=1)
    assert 0.05 < both.mean() < 0.5


def test_points_and_small_regions_sound_in_every_band() -> None:
    point = pc.Point(position=(0.0, 0.08, 0.2), radiation_pressure=1.0)
    found = samples(plate(0.1, 0.1), plate(0.004, 0.004, 0.1), point)
    shares = Bands().shares(found, 300, 8)
    K = shares.shape[1]
    assert K > 1
    regions, counts = np.unique(found.regions, return_counts=True)
    few = np.isin(found.regions, regions[(counts <= MIN_DIVIDED_SAMPLES) | (regions < 0)])
    assert few.any()
    assert shares[few] == pytest.approx(np.full((few.sum(), K), 1.0 / K))


def test_bands_stay_where_they_are_as_a_region_turns_and_shrinks() -> None:
    bands = Bands()
    first = bands.shares(samples(plate(0.10, 0.098)), 300, 8)
    turned = samples(plate(0.098, 0.10))
    again = bands.shares(turned, 300, 8)
    assert again.shape[1] == first.shape[1]
    for band in again.T:  # still divided along x, although y is longer now
        assert np.ptp(turned.positions[band > 0.0, 1]) == pytest.approx(0.10, abs=1e-6)
    K = first.shape[1]
    count = len(turned)
    barely = int(count * WIDER / (K - 1)) + 1  # one band fewer would just suffice
    assert bands.shares(turned, barely, 8).shape[1] == K
    assert bands.shares(turned, int(1.2 * barely), 8).shape[1] < K


def test_silent_samples_do_not_make_bands() -> None:
    """A frame may be full of them. Then a few samples that fade would cut a small contact into bands."""
    found = samples(plate(0.02, 0.02))
    M = len(found)
    silent = found.changed(radiation_pressure=np.zeros(M), regions=np.full(M, -2), area=np.zeros(M))
    both = join_samples([found, silent, silent])
    assert Bands().shares(found, 2 * M, 4).shape[1] == 1
    assert Bands().shares(both, 2 * M, 4).shape[1] == 1
