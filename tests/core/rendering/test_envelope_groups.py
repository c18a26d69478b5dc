from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.rendering.envelope_groups import EnvelopeGroups, split_contributions
from pacinian.scene.modulation.envelope import resolve
from pacinian.scene.modulation.technique import AM, LM, STM, Simultaneous
from pacinian.scene.modulation.waves import Pulse

bounded = settings(max_examples=25)
seeds = st.integers(0, 2**32 - 1)
ARRAY = pc.autd()
T = np.arange(40) / 2000.0  # [s]


def point(x: float = 0.0, pressure: float = 2.0, **options: Any) -> pc.Point:
    return pc.Point(position=(x, 0.0, 0.15), radiation_pressure=pressure, **options)


def groups(*items: Any) -> EnvelopeGroups:
    return EnvelopeGroups(pc.Sampler().sample(pc.Scene(items)))


def test_objects_with_one_amplitude_over_time_are_one_group() -> None:
    wave = pc.Sine(frequency=100.0)
    items = (
        point(0.00, envelope=wave),
        point(0.03),
        point(0.06, envelope=pc.Sine(frequency=100.0)),  # equal, but not identical
        point(0.09, envelope=wave, technique=AM(frequency=30.0)),
        point(0.12, envelope=pc.Constant(1.0)),
    )
    made = groups(*items)
    assert made.index.tolist() == [0, 1, 0, 2, 1]
    assert len(made) == 3
    assert [item.envelope for item in made.items] == [wave, pc.Constant(), wave]


def test_no_samples_have_no_group() -> None:
    made = groups()
    assert len(made) == 0
    assert made.steady
    assert made.strength(T).shape == (0, len(T))


@pytest.mark.parametrize(
    ("options", "steady"),
    [
        ({}, True),
        ({"envelope": pc.Constant(0.3)}, True),
        ({"envelope": pc.Sine(frequency=0.0)}, False),
        ({"technique": AM()}, False),
        ({"technique": STM(frequency=50.0)}, False),
        ({"technique": LM(frequency=50.0, amplitude=0.002)}, False),
    ],
)
def test_only_what_is_constant_and_stays_is_steady(options: dict[str, Any], steady: bool) -> None:
    made = groups(point(), point(0.03, **options))
    assert made.steady is steady
    for t in T, T[:1], T[5:]:
        factors = [resolve(each.envelope).at(t) * each.technique.factor(t) for each in made.items]
        expected = np.clip(np.array([f * np.ones(len(t)) for f in factors]), 0.0, 1.0)
        np.testing.assert_array_equal(made.strength(t), expected)


def test_strength_is_the_envelope_times_the_techniques_factor() -> None:
    wave, am = pc.Square(frequency=50.0), AM(frequency=100.0, depth=0.5)
    expected = wave.at(T) * (0.75 - 0.25 * np.cos(2.0 * np.pi * 100.0 * T))
    made = groups(point(envelope=wave, technique=am), point(0.03))
    np.testing.assert_allclose(made.strength(T), [expected, np.ones(len(T))], atol=1e-12)


@pytest.mark.parametrize("value", [-3.0, 7.0, math.nan, math.inf, -math.inf])
def test_strength_is_within_0_to_1_whatever_an_envelope_says(value: float) -> None:
    class Foreign:
        def at(self, t: Any) -> Any:
            return np.full(len(t), value)

    strength = groups(point(envelope=Foreign())).strength(T)
    assert (strength == (1.0 if value > 0.0 else 0.0)).all()


def made(seed: int, count: int) -> tuple[pc.Session, pc.Solution, Any]:
    """Return a solution that meets its targets, with a group for each sample."""
    rng = np.random.default_rng(seed)
    M = int(rng.integers(count, 9))
    q = np.column_stack([0.02 * np.arange(M) - 0.08, rng.uniform(-0.05, 0.05, M), np.full(M, 0.15)])
    session = pc.Session(ARRAY)
    solution = session.solve(q, rng.uniform(20.0, 200.0, M))
    return session, solution, rng.integers(0, count, M)


@bounded
@given(seeds, st.integers(1, 4))
def test_contributions_add_up_to_the_solution(seed: int, count: int) -> None:
    session, solution, index = made(seed, count)
    parts = split_contributions(solution, session.propagator, index, count)
    assert parts.shape == (count + 1, len(ARRAY))
    np.testing.assert_allclose(parts.sum(axis=0), solution.gains, atol=1e-6)


@bounded
@given(seeds, st.integers(1, 4))
def test_a_contribution_sounds_at_its_own_samples_alone(seed: int, count: int) -> None:
    session, solution, index = made(seed, count)
    parts = split_contributions(solution, session.propagator, index, count)
    p = session.propagator.B @ parts.T
    expected = np.zeros_like(p)
    expected[np.arange(len(p)), index] = solution.sound_pressure
    np.testing.assert_allclose(p, expected, atol=2e-3 * np.abs(solution.sound_pressure).max())


def test_points_that_cannot_be_told_apart_have_contributions_too() -> None:
    session = pc.Session(ARRAY)
    q = np.array([[0.0, 0.0, 0.15]] * 3)
    solution = session.solve(q, np.full(3, 100.0))
    parts = split_contributions(solution, session.propagator, np.arange(3), 3)
    assert np.isfinite(parts).all()
    np.testing.assert_allclose(parts.sum(axis=0), solution.gains, atol=1e-6)
    assert np.abs(parts[:3]).max() < 2.0  # not huge parts that cancel each other


def test_a_pulse_is_a_group_of_its_own_start() -> None:
    early, late = (point(x, envelope=Pulse(0.01, start=x)) for x in (0.0, 0.03))
    assert len(groups(early, late)) == 2
    assert isinstance(early.technique, Simultaneous)


def test_an_envelope_that_works_in_place_changes_no_other() -> None:
    class InPlace:
        def at(self, t: Any) -> Any:
            t *= 10.0
            return t

    items = point(0.0, envelope=InPlace()), point(0.03, envelope=pc.Sine(100.0))
    times = T.copy()
    strength = groups(*items).strength(times)
    np.testing.assert_array_equal(times, T)
    np.testing.assert_allclose(strength, [np.clip(10.0 * T, 0.0, 1.0), pc.Sine(100.0).at(T)])
