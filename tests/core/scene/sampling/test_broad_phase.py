from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.native.scene import merge
from pacinian.scene.motion import MAX_EXTRAPOLATION
from pacinian.scene.sampling.culling_boxes import cull

bounded = settings(max_examples=100)
seeds = st.integers(0, 2**31)


@given(seed=seeds, count=st.integers(0, 60), boxes=st.integers(0, 4), t=st.floats(-1.0, 2.0))
@bounded
def test_near_is_what_touches_a_box(seed: int, count: int, boxes: int, t: float) -> None:
    rng = np.random.default_rng(seed)
    bounds = np.hstack(
        [
            rng.uniform(-1.0, 1.0, (count, 3)),
            rng.uniform(-3.0, 3.0, (count, 3)),
            rng.uniform(-0.5, 1.5, (count, 1)),
            rng.uniform(0.0, 0.4, (count, 1)),
        ]
    )
    low = rng.uniform(-1.0, 0.8, (boxes, 3))
    corners = np.hstack([low, low + rng.uniform(0.0, 0.5, (boxes, 3))])
    age = np.clip(t - bounds[:, 6:7], 0.0, MAX_EXTRAPOLATION)
    centres = bounds[:, :3] + age * bounds[:, 3:6]
    expected = np.zeros(count, dtype=bool)
    for box in corners:
        away = centres - np.clip(centres, box[:3], box[3:])
        expected |= np.linalg.norm(away, axis=1) <= bounds[:, 7]
    assert cull(bounds, t, corners).tolist() == np.flatnonzero(expected).tolist()


def test_a_box_without_end_holds_everything() -> None:
    everywhere = np.array([[-np.inf] * 3 + [np.inf] * 3])
    bounds = np.zeros((5, 8))
    assert cull(bounds, 0.0, everywhere).tolist() == [0, 1, 2, 3, 4]
    bounds[1:, 0] = 1e150, -1e300, 1e300, 1e308
    here = np.array([[-1.0, -1.0, -1.0, 1.0, 1.0, 1.0]])
    assert cull(bounds, 0.0, here).tolist() == [0]


def merged(seed: int, count: int, radius: float) -> tuple[Any, ...]:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.03, 0.03, (count, 3))
    P, area = rng.uniform(0.0, 10.0, count), rng.uniform(1e-5, 1e-4, count)
    source, group = np.sort(rng.integers(0, 4, count)), rng.integers(0, 2, count)
    pressed, stands = np.empty(count), np.empty(count)
    kept = np.empty(count, dtype=np.bool_)
    radii = np.full(count, radius)
    gone = merge(points, P, area, source, group, radii, pressed, stands, kept)
    return points, P, area, source, group, pressed, stands, kept, gone


@given(seed=seeds, count=st.integers(0, 80), radius=st.floats(0.0, 0.03))
@bounded
def test_merging_keeps_the_force_and_the_area_of_each_group(
    seed: int, count: int, radius: float
) -> None:
    _, P, area, _, group, pressed, stands, kept, gone = merged(seed, count, radius)
    assert gone == count - kept.sum()
    for v in (0, 1):
        mine = group == v
        force = (pressed * stands)[kept & mine].sum()
        assert np.isclose(force, (P * area)[mine].sum(), rtol=1e-9, atol=0.0)
        assert np.isclose(stands[kept & mine].sum(), area[mine].sum(), rtol=1e-9, atol=0.0)
    if count:
        assert pressed[kept].min() >= P.min() - 1e-9
        assert pressed[kept].max() <= P.max() + 1e-9


def test_two_samples_are_merged_where_they_are_near_for_both() -> None:
    points = np.array([[0.0, 0.0, 0.0], [0.003, 0.0, 0.0], [0.006, 0.0, 0.0]])
    one, kept, source = np.ones(3), np.empty(3, np.bool_), np.arange(3)
    radii, group = np.array([0.002, 0.004, 0.004]), np.zeros(3, np.intp)
    gone = merge(points, one, one, source, group, radii, np.empty(3), np.empty(3), kept)
    assert gone == 1
    assert kept.tolist() == [True, True, False]


@given(seed=seeds, count=st.integers(0, 80), radius=st.floats(0.0, 0.03))
@bounded
def test_only_near_samples_of_different_sources_and_one_group_are_merged(
    seed: int, count: int, radius: float
) -> None:
    points, P, area, source, group, pressed, stands, kept, _ = merged(seed, count, radius)
    d = np.linalg.norm(points[:, None] - points, axis=2)
    pairs = (d < radius) & (source[:, None] != source) & (group[:, None] == group)
    alone = ~pairs.any(axis=1)
    assert kept[alone].all()
    assert (pressed[alone] == P[alone]).all()
    assert (stands[alone] == area[alone]).all()
    # no two kept samples could be merged, and each merged sample has an earlier one that it was merged into
    assert not pairs[np.ix_(kept, kept)].any()
    for j in np.flatnonzero(~kept):
        assert (pairs[j] & kept)[:j].any()
