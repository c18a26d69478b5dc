from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.acoustics import kernels

TURN_ERROR = 6e-6  # [turns] of the kernel's arc tangent


def quantise(gains: Any, phases: int, amplitudes: int, ceiling: float) -> tuple[np.ndarray, ...]:
    g = np.ascontiguousarray(gains, np.complex64)
    phase, amplitude = np.full((2, g.size), 54321, np.uint16)
    half = np.full(g.size, 0.5, np.float32)
    kernels.quantise(g, phases, amplitudes, np.float32(ceiling), half, phase, amplitude)
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


@pytest.mark.parametrize(
    ("phases", "amplitudes", "ceiling"),
    [
        (256, 256, 1.0),
        (256, 320, 1.0),
        (256, 320, 0.5),
        (512, 2, 1.0),
        (16, 65536, 0.3),
        (65536, 65536, 1.0),
    ],
)
def test_gains_are_rounded_to_the_nearest_level(
    phases: int, amplitudes: int, ceiling: float
) -> None:
    rng = np.random.default_rng(5)
    check(rng.uniform(-1, 1, 20_000) + 1j * rng.uniform(-1, 1, 20_000), phases, amplitudes, ceiling)


@given(
    st.lists(st.complex_numbers(max_magnitude=10.0, allow_nan=False, width=64), max_size=20),
    st.integers(2, 4096),
    st.integers(2, 4096),
    st.floats(0.0, 1.0, width=32),
)
@settings(max_examples=200)
def test_any_gain_is_rounded_to_the_nearest_level_below_the_ceiling(
    gains: list[complex], phases: int, amplitudes: int, ceiling: float
) -> None:
    g = np.array(gains, np.complex64)
    check(g[(np.abs(g) > 1e-18) | (g == 0)], phases, amplitudes, ceiling)


@pytest.mark.parametrize("phases", [4, 8, 256, 320])
def test_the_phase_of_each_level_is_that_level(phases: int) -> None:
    level = np.arange(phases)
    phase, amplitude = quantise(np.exp(2j * np.pi * level / phases), phases, 256, 1.0)
    assert np.array_equal(phase, level)
    assert np.array_equal(amplitude, np.full(phases, 255))


@pytest.mark.parametrize("amplitudes", [2, 256, 320, 4096])
def test_the_amplitude_of_each_level_is_that_level(amplitudes: int) -> None:
    level = np.arange(amplitudes)
    assert np.array_equal(quantise(1j * level / (amplitudes - 1), 256, amplitudes, 1.0)[1], level)


def test_phases_just_below_a_turn_wrap_to_0() -> None:
    assert quantise([np.exp(-1e-6j), complex(1.0, -0.0), np.exp(-0.01j)], 256, 256, 1.0)[
        0
    ].tolist() == [0, 0, 0]


@pytest.mark.parametrize("ceiling", [0.0, 0.1, 0.5, 0.99, 1.0])
@pytest.mark.parametrize("amplitudes", [2, 256, 320])
def test_no_amplitude_is_above_the_ceiling(ceiling: float, amplitudes: int) -> None:
    g = np.linspace(0.0, 5.0, 5000) * np.exp(1j * np.arange(5000))
    amplitude = quantise(g, 256, amplitudes, ceiling)[1]
    assert amplitude.max() == int(ceiling * (amplitudes - 1) + 1e-6)


def test_no_gain_is_no_amplitude() -> None:
    assert [levels.tolist() for levels in quantise([0j, -0.0], 256, 256, 1.0)] == [[0, 0], [0, 0]]


@pytest.mark.parametrize("length", [1, 3, 8, 33])
@pytest.mark.parametrize("bad", [complex(np.nan, 0), complex(0, np.nan), complex(1, np.nan)])
def test_nan_becomes_0_wherever_it_stands(bad: complex, length: int) -> None:
    for place in {0, length // 2, length - 1}:
        g = np.full(length, 0.6 + 0.8j)
        g[place] = bad
        phase, amplitude = quantise(g, 256, 256, 1.0)
        assert amplitude[place] == 0
        assert phase[place] < 256
        rest = np.arange(length) != place
        assert (amplitude[rest] == 255).all()
        assert (phase[rest] == 38).all()  # 53.13 degrees: 37.78
