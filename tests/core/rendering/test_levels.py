"""Rounding to a device's levels, against plain and exact arithmetic."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.native import rendering as levels
from pacinian.rendering.quantiser import SURE, Quantiser, dither_thresholds, invert_levels

TURN_ERROR = 6e-6  # [turns] of the kernel's arc tangent
PULSES = tuple(np.sin(np.pi / 2.0 * np.arange(65) / 64.0).tolist())  # amplitudes of OpenMPD
FINE = tuple(np.sin(np.pi / 2.0 * np.arange(1001) / 1000.0).tolist())
BUNCHED = (0.0, *(0.3 + 1e-6 * np.arange(300)), *(0.9 + 1e-7 * np.arange(5)), 1.0)
TABLES = {"pulses": PULSES, "fine": FINE, "bunched": BUNCHED, "two": (0.0, 1.0)}


def quantise(
    gains: Any, phases: int, amplitudes: Any, ceiling: float, threshold: Any = 0.5
) -> tuple[np.ndarray, ...]:
    can = pc.Capability(phases, amplitudes)
    g = np.ascontiguousarray(gains, np.complex64)
    phase, amplitude = np.full((2, g.size), 54321, np.uint16)
    up = np.broadcast_to(threshold, g.shape).astype(np.float32)
    top, highest = len(can.sizes) - 1, can.highest(ceiling)
    if can.uniform:
        levels.quantise(g, phases, top, highest, up, phase, amplitude)
    else:
        levels.quantise_by(g, phases, *invert_levels(can.sizes), highest, up, phase, amplitude)
    return phase.astype(int), amplitude.astype(int)


def check(g: np.ndarray, phases: int, amplitudes: int, ceiling: float) -> None:
    phase, amplitude = quantise(g, phases, amplitudes, ceiling)
    exact = np.asarray(g, np.complex64).astype(complex)
    assert (phase < phases).all()
    off = (phase - np.angle(exact) / (2 * np.pi) * phases + phases / 2) % phases - phases / 2
    assert np.abs(off[exact != 0]).max(initial=0.0) <= 0.5 + TURN_ERROR * phases
    top = amplitudes - 1
    assert (amplitude <= ceiling * top + 1e-3 + 1e-6 * top).all()
    size = np.minimum(np.abs(exact) * top, np.floor(ceiling * top + 1e-3))
    assert np.abs(amplitude - size).max(initial=0.0) <= 0.5 + 3e-7 * top


counts = st.integers(2, 4096) | st.sampled_from([2, 256, 320, 65536])


@given(
    st.lists(st.complex_numbers(max_magnitude=10.0, allow_nan=False, width=64), max_size=20),
    st.integers(0, 99),
    counts,
    counts,
    st.floats(0.0, 1.0, width=32) | st.just(1.0),
)
@settings(max_examples=200)
def test_any_gain_is_rounded_to_the_nearest_level_below_the_ceiling(
    odd: list[complex], seed: int, phases: int, amplitudes: int, ceiling: float
) -> None:
    usual = np.random.default_rng(seed).uniform(-1, 1, (500, 2)) @ [1, 1j]
    g = np.array([*odd, *usual], np.complex64)
    check(g[(np.abs(g) > 1e-18) | (g == 0)], phases, amplitudes, ceiling)


@pytest.mark.parametrize("amplitudes", [256, PULSES])
@pytest.mark.parametrize("phases", [4, 8, 256, 320])
def test_the_phase_of_each_level_is_that_level(phases: int, amplitudes: Any) -> None:
    level = np.arange(phases)
    phase, amplitude = quantise(np.exp(2j * np.pi * level / phases), phases, amplitudes, 1.0)
    assert np.array_equal(phase, level)
    assert np.array_equal(amplitude, np.full(phases, len(pc.Capability(4, amplitudes).sizes) - 1))


@pytest.mark.parametrize("threshold", [SURE, 0.5, 1.0 - SURE])
@pytest.mark.parametrize("amplitudes", [2, 256, 320, 4096, *TABLES])
def test_the_amplitude_of_each_level_is_that_level(amplitudes: Any, threshold: float) -> None:
    amplitudes = TABLES.get(amplitudes, amplitudes)
    sizes = pc.Capability(4, amplitudes).sizes
    assert np.array_equal(
        quantise(1j * sizes, 256, amplitudes, 1.0, threshold)[1], np.arange(len(sizes))
    )


def test_phases_just_below_a_turn_wrap_to_0() -> None:
    assert quantise([np.exp(-1e-6j), complex(1.0, -0.0), np.exp(-0.01j)], 256, 256, 1.0)[
        0
    ].tolist() == [0, 0, 0]


@pytest.mark.parametrize("ceiling", [0.0, 0.1, 0.5, 0.99, 1.0])
@pytest.mark.parametrize("amplitudes", [2, 256, 320, PULSES, FINE])
def test_no_amplitude_is_above_the_ceiling(ceiling: float, amplitudes: Any) -> None:
    g = np.linspace(0.0, 5.0, 5000) * np.exp(1j * np.arange(5000))
    sizes = pc.Capability(4, amplitudes).sizes
    made = sizes[quantise(g, 256, amplitudes, ceiling)[1]]
    assert made.max() == sizes[sizes <= ceiling + 1e-7].max()


@pytest.mark.parametrize("amplitudes", [256, PULSES])
def test_no_gain_is_no_amplitude(amplitudes: Any) -> None:
    assert [made.tolist() for made in quantise([0j, -0.0], 256, amplitudes, 1.0)] == [[0, 0]] * 2


@pytest.mark.parametrize("amplitudes", [256, PULSES])
@pytest.mark.parametrize("length", [1, 3, 8, 33, 300])
@pytest.mark.parametrize("bad", [complex(np.nan, 0), complex(0, np.nan), complex(1, np.nan)])
def test_nan_becomes_0_wherever_it_stands(bad: complex, length: int, amplitudes: Any) -> None:
    for place in {0, length // 2, length - 1}:
        g = np.full(length, 0.6 + 0.8j)
        g[place] = bad
        phase, amplitude = quantise(g, 256, amplitudes, 1.0)
        assert amplitude[place] == 0
        assert phase[place] < 256
        rest = np.arange(length) != place
        assert (amplitude[rest] == len(pc.Capability(4, amplitudes).sizes) - 1).all()
        assert (phase[rest] == 38).all()  # 53.13 degrees: 37.78


@given(
    st.lists(st.floats(2.0**-24, 1.0, width=32), min_size=1, max_size=40),
    st.lists(st.tuples(st.floats(0.0, 1.5, width=32), st.floats(0.0, 1.0)), min_size=1),
    st.integers(0, 2**24),
)
@settings(max_examples=300)
def test_an_amplitude_goes_to_a_neighbour_by_its_place_between_them(
    steps: list[float], asked: list[tuple[float, float]], near: int
) -> None:
    """In exact arithmetic: an amplitude is rounded up if its share of the step exceeds 1 - threshold."""
    table = np.cumsum(np.array([0.0, *steps]))
    table = np.unique(np.r_[(table / table[-1]).astype(np.float32)])
    table = table[np.r_[True, np.diff(table) > 2.0**-23]]
    table[-1] = 1.0
    asked.append((near / 2.0**24, 0.5))
    g, up = np.array([a for a, _ in asked], np.float32), np.array([t for _, t in asked], np.float32)
    made = quantise(g, 4, tuple(table.tolist()), 1.0, up)[1]
    exact = [Fraction(float(size)) for size in table]
    for a, t, level in zip(g.tolist(), up.tolist(), made.tolist(), strict=True):
        size, i = min(Fraction(a), Fraction(1)), int(np.searchsorted(table, a, "right")) - 1
        if i == len(table) - 1:
            assert level == i
            continue
        step = exact[i + 1] - exact[i]
        share = (size - exact[i]) / step + Fraction(t)
        slack = Fraction(2.0**-24) * max(Fraction(1), size / step, Fraction(i + 1) * 4)
        allowed = {i + int(share - slack), i + int(share + slack)}
        assert level in allowed, (a, t, table)


@pytest.mark.parametrize("amplitudes", [320, *TABLES])
def test_dithering_has_no_bias(amplitudes: Any) -> None:
    """If all N transducers have the same target, their mean equals it within 1/N of a step."""
    amplitudes = TABLES.get(amplitudes, amplitudes)
    sizes = pc.Capability(4, amplitudes).sizes.astype(np.float64)
    N = 997
    order, rng = dither_thresholds(N), np.random.default_rng(2)
    for a in rng.uniform(0.0, 1.0, 300).astype(np.float32).astype(float):
        made = quantise(np.full(N, a), 4, amplitudes, 1.0, order)[1]
        i = min(int(np.searchsorted(sizes, a, "right")) - 1, len(sizes) - 2)
        step = sizes[i + 1] - sizes[i]
        off = abs(sizes[made].mean() - a)
        assert off <= (1.0 / N + SURE) * step + 2e-7
        assert set(made.tolist()) <= {i, i + 1}


@pytest.mark.parametrize("amplitudes", [320, *TABLES])
@pytest.mark.parametrize("threshold", [0.0, SURE, 0.3, 0.9])
def test_more_is_never_less(amplitudes: Any, threshold: float) -> None:
    amplitudes = TABLES.get(amplitudes, amplitudes)
    a = np.unique(np.r_[np.linspace(0.0, 1.1, 20_000), pc.Capability(4, amplitudes).sizes])
    for near in (a, np.nextafter(a.astype(np.float32), 2.0, dtype=np.float32)):
        assert (np.diff(quantise(near, 4, amplitudes, 1.0, threshold)[1]) >= 0).all()


def test_rounding_down_never_rounds_up() -> None:
    a = np.random.default_rng(3).uniform(0.0, 1.0, 20_000).astype(np.float32)
    for amplitudes in (320, PULSES, FINE):
        can = pc.Capability(4, amplitudes)
        frame = Quantiser(can, 1, len(a)).make_frame(
            a[None].astype(np.complex64), 1.0, 0, 0.0, "down"
        )
        assert (can.sizes[frame.amplitude[0]] <= a * (1 + 1e-6)).all()


def test_a_table_of_even_levels_is_as_their_count() -> None:
    rng = np.random.default_rng(4)
    g = rng.uniform(0, 1.2, 5000) * np.exp(2j * np.pi * rng.random(5000))
    even = tuple((np.arange(65) / 64).tolist())
    for ceiling in (1.0, 0.7):
        made = [quantise(g, 128, given, ceiling, dither_thresholds(5000)) for given in (65, even)]
        np.testing.assert_array_equal(*made)


@given(
    seed=st.integers(0, 99),
    phases=st.integers(2, 400),
    amplitudes=st.integers(2, 400) | st.sampled_from(list(TABLES.values())),
)
def test_what_is_emitted_is_what_the_frame_says(seed: int, phases: int, amplitudes: Any) -> None:
    rng = np.random.default_rng(seed)
    g = (rng.uniform(0, 1, 40) * np.exp(1j * rng.uniform(0, 7, 40))).astype(np.complex64)
    quantiser = Quantiser(pc.Capability(phases, amplitudes), 1, 40)
    made = quantiser.quantise_gains(g, 1.0).copy()
    frame = quantiser.make_frame(g[None], 1.0, 0, 0.0)
    np.testing.assert_allclose(made, frame.gains(quantiser.capability)[0], atol=1e-6)
    step = np.hypot(np.diff(quantiser.capability.sizes).max(), np.pi / phases)
    assert np.abs(made - g).max() <= step * (1 + 1e-3)


def test_a_frame_cannot_be_changed_by_a_backend() -> None:
    frame = Quantiser(pc.Capability(), 2, 3).make_frame(np.ones((2, 3), np.complex64), 1.0, 0, 0.0)
    for values in (frame.phase, frame.amplitude):
        with pytest.raises(ValueError, match="read-only"):
            values[:] = 0
    assert (frame.amplitude == 255).all()
