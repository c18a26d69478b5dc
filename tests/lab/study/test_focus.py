"""Widths of a focus and main lobes, against closed forms and direct integration."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, optimize, special

import pacinian as pc
from pacinian_lab.study import focus
from pacinian_lab.study.layouts import Lattice, Sunflower

AIR = pc.Air()
OMNI = pc.Transducer(pressure=4.386)
WAVELENGTH = AIR.wavelength(40e3)
K = AIR.wavenumber(40e3)
SINC = 0.88589294  # of sinc^2: full width at half maximum
AIRY = 2.0 * 1.61633995 / math.pi  # of (2 J1(x) / x)^2, in lambda z / D


def test_the_constants_are_those_of_their_functions() -> None:
    half = optimize.brentq(lambda x: np.sinc(x) ** 2 - 0.5, 0.1, 0.9)
    assert pytest.approx(2.0 * half, rel=1e-6) == SINC
    half = optimize.brentq(lambda x: (2.0 * special.j1(x) / x) ** 2 - 0.5, 0.1, 3.0)
    assert pytest.approx(2.0 * half / math.pi, rel=1e-6) == AIRY


@pytest.mark.parametrize(("width", "height"), [(0.06, 0.1), (0.1, 0.06)])
def test_across_a_rectangle_it_is_that_of_a_sinc(width: float, height: float) -> None:
    pitch, z = 0.004, 1.0
    array = Lattice(width=width - pitch, height=height - pitch, pitch=pitch).make(
        OMNI, np.random.default_rng(0)
    )
    found = focus.widths(array, np.array([0.0, 0.0, z]), AIR)
    assert found.across_x == pytest.approx(SINC * WAVELENGTH * z / width, rel=0.01)
    assert found.across_y == pytest.approx(SINC * WAVELENGTH * z / height, rel=0.01)


def test_across_a_disc_it_is_that_of_an_airy_pattern() -> None:
    array = Sunflower(count=1500, diameter=0.12).make(OMNI, np.random.default_rng(0))
    found = focus.widths(array, np.array([0.0, 0.0, 1.0]), AIR)
    for across in (found.across_x, found.across_y):
        assert across == pytest.approx(AIRY * WAVELENGTH / 0.12, rel=0.015)


def test_along_a_disc_it_is_that_of_the_integral_over_it() -> None:
    f, a = 0.2, 0.1

    def on_axis(z: float) -> float:
        """|p|^2 of a focused disc of radius a on its axis, any scale."""

        def part(s: float, turn: float) -> float:
            R, R0 = math.hypot(s, z), math.hypot(s, f)
            return math.cos(K * (R - R0) + turn) / R * s

        parts = [integrate.quad(part, 0.0, a, args=(turn,))[0] for turn in (0.0, math.pi / 2.0)]
        return parts[0] ** 2 + parts[1] ** 2

    top = optimize.minimize_scalar(lambda z: -on_axis(z), bounds=(0.15, 0.21), method="bounded")
    half = -top.fun / 2.0
    ends = [
        optimize.brentq(lambda z: on_axis(z) - half, *b) for b in ((0.14, top.x), (top.x, 0.28))
    ]
    array = Sunflower(count=3000, diameter=2.0 * a).make(OMNI, np.random.default_rng(0))
    found = focus.widths(array, np.array([0.0, 0.0, f]), AIR)
    assert found.along == pytest.approx(ends[1] - ends[0], rel=0.01)


@given(sigma=st.floats(0.5, 3.0), middle=st.floats(-2.0, 2.0))
def test_the_width_of_a_bell_is_known_from_wherever_on_it_one_starts(
    sigma: float, middle: float
) -> None:
    s = np.linspace(-20.0, 20.0, 4001)
    P = np.exp(-((s - middle) ** 2) / (2.0 * sigma**2))
    found = focus.full_width(s, P, 2000)
    assert found == pytest.approx(2.0 * math.sqrt(2.0 * math.log(2.0)) * sigma, rel=1e-3)


def test_what_never_falls_to_half_is_infinitely_wide() -> None:
    s = np.linspace(-1.0, 1.0, 101)
    assert focus.full_width(s, np.ones_like(s), 50) == math.inf
    assert focus.full_width(s, np.zeros_like(s), 50) == math.inf
    alone = pc.Array([[0.0, 0.0, 0.0]], transducer=OMNI)
    found = focus.widths(alone, np.array([0.0, 0.0, 0.05]), AIR)
    assert found.along == math.inf
    behind = pc.Array([[0.0, 0.0, 0.0]], transducer=pc.T4010A1)
    assert focus.widths(behind, np.array([0.0, 0.0, -0.05]), AIR) == (math.inf,) * 3


def test_facing_arrays_make_a_standing_wave_a_quarter_of_a_wavelength_wide() -> None:
    # far apart they are two plane waves: cos^2(k z), half of whose maximum is lambda / 4 wide
    array = Lattice(width=0.02, pitch=0.004, facing=2.0).make(OMNI, np.random.default_rng(0))
    found = focus.widths(array, np.array([0.0, 0.0, 1.0]), AIR)
    assert found.along == pytest.approx(WAVELENGTH / 4.0, rel=1e-3)


def test_the_ways_are_those_of_the_sound() -> None:
    array = Lattice(width=0.05).make(OMNI, np.random.default_rng(0))
    q = np.array([0.3, 0.0, 0.3])
    ways = focus.ways(array, q, np.abs(pc.matrix(array, q[None], AIR)[0]))
    np.testing.assert_allclose(ways @ ways.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(ways[0], [math.sqrt(0.5), 0.0, math.sqrt(0.5)], atol=0.02)
    np.testing.assert_allclose(np.abs(ways[2]), [0.0, 1.0, 0.0], atol=1e-12)
    q = np.array([0.0, 0.5, 0.0])  # the sound goes along y
    ways = focus.ways(array, q, np.abs(pc.matrix(array, q[None], AIR)[0]))
    np.testing.assert_allclose(ways @ ways.T, np.eye(3), atol=1e-12)


def test_the_main_lobe_of_a_square_ends_at_its_first_null() -> None:
    a, z = 0.1, 1.0
    array = Lattice(width=a - 0.004, pitch=0.004).make(OMNI, np.random.default_rng(0))
    point, axes = np.array([[0.0, 0.0, z]]), np.eye(3)[:2]
    (S,) = focus.lobes(array, point, axes, AIR)
    np.testing.assert_allclose(S, np.eye(2) * (a / (WAVELENGTH * z)) ** 2, rtol=0.01, atol=1.0)
    null = WAVELENGTH * z / a
    B = pc.matrix(array, point, AIR)[0]
    line = np.array([[u, 0.0, z] for u in (0.0, null)])
    peak, there = np.abs(pc.field(array, B.conj(), line, AIR, precision="double"))
    assert there < 0.01 * peak
    pixels = np.array([[0.99 * null, 0.0], [1.01 * null, 0.0], [0.0, -0.99 * null]])
    assert focus.within(pixels, np.zeros((1, 2)), S[None]).tolist() == [True, False, True]


def test_a_lobe_is_long_in_depth_and_agrees_with_the_resolution() -> None:
    array = Lattice(width=0.2).make(OMNI, np.random.default_rng(0))
    point = np.array([[0.0, 0.0, 0.2]])
    (S,) = focus.lobes(array, point, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), AIR)
    across, along = S[0, 0] ** -0.5, S[1, 1] ** -0.5
    assert across == pytest.approx(float(pc.resolution(array, point, AIR)[0]), rel=1e-3)
    assert along > 3.0 * across
