from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.sampling.ramps import MAX_RAMPED_MOVE, MAX_TICK, PressureRamps
from pacinian.scene.sampling.samples import Samples, no_samples

bounded = settings(max_examples=100)
RAMP, TICK = 0.005, 0.001
SHARE = np.sin(np.pi / 2.0 * np.arange(6) / 5.0) ** 2  # raised cosine, for each tick
UP = dict(enumerate((10.0 * SHARE).tolist()))  # pressure after each number of ticks [Pa]
ITEMS = tuple(
    pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=P, name=name)
    for name, P in (("a", 10.0), ("b", 10.0), ("c", 1.0))
)


def samples(what: dict[int, tuple[float, float]], items: Any = ITEMS) -> Samples:
    """Return a sample for each key, at x [m] with a share of its object's pressure. Keys go round the objects."""
    M = len(what)
    x, share = np.array(list(what.values())).reshape(M, 2).T
    objects = np.array([key % len(items) for key in what], dtype=np.intp)
    most = np.array([items[i].pressure for i in objects])
    return Samples(
        np.stack([x, np.zeros(M), np.full(M, 0.2)], axis=-1),
        share * most,
        np.zeros((M, 3)),
        np.ones(M),
        objects,
        np.array(list(what), dtype=np.int64),
        most,
        np.full(M, -1),
        items,
    )


def at(given: Samples) -> dict[tuple[int, float], float]:
    """Return the pressure of each sample, by its object's name and its position."""
    out: dict[Any, float] = {}
    for m in range(len(given)):
        key = given.items[given.objects[m]].name, given.positions[m, 0]
        out[key] = out.get(key, 0.0) + given.radiation_pressure[m]
    return out


shares = st.floats(0.0, 1.0)
shown = st.dictionaries(
    st.integers(0, 7), st.tuples(st.sampled_from([0.0, 0.1, 0.2]), shares), max_size=5
)
scenes = st.lists(st.tuples(shown, st.integers(1, 4)), min_size=1, max_size=6)


@given(scenes=scenes)
@bounded
def test_no_pressure_changes_faster_than_the_ramp_allows(scenes: Any) -> None:
    ramps, t = PressureRamps(RAMP), 0.0
    before: dict[float, float] = {}
    number: dict[float, int] = {}
    for what, ticks in scenes:
        for _ in range(ticks):
            now = ramps.follow(samples(what), t)
            assert len(set(now.keys.tolist())) == len(now)
            assert (now.radiation_pressure >= 0.0).all()
            assert (now.radiation_pressure <= 10.0).all()
            places = now.positions[:, 0].tolist()
            after = {x: now.radiation_pressure[now.positions[:, 0] == x].sum() for x in places}
            count = {x: places.count(x) for x in places}
            for x in after | before:
                most = 10.0 * max(count.get(x, 0), number.get(x, 0))
                change = abs(after.get(x, 0.0) - before.get(x, 0.0))
                assert change <= np.pi / 2.0 * TICK / RAMP * most * (1.0 + 1e-5)
            before, number, t = after, count, t + TICK


@given(scenes=scenes, last=shown)
@bounded
def test_all_settles_to_the_very_samples_asked_for(scenes: Any, last: Any) -> None:
    ramps, t = PressureRamps(RAMP), 0.0
    for what, ticks in scenes:
        for _ in range(ticks):
            ramps.follow(samples(what), t)
            t += TICK
    asked = samples(last)
    for _ in range(7):
        now = ramps.follow(asked, t)
        t += TICK
    assert now is asked
    assert ramps.settled


def test_it_comes_up_as_a_raised_cosine_and_goes_so_in_the_time_of_the_ramp() -> None:
    ramps, here, gone = PressureRamps(RAMP), samples({0: (0.0, 1.0)}), no_samples(ITEMS)
    up = [ramps.follow(here, TICK * i).radiation_pressure[0] for i in range(7)]
    assert up == pytest.approx([*UP.values(), 10.0], rel=1e-4)
    assert up[5] == 10.0
    down = [ramps.follow(gone, TICK * i).radiation_pressure.sum() for i in range(7, 13)]
    assert down == pytest.approx([*list(UP.values())[-2::-1], 0.0], rel=1e-4, abs=1e-9)
    assert ramps.follow(gone, 0.013) is gone


@given(most=st.floats(1e-6, 1e6), ticks=st.integers(1, 64))
@bounded
def test_strong_or_weak_it_takes_the_time_of_the_ramp_and_starts_and_ends_slowly(
    most: float, ticks: int
) -> None:
    item = (pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=most),)
    ramps, here = PressureRamps(RAMP), samples({0: (0.0, 1.0)}, item)
    P = [ramps.follow(here, i * RAMP / ticks).radiation_pressure[0] for i in range(ticks + 1)]
    assert P[-1] == most
    assert ramps.settled
    steps = np.diff(P) / most
    assert steps.max() <= np.pi / 2.0 / ticks + 1e-5
    assert max(steps[0], steps[-1]) <= (np.pi / 2.0 / ticks) ** 2 + 1e-5


def test_a_ramp_ends_although_rounding_puts_its_target_above_the_highest_pressure() -> None:
    asked = samples({0: (0.0, 1.0), 1: (0.1, 1.0)})
    above = asked.changed(radiation_pressure=np.nextafter(asked.most, np.inf))
    ramps = PressureRamps(RAMP)
    for k in range(10):
        last = ramps.follow(above, TICK * k)
    assert last is above


def test_what_is_switched_off_fades_as_it_vibrated() -> None:
    on = (pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=10.0, name="a"),)
    off = (
        pc.Point(
            position=(0.0, 0.0, 0.2), radiation_pressure=10.0, name="a", envelope=pc.Constant(0.0)
        ),
    )
    ramps = PressureRamps(RAMP)
    for i in range(7):
        ramps.follow(samples({0: (0.0, 1.0)}, on), TICK * i)
    now = ramps.follow(no_samples(off), 0.007)
    assert now.items[now.objects[0]] is on[0]


def test_what_moves_a_little_keeps_its_pressure_and_what_jumps_does_not() -> None:
    for d, expected in (
        (0.9 * MAX_RAMPED_MOVE, {("a", 0.9 * MAX_RAMPED_MOVE): 10.0}),
        (1.1 * MAX_RAMPED_MOVE, {("a", 0.0): UP[4], ("a", 1.1 * MAX_RAMPED_MOVE): UP[1]}),
    ):
        ramps = PressureRamps(RAMP)
        for i in range(7):
            ramps.follow(samples({0: (0.0, 1.0)}), TICK * i)
        assert at(ramps.follow(samples({0: (d, 1.0)}), 0.007)) == pytest.approx(expected, rel=1e-4)


def test_what_comes_back_comes_up_from_what_is_left_of_it() -> None:
    ramps, here, gone = PressureRamps(RAMP), samples({0: (0.0, 1.0)}), no_samples(ITEMS)
    for i in range(7):
        ramps.follow(here, TICK * i)
    ramps.follow(gone, 0.007)
    assert ramps.follow(gone, 0.008).radiation_pressure == pytest.approx([UP[3]], rel=1e-4)
    now = ramps.follow(here, 0.009)
    assert now.radiation_pressure == pytest.approx([UP[4]], rel=1e-4)
    assert now.keys.tolist() == [0]


def test_it_goes_down_to_a_fraction_of_itself_as_fast() -> None:
    ramps = PressureRamps(RAMP)
    for i in range(10):
        ramps.follow(samples({0: (0.0, 1.0)}), TICK * i)
    faint = (ITEMS[0].__class__(position=(0.0, 0.0, 0.2), radiation_pressure=1e-3, name="a"),)
    asked = samples({0: (0.0, 1.0)}, faint)
    P = [ramps.follow(asked, TICK * i).radiation_pressure[0] for i in range(10, 15)]
    assert (np.diff(P) <= 0.0).all()
    assert P[0] >= UP[4] - 1e-3
    assert P[-1] == 1e-3


def test_objects_that_are_gone_are_known_while_they_fade() -> None:
    ramps = PressureRamps(RAMP)
    for i in range(7):
        ramps.follow(samples({0: (0.0, 1.0), 1: (0.1, 1.0)}), TICK * i)
    left = (ITEMS[1],)
    now = ramps.follow(samples({1: (0.1, 1.0)}, left), 0.007)
    assert at(now) == pytest.approx({("a", 0.0): UP[4], ("b", 0.1): 10.0}, rel=1e-4)
    assert now.items == (ITEMS[1], ITEMS[0])


def test_samples_of_an_object_that_is_still_there_fade_as_its_own() -> None:
    ramps = PressureRamps(RAMP)
    for i in range(7):
        ramps.follow(samples({0: (0.0, 1.0), 3: (0.1, 1.0)}), TICK * i)
    stronger = tuple(
        pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=12.0, name=item.name)
        for item in ITEMS
    )
    now = ramps.follow(samples({3: (0.1, 1.0)}, stronger), 0.007)
    assert now.items is stronger
    assert now.objects.tolist() == [0, 0]


def test_nothing_grows_while_samples_come_and_go() -> None:
    ramps = PressureRamps(RAMP)
    for i in range(300):
        now = ramps.follow(samples({i: (0.0, 1.0)}, ITEMS[:1]), TICK * i)
        assert len(now) <= 1 + RAMP / TICK
        assert len(now.items) == 1


def test_without_a_ramp_it_follows_at_once() -> None:
    ramps, first, second = PressureRamps(0.0), samples({0: (0.0, 1.0)}), samples({1: (0.0, 1.0)})
    assert ramps.follow(first, 0.0) is first
    assert ramps.follow(second, 0.0) is second


@pytest.mark.parametrize("later", [0.0, -1e3, -1e-3])
def test_while_time_stands_still_or_jumps_back_nothing_changes(later: float) -> None:
    ramps, asked = PressureRamps(RAMP), samples({0: (0.0, 1.0)})
    for i in range(3):
        before = ramps.follow(asked, TICK * i)
    P = before.radiation_pressure
    now = ramps.follow(no_samples(ITEMS), 0.002 + later)
    assert now.radiation_pressure.tolist() == P.tolist()
    again = ramps.follow(no_samples(ITEMS), 0.002 + later + TICK)
    assert again.radiation_pressure == pytest.approx([UP[1]], rel=1e-4)


def test_a_jump_of_time_counts_for_a_moment_only() -> None:
    ramps = PressureRamps(1.0)
    asked = samples({0: (0.0, 1.0)})
    ramps.follow(asked, 0.0)
    assert ramps.follow(asked, 1e6).radiation_pressure == pytest.approx(
        [10.0 * np.sin(np.pi / 2.0 * MAX_TICK) ** 2], rel=1e-4
    )


def test_the_samples_given_are_left_as_they_are() -> None:
    asked = samples({0: (0.0, 1.0), 1: (0.1, 0.5)})
    kept = replace(asked, radiation_pressure=asked.radiation_pressure.copy())
    ramps = PressureRamps(RAMP)
    for i in range(4):
        ramps.follow(asked if i % 2 else samples({2: (0.0, 1.0)}), TICK * i)
    assert np.array_equal(asked.radiation_pressure, kept.radiation_pressure)
    assert asked.keys.tolist() == [0, 1]


def patch(spacing: float, middle: float = 0.0, first: int = 0, pressure: float = 10.0) -> Samples:
    """Return a region of 20 x 20 mm. spacing: of its samples [m]."""
    count = round(0.02 / spacing)
    x = middle + (np.arange(count) + 0.5) * spacing - 0.01
    q = np.stack([*np.meshgrid(x, x - middle), np.full((count, count), 0.2)], axis=-1).reshape(
        -1, 3
    )
    M = len(q)
    return Samples(
        q, np.full(M, pressure), np.zeros((M, 3)), np.full(M, spacing**2), np.zeros(M, dtype=np.intp),
        first + np.arange(M), np.full(M, 10.0), np.zeros(M, dtype=np.int64), ITEMS,
    )  # fmt: skip


@pytest.mark.parametrize("spacings", [(0.004, 0.0025), (0.0025, 0.005), (0.005, 0.001)])
def test_a_region_that_is_sampled_otherwise_goes_on_as_it_was(spacings: Any) -> None:
    ramps, (before, after) = PressureRamps(RAMP), spacings
    for t in np.arange(0.0, 2.0 * RAMP, TICK):
        ramps.follow(patch(before), t)
    then = ramps.follow(patch(after, first=1000), 2.0 * RAMP)
    assert len(then) == len(patch(after))
    np.testing.assert_allclose(then.radiation_pressure, 10.0)


def test_a_region_half_way_up_goes_on_from_there_and_never_above_what_is_asked() -> None:
    ramps = PressureRamps(RAMP)
    ramps.follow(patch(0.004), 0.0)
    ramps.follow(patch(0.004), 0.4 * RAMP)
    then = ramps.follow(patch(0.0025, first=1000), 0.6 * RAMP)
    np.testing.assert_allclose(then.radiation_pressure, UP[3], rtol=1e-4)
    then = ramps.follow(patch(0.002, first=2000, pressure=1.0), 0.6 * RAMP)
    np.testing.assert_allclose(then.radiation_pressure, 1.0)


def test_what_a_region_grows_by_comes_up_and_what_it_loses_fades() -> None:
    ramps = PressureRamps(RAMP)
    for t in np.arange(0.0, 2.0 * RAMP, TICK):
        ramps.follow(patch(0.0025), t)
    moved = patch(0.0025, middle=0.0112, first=1000)
    then = ramps.follow(moved, 2.0 * RAMP)
    P, x = then.radiation_pressure, then.positions[:, 0]
    assert len(then) == len(moved) + 4 * 8  # plus the half that is left behind
    grown = x[: len(moved)] > 0.012  # the row before that lies on the area of the old samples
    np.testing.assert_allclose(P[: len(moved)], np.where(grown, UP[1], 10.0), rtol=1e-4)
    np.testing.assert_allclose(P[len(moved) :], UP[4], rtol=1e-4)


def test_another_region_in_the_same_place_comes_up_from_nothing() -> None:
    ramps = PressureRamps(RAMP)
    for t in np.arange(0.0, 2.0 * RAMP, TICK):
        ramps.follow(patch(0.0025), t)
    other = replace(patch(0.0025, first=1000), regions=np.ones(64, dtype=np.int64))
    then = ramps.follow(other, 2.0 * RAMP)
    np.testing.assert_allclose(then.radiation_pressure, np.repeat([UP[1], UP[4]], 64), rtol=1e-4)
