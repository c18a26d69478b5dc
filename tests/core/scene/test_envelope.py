from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.sampling import envelopes

bounded = settings(deadline=None, derandomize=True)
levels = st.floats(0.0, 1.0)
frequencies = st.floats(0.0, 1e5)
times = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=20).map(np.array)


@st.composite
def spans(draw: st.DrawFn) -> tuple[float, float]:
    """A low and a high."""
    low, high = sorted((draw(levels), draw(levels)))
    return low, high


any_envelope = st.one_of(
    levels.map(pc.Constant),
    st.builds(lambda f, s: pc.Sine(f, *s), frequencies, spans()),
    st.builds(lambda f, s, d: pc.Square(f, *s, duty=d), frequencies, spans(), levels),
)


@given(envelope=any_envelope, t=times)
@bounded
def test_every_envelope_stays_within_its_bounds(envelope: Any, t: Any) -> None:
    value = envelope.at(t)
    assert value.shape == t.shape
    assert value.dtype == np.float64
    low, high = getattr(envelope, "low", 0.0), getattr(envelope, "high", 1.0)
    assert (value >= low).all()
    assert (value <= high + 1e-15).all()
    assert (value <= 1.0).all()


@given(level=levels, t=times)
@bounded
def test_a_constant_is_its_level_at_all_times(level: float, t: Any) -> None:
    assert (pc.Constant(level).at(t) == level).all()


def test_a_constant_is_full_unless_given() -> None:
    assert pc.Constant() == pc.Constant(1.0)


@given(frequency=st.floats(0.1, 1e4), span=spans(), cycle=st.integers(0, 1000))
@bounded
def test_a_sine_starts_low_and_is_high_half_a_period_later(
    frequency: float, span: tuple[float, float], cycle: int
) -> None:
    low, high = span
    phase = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    value = pc.Sine(frequency, low, high).at((cycle + phase) / frequency)
    middle = (low + high) / 2
    assert value == pytest.approx([low, middle, high, middle, low], abs=1e-9)


def test_a_sine_has_its_frequency_and_no_other() -> None:
    t = np.arange(4000) / 4000.0
    spectrum = np.abs(np.fft.rfft(pc.Sine(200.0, 0.2, 0.8).at(t))) / 4000
    assert spectrum[0] == pytest.approx(0.5)
    assert spectrum[200] == pytest.approx(0.15)
    spectrum[[0, 200]] = 0.0
    assert spectrum.max() < 1e-9


@given(frequency=st.floats(0.1, 1e4), span=spans(), duty=levels)
@bounded
def test_a_square_is_high_for_its_duty_of_each_period_and_then_low(
    frequency: float, span: tuple[float, float], duty: float
) -> None:
    low, high = span
    phase = (np.arange(1000) + 0.5) / 1000
    value = pc.Square(frequency, low, high, duty=duty).at((3 + phase) / frequency)
    clear = np.abs(phase - duty) > 1e-9
    assert (value == np.where(phase < duty, high, low))[clear].all()


@pytest.mark.parametrize(("duty", "level"), [(0.0, 0.1), (1.0, 0.9)])
def test_a_duty_of_none_or_all_is_steady(duty: float, level: float) -> None:
    value = pc.Square(200.0, 0.1, 0.9, duty=duty).at(np.linspace(0, 1, 999))
    assert (value == level).all()


@pytest.mark.parametrize("kind", [pc.Sine, pc.Square])
def test_no_frequency_is_steady(kind: Any) -> None:
    assert len(set(kind(0.0).at(np.linspace(-5, 5, 99)).tolist())) == 1


@given(
    values=st.lists(st.floats(), min_size=1, max_size=20),
)
@bounded
def test_a_function_is_clipped_and_its_nan_is_nothing(values: list[float]) -> None:
    t = np.zeros(len(values))
    value = pc.Function(lambda _: np.array(values)).at(t)
    expected = [0.0 if math.isnan(v) else min(max(v, 0.0), 1.0) for v in values]
    assert value.tolist() == expected


@pytest.mark.parametrize("answer", [0.5, np.float32(0.5), [0.5], np.array(0.5)])
def test_a_function_may_give_one_value_for_all_times(answer: Any) -> None:
    assert pc.Function(lambda _: answer).at(np.zeros(3)).tolist() == [0.5] * 3


def test_a_function_is_given_the_times() -> None:
    t = np.array([0.1, 0.2, 0.7])
    assert pc.Function(lambda t: t).at(t).tolist() == t.tolist()


@pytest.mark.parametrize("bad", [-0.1, 1.1, math.nan, math.inf, "high", None])
@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (pc.Constant, "level"),
        (lambda x: pc.Sine(100.0, low=x), "low"),
        (lambda x: pc.Sine(100.0, high=x), "high"),
        (lambda x: pc.Square(100.0, low=x), "low"),
        (lambda x: pc.Square(100.0, high=x), "high"),
        (lambda x: pc.Square(100.0, duty=x), "duty"),
    ],
)
def test_levels_outside_of_0_to_1_are_refused_by_name(make: Any, argument: str, bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
        make(bad)


@pytest.mark.parametrize("kind", [pc.Sine, pc.Square])
@pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf, "fast", None])
def test_bad_frequencies_are_refused_by_name(kind: Any, bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`frequency` "):
        kind(bad)


@pytest.mark.parametrize("kind", [pc.Sine, pc.Square])
def test_a_low_above_the_high_is_refused(kind: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`high` must be 0\.7 or more"):
        kind(100.0, low=0.7, high=0.3)


def test_a_sine_too_fast_for_floats_is_refused_or_stays_within_0_to_1() -> None:
    try:
        fast = pc.Sine(1e308)
    except pc.ArgumentError:
        return
    assert 0.0 <= fast.at(np.array([10.0]))[0] <= 1.0


@pytest.mark.parametrize("envelope", [pc.Constant(0.5), pc.Sine(1.0), pc.Square(1.0)])
def test_envelopes_cannot_be_changed(envelope: Any) -> None:
    for name in envelope.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(envelope, name, 0.1)


def test_the_envelopes_of_objects_are_a_row_each() -> None:
    t = np.array([0.0, 0.005])
    objects = tuple(
        pc.Point(position=(0, 0, 0.2), radiation_pressure=1.0, envelope=envelope)
        for envelope in (pc.Constant(0.5), pc.Sine(100.0), pc.Function(lambda t: 2 * t))
    )
    assert envelopes(objects, t) == pytest.approx(np.array([[0.5, 0.5], [0.0, 1.0], [0.0, 0.01]]))
    assert envelopes((), t).shape == (0, 2)
