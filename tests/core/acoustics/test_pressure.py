from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

import pacinian as pc

amounts = arrays(np.float64, array_shapes(max_dims=3, max_side=4), elements=st.floats(0.0, 1e6))


def test_radiation_pressure_of_a_kilopascal_is_that_worked_out_by_hand() -> None:
    # p_rms^2 = 1e6 / 2; rho c^2 = 1.2 x 340^2 = 138 720 Pa; P = 2 x 5e5 / 138 720 = 7.2087 Pa
    air = pc.Air(speed_of_sound=340.0, density=1.2)
    assert pc.radiation_pressure(1000.0, air) == pytest.approx(7.2087658592848, rel=1e-12)


def test_radiation_pressure_uses_the_medium_and_alpha() -> None:
    air = pc.Air(speed_of_sound=343.0, density=1.18)
    assert pc.radiation_pressure(100.0, air, alpha=1.3) == pytest.approx(
        1.3 * 5000.0 / (1.18 * 343.0**2)
    )


@given(amounts, st.floats(0.1, 4.0), st.floats(300.0, 400.0), st.floats(0.5, 2.0))
def test_sound_pressure_is_the_inverse_of_radiation_pressure(
    P: np.ndarray, alpha: float, c: float, rho: float
) -> None:
    air = pc.Air(speed_of_sound=c, density=rho)
    p = pc.sound_pressure(P, air, alpha)
    assert p.shape == P.shape
    np.testing.assert_allclose(pc.radiation_pressure(p, air, alpha), P, rtol=1e-12, atol=1e-300)


@given(amounts, st.floats(0.0, 2 * math.pi))
def test_the_phase_of_sound_does_not_matter_to_radiation_pressure(
    p: np.ndarray, phase: float
) -> None:
    np.testing.assert_allclose(
        pc.radiation_pressure(p * np.exp(1j * phase), pc.Air()),
        pc.radiation_pressure(p, pc.Air()),
        rtol=1e-12,
    )


def test_single_precision_gives_float64() -> None:
    P = pc.radiation_pressure(
        np.array([3 + 4j], np.complex64), pc.Air(speed_of_sound=340.0, density=1.2)
    )
    assert P.dtype == np.float64
    assert P[0] == pytest.approx(25.0 / 138_720.0)


@pytest.mark.parametrize("convert", [pc.radiation_pressure, pc.sound_pressure])
def test_a_medium_or_an_alpha_that_is_none_is_refused(convert: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`medium` must be an Air, not 22"):
        convert([20.0], 22)
    for alpha in (0.0, math.inf):
        with pytest.raises(pc.ArgumentError, match="`alpha`"):
            convert(1.0, pc.Air(), alpha)


@pytest.mark.parametrize("value", [-1e-9, [1.0, -1.0], math.nan])
def test_a_negative_radiation_pressure_is_refused(value: object) -> None:
    with pytest.raises(pc.ArgumentError, match="`radiation_pressure`"):
        pc.sound_pressure(value, pc.Air())  # type: ignore[arg-type]


def test_one_pascal_rms_is_94_decibels() -> None:
    assert pc.sound_pressure_level(math.sqrt(2)) == pytest.approx(93.9794, abs=1e-4)
    assert pc.sound_pressure_level(20e-6j * math.sqrt(2)) == pytest.approx(0.0, abs=1e-9)


def test_silence_is_minus_infinity_decibels() -> None:
    assert np.array_equal(pc.sound_pressure_level([0.0, 0j]), [-np.inf, -np.inf])
