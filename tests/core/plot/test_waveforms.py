"""Pressure over time, spectrum and spectrogram, against known cases."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian import plot
from pacinian.acoustics.audibility import weigh_a
from pacinian.plot.emissions import Emission
from pacinian.plot.waveforms import (
    WINDOW,
    compute_audible_levels,
    compute_course,
    compute_spectrum,
)
from pacinian.testing import ManualClock

ARRAY = pc.lattice(0.03, 0.03)
POINT = (0.0, 0.0, 0.1)
FOCUS = pc.solve(ARRAY, [POINT], [100.0], scale="max").gains


def emission(factor: Any, rate: float) -> Emission:
    gains = (factor[:, None] * FOCUS).astype(np.complex64)
    return Emission(ARRAY, pc.Air(), rate, 0.5, gains, ())


def pulsed() -> pc.Renderer:
    point = pc.Point(position=POINT, radiation_pressure=0.1, envelope=pc.Sine(150.0))
    device = pc.backend("simulated", rate=4000.0, amplitudes=65536)
    return pc.Renderer(
        ARRAY, pc.Scene((point,)), backend=device, adaptive=False, clock=ManualClock()
    )


@given(a=st.floats(0.01, 100.0), f=st.floats(30.0, 470.0), mean=st.floats(-5.0, 5.0))
@settings(max_examples=30)
def test_a_sine_is_a_peak_of_its_amplitude(a: float, f: float, mean: float) -> None:
    rate, T = 1000.0, 200
    t = np.arange(T) / rate
    frequency, amplitude = compute_spectrum(mean + a * np.sin(2 * np.pi * f * t), rate)
    k = int(np.argmax(amplitude))
    assert frequency[k] == pytest.approx(f, abs=0.4)
    assert amplitude[k] == pytest.approx(a, rel=0.02)
    others = np.abs(frequency - f) > 15.0  # beyond three bins of 1 / T
    assert amplitude[others].max() < 0.05 * a  # side lobes of the window


def test_a_vibrating_point_is_shown_as_it_vibrates() -> None:
    page = plot.waveform(pulsed(), POINT, start=0.05, duration=0.1)
    above, below = page.axes
    t, P = above.lines[0].get_data()
    assert (t[0], len(t)) == (pytest.approx(50.0), 400)
    assert P.min() == pytest.approx(0.0, abs=0.002)
    assert P.max() == pytest.approx(0.1, rel=0.02)
    frequency, amplitude = below.lines[0].get_data()
    assert frequency[np.argmax(amplitude)] == pytest.approx(150.0, abs=1.0)
    assert amplitude.max() == pytest.approx(0.05, rel=0.02)
    assert above.get_ylabel() == "radiation pressure [Pa]"
    sound = plot.waveform(pulsed(), POINT, show="pressure", start=0.05, duration=0.1)
    expected = pc.sound_pressure(P, pc.Air())
    np.testing.assert_allclose(sound.axes[0].lines[0].get_data()[1], expected, atol=1e-6)


def test_a_course_is_the_field_of_each_row() -> None:
    factor = np.array([0.1, 0.5, 1.0j])
    off = (0.01, 0.0, 0.12)
    t, P = compute_course(emission(factor, 1000.0), off, "radiation")
    np.testing.assert_allclose(t, [0.5, 0.501, 0.502])
    p = factor * pc.field(ARRAY, FOCUS, np.array(off), precision="double", medium=pc.Air())
    np.testing.assert_allclose(P, pc.radiation_pressure(p, pc.Air()), rtol=1e-5)


@pytest.mark.parametrize("bins", [20, 50, 200])
@pytest.mark.parametrize("depth", [0.05, 0.8])
def test_an_audible_tone_has_its_level(bins: int, depth: float) -> None:
    rate, f = 96_000.0, bins / WINDOW
    t = np.arange(int(0.3 * rate)) / rate
    made = emission(np.sqrt(1.0 + depth * np.sin(2 * np.pi * f * t)), rate)
    times, frequency, level = compute_audible_levels(made, POINT, None)
    inner = level[:, (times > 0.5 + WINDOW) & (times < 0.8 - WINDOW)]
    loudest = frequency[inner.argmax(axis=0)]
    np.testing.assert_allclose(loudest, f)
    expected = 10.0 * np.log10(depth**2 / 2.0 / (1.0 + depth**2 / 2.0)) + weigh_a(np.array([f]))
    np.testing.assert_allclose(inner.max(axis=0), expected[0], atol=0.05)
    assert 20.0 <= frequency[0] < frequency[-1] <= 20_000.0


def test_steady_sound_is_not_heard() -> None:
    levels = compute_audible_levels(emission(np.ones(400), 1000.0), POINT, None)[2]
    assert levels.max() < -100.0
    silent = plot.spectrogram(pulsed(), (0.0, 0.3, 0.2), duration=0.2)
    assert silent.axes[0].get_yscale() == "log"
    assert "dB(A)" in silent.axes[0].child_axes[0].get_ylabel()


def test_they_draw_into_given_axes(axes: Callable[..., Any]) -> None:
    two = axes(2)
    assert plot.waveform(pulsed(), POINT, duration=0.05, ax=two) is two[0].figure
    one = axes()
    assert plot.spectrogram(pulsed(), POINT, duration=0.2, ax=one) is one.figure
    with pytest.raises(pc.ArgumentError, match="2 of them"):
        plot.waveform(pulsed(), POINT, duration=0.05, ax=one)


@pytest.mark.parametrize(
    ("argument", "how"),
    [
        ("point", {"point": (0.0, 0.0)}),
        ("point", {"point": (0.0, 0.0, np.nan)}),
        ("point", {"point": (0.0, 0.0, 150.0)}),  # millimetres
        ("show", {"show": "phase"}),
        ("duration", {"duration": None}),
        ("run", {"run": ARRAY}),
    ],
)
def test_bad_arguments_are_named(argument: str, how: dict[str, Any]) -> None:
    good: dict[str, Any] = {"run": pulsed(), "point": POINT, "duration": 0.1}
    with pytest.raises(pc.ArgumentError) as told:
        plot.waveform(**(good | how))
    assert told.value.argument == argument


def test_a_short_run_has_no_spectrogram() -> None:
    with pytest.raises(pc.ArgumentError, match="or more"):
        plot.spectrogram(pulsed(), POINT, duration=0.02)
    with pytest.raises(pc.ArgumentError, match="bandwidth"):
        plot.spectrogram(pulsed(), POINT, duration=0.2, bandwidth=-1.0)
