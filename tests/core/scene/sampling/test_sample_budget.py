from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.modulation.technique import STM
from pacinian.scene.objects import Particles
from pacinian.scene.sampling.sample_budget import allot_budget, make_all_samples
from pacinian.scene.sampling.sample_cache import SampleCache
from pacinian.scene.sampling.sample_counts import SampleCounts, label_object
from pacinian.scene.sampling.sample_sources import WholeObject

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples

bounded = settings(max_examples=60)
SPACING = 0.01


def whole(samples: Samples) -> Samples:
    return samples


def given_by(*items: Any) -> list[Any]:
    """Return the sources of objects, highest priority first."""
    covers = SampleCache()
    order = sorted(range(len(items)), key=lambda i: -items[i].priority)
    return [(WholeObject(items[i], i, i, items[i].pose, covers, items), SPACING) for i in order]


def disc(radius: float, priority: int = 0, pressure: float = 1.0, **how: Any) -> pc.Surface:
    shape = pc.Disc(radius)
    return pc.Surface(shape=shape, radiation_pressure=pressure, priority=priority, **how)


def point(priority: int = 0, pressure: float = 1.0) -> pc.Point:
    return pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=pressure, priority=priority)


def sounded(items: Any, parts: list[Samples]) -> int:
    """Return the number of samples that sound at a time."""
    order = sorted(range(len(items)), key=lambda i: -items[i].priority)
    single = [items[i].technique.single for i in order]
    return sum(min(1, len(p)) if one else len(p) for one, p in zip(single, parts, strict=True))


objects = st.lists(
    st.one_of(
        st.builds(disc, st.floats(0.005, 0.2), st.integers(-2, 2)),
        st.builds(point, st.integers(-2, 2)),
        st.builds(
            lambda radius, priority: disc(radius, priority, technique=STM(100.0)),
            st.floats(0.005, 0.2),
            st.integers(-2, 2),
        ),
    ),
    max_size=8,
)


@given(items=objects, budgets=st.lists(st.integers(1, 300), min_size=1, max_size=5))
@bounded
def test_there_are_never_more_than_the_budget(items: Any, budgets: Any) -> None:
    coarseness: dict[int, int] = {}
    for budget in budgets:
        parts = allot_budget(given_by(*items), budget, coarseness, whole, SampleCounts())
        assert sounded(items, parts) <= budget
        if budget >= 4 * len(items) and len({item.priority for item in items}) == 1:
            assert all(len(part) for part in parts)  # coarser, but none is left out


@given(items=objects, extra=objects, budget=st.integers(1, 300))
@bounded
def test_what_is_of_lower_priority_takes_nothing_from_what_is_higher(
    items: Any, extra: Any, budget: int
) -> None:
    low = [pc.Point(position=(0, 0, 0), radiation_pressure=1.0, priority=-9) for _ in extra]
    alone = allot_budget(given_by(*items), budget, {}, whole, SampleCounts())
    both = allot_budget(given_by(*items, *low), budget, {}, whole, SampleCounts())
    for mine, again in zip(alone, both[: len(items)], strict=True):
        assert np.array_equal(mine.positions, again.positions)


@given(items=objects, budget=st.integers(1, 300))
@bounded
def test_the_same_is_shared_out_alike_for_ever(items: Any, budget: int) -> None:
    coarseness: dict[int, int] = {}
    for _ in range(20):  # until coarseness fit the budget
        first = allot_budget(given_by(*items), budget, coarseness, whole, SampleCounts())
    for _ in range(3):
        again = allot_budget(given_by(*items), budget, coarseness, whole, SampleCounts())
        for a, b in zip(first, again, strict=True):
            assert np.array_equal(a.keys, b.keys)


def test_what_trembles_about_the_budget_changes_its_spacing_once() -> None:
    coarseness: dict[int, int] = {}
    seen = []
    for i in range(40):
        items = [disc(0.1 * (1.0 + 0.1 * (-1) ** i))]
        allot_budget(given_by(*items), 310, coarseness, whole, SampleCounts())
        seen.append(coarseness[0])
    assert np.count_nonzero(np.diff(seen)) <= 1


def test_it_becomes_finer_again_when_there_is_room() -> None:
    coarseness: dict[int, int] = {}
    full = allot_budget(given_by(disc(0.1)), 400, coarseness, whole, SampleCounts())
    allot_budget(given_by(disc(0.1)), 40, coarseness, whole, SampleCounts())
    coarse = coarseness[0]
    assert coarse > 0
    for _ in range(coarse + 1):
        again = allot_budget(given_by(disc(0.1)), 1000, coarseness, whole, SampleCounts())
    assert coarseness[0] == 0
    assert np.array_equal(again[0].keys, full[0].keys)


@given(items=objects, budgets=st.lists(st.integers(1, 60), min_size=1, max_size=4))
@bounded
def test_of_each_object_what_is_asked_is_rendered_or_has_a_reason(items: Any, budgets: Any) -> None:
    coarseness: dict[int, int] = {}
    full = [len(source.at(spacing)) for source, spacing in given_by(*items)]
    for budget in budgets:
        counts, sources = SampleCounts(tuple(items)), given_by(*items)
        parts = allot_budget(sources, budget, coarseness, whole, counts, full=100_000)
        assert len(counts.objects) == len(items)
        for (source, _), part, asked in zip(sources, parts, full, strict=True):
            one = counts.objects[label_object(source.item, source.index)]
            assert (one.asked, one.rendered) == (asked, len(part))
            assert one.asked - one.rendered == sum(one.reasons.values()) == one.left_out


@given(items=objects, budget=st.integers(1, 300))
@bounded
def test_all_samples_are_made_or_one_is_refused_by_name(items: Any, budget: int) -> None:
    sources, counts = given_by(*items), SampleCounts(tuple(items))
    if sounded(items, allot_budget(sources, 10**6, {}, whole, SampleCounts(tuple(items)))) > budget:
        with pytest.raises(pc.ArgumentError) as refused:
            make_all_samples(sources, budget, whole, counts)
        labels = [label_object(item, i) for i, item in enumerate(items)]
        assert any(repr(label) in str(refused.value) for label in labels)
    else:
        parts = make_all_samples(sources, budget, whole, counts)
        assert counts.clean
        assert [len(p) for p in parts] == [len(source.at(spacing)) for source, spacing in sources]


@pytest.mark.parametrize("fine", [True, False])
def test_the_refusal_says_how_much_of_the_budget_a_contact_may_use(fine: bool) -> None:
    ball = pc.Volume(shape=pc.Sphere(0.03), pose=pc.Pose((0.0, 0.0, 0.2)), radiation_pressure=6.0)
    scene = pc.Scene((ball,), hands=(pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.2))),))
    sampler = pc.Sampler(budget=10)
    sampler.prepare(pc.autd(), pc.Air())
    sampler.mode = sampler.mode._replace(strict=True, fine=fine)
    with pytest.raises(pc.ArgumentError) as refused:
        sampler.sample(scene)
    left, share = (15, "150%") if fine else (8, "80%")
    assert f"the budget leaves {left}; raise" in str(refused.value)
    assert f"may use {share}" in str(refused.value)


def test_the_weakest_of_one_object_are_dropped() -> None:
    class Uneven(WholeObject):
        def at(self, spacing: float) -> Samples:
            made = super().at(spacing)
            return made.with_pressure(np.arange(len(made), dtype=float))

    item = pc.Volume(shape=pc.Box((1.0, 1.0, 1.0)), radiation_pressure=1.0)
    source = Uneven(item, 0, 0, pc.Pose(), SampleCache(), (item,))
    part = allot_budget([(source, 3.0)], 4, {}, whole, SampleCounts())[0]
    assert part.radiation_pressure.tolist() == [2.0, 3.0, 4.0, 5.0]


@given(
    forces=st.lists(st.tuples(st.integers(0, 9), st.integers(1, 9)), min_size=12, max_size=12),
    budget=st.integers(1, 11),
)
@bounded
def test_those_with_the_least_force_are_dropped_of_equals_the_last(
    forces: list[tuple[int, int]], budget: int
) -> None:
    """A low pressure on a large area may be felt more than a high one on a small area."""

    class Uneven(WholeObject):
        def at(self, spacing: float) -> Samples:
            P, area = np.array(forces, dtype=float).T
            return replace(super().at(spacing), radiation_pressure=P, area=area)

    item = Particles(positions=((0.0, 0.0, 0.0),) * 12, radiation_pressure=1.0)
    source = Uneven(item, 0, 0, pc.Pose(), SampleCache(), (item,))
    part = allot_budget([(source, SPACING)], budget, {}, whole, SampleCounts())[0]
    best = sorted(range(12), key=lambda i: (-forces[i][0] * forces[i][1], i))[:budget]
    kept = [forces[i] for i in sorted(best)]
    assert list(zip(part.radiation_pressure, part.area, strict=True)) == kept


@given(items=objects, budget=st.integers(1, 300))
@bounded
def test_nothing_is_made_coarser_than_it_is_large(items: Any, budget: int) -> None:
    """Otherwise the object would stay coarse for a long time after there is room again."""
    coarseness: dict[int, int] = {}
    for _ in range(3):
        allot_budget(given_by(*items), budget, coarseness, whole, SampleCounts())
    for priority, steps in coarseness.items():
        size = max(2.0 * item.bounding_radius for item in items if item.priority == priority)
        assert steps == 0 or SPACING * math.sqrt(2.0) ** (steps - 1) < size


def test_foci_that_run_count_as_one_each_and_keep_their_fineness() -> None:
    items = [disc(0.2, technique=STM(50.0)) for _ in range(3)]
    parts = allot_budget(given_by(*items), 2, {}, whole, SampleCounts())
    assert [len(part) > 1000 for part in parts] == [True, True, False]


def test_points_and_foci_that_run_keep_their_keys_while_others_get_coarser() -> None:
    items = [point(), disc(0.05, technique=STM(50.0)), disc(0.2)]
    coarseness: dict[int, int] = {}
    fine, coarse = (
        allot_budget(given_by(*items), n, coarseness, whole, SampleCounts()) for n in (2000, 50)
    )
    for mine, again in zip(fine[:2], coarse[:2], strict=True):
        assert np.array_equal(mine.keys, again.keys)
    assert not set(fine[2].keys.tolist()) & set(coarse[2].keys.tolist())


def test_what_may_not_sound_takes_none_of_the_budget() -> None:
    def right(samples: Samples) -> Samples:
        return samples.only(samples.positions[:, 0] > 0.0)

    parts = allot_budget(given_by(disc(0.05)), 41, {}, right, SampleCounts())
    assert 20 <= len(parts[0]) <= 41
