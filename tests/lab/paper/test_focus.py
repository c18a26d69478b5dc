"""The focus of the AUTD units: widths, forces, and the plain functions under them."""

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.paper import focus
from pacinian_lab.paper.force import forces, shock_distance


@pytest.fixture(scope="module")
def spot():
    return focus.focus(3, 0.6)


@pytest.fixture(scope="module")
def widths(spot):
    return focus.widths(spot)


def test_all_transducers_are_at_full_drive(spot):
    assert len(spot.gains) == 9 * 249
    np.testing.assert_allclose(np.abs(spot.gains), 1.0, atol=1e-5)


def test_widths_agree_with_direct_integration_over_the_aperture(widths):
    for width in widths:
        assert width.minimum == pytest.approx(width.minimum_integral, rel=0.03)
        assert width.half == pytest.approx(width.half_integral, rel=0.03)


def test_the_first_minimum_lies_between_the_formulas_for_a_rectangle_and_a_circle(widths):
    for width in widths:
        rectangle = width.formula / 1.22
        assert rectangle < width.minimum < width.formula


def test_the_longer_side_focuses_sharper(widths):
    along_x, along_y = widths
    assert along_x.aperture > along_y.aperture
    assert along_x.half < along_y.half


def test_a_distant_slit_has_the_textbook_zero():
    # small angles and weak directivity: the pattern is sinc, its first zero at lambda z / aperture
    s = np.arange(0.0, 0.2, 1e-3)
    p = focus.aperture_integral((0.2, 0.01), 2.0, np.stack([s, 0.0 * s], axis=1))
    assert focus.first_minimum(s, p) == pytest.approx(0.0085 * 2.0 / 0.2, abs=2e-3)


def test_half_width_and_first_minimum_of_a_known_profile():
    s = np.arange(0.0, 3.0, 1e-3)
    P = np.cos(s) ** 2
    assert focus.half_width(s, P) == pytest.approx(np.pi / 2, abs=1e-3)
    assert focus.first_minimum(s, P) == pytest.approx(np.pi / 2, abs=2e-3)


def test_forces_of_the_linear_model_are_those_of_the_reference():
    one, nine = forces()
    assert (f"{one.force:.1f}", f"{nine.force:.1f}") == ("2.1", "17.0")
    assert (one.measured, nine.measured) == (1.6, 7.4)
    assert round(nine.level) == 175


def test_the_linear_model_is_above_the_measured_force_most_of_all_for_nine_units():
    one, nine = forces()
    assert 1.0 < one.force / one.measured < nine.force / nine.measured


def test_power_through_the_focus_is_no_more_than_nine_times_that_of_one_unit():
    one, nine = forces()
    assert nine.force < 9.0 * one.force * 1.05


def test_shock_distance_falls_with_amplitude():
    assert shock_distance(2e4) == pytest.approx(0.5 * shock_distance(1e4))
    assert shock_distance(1e4) == pytest.approx(0.0156, rel=0.01)


def test_radiation_pressure_is_the_conversion_of_the_sound_pressure(spot):
    x = np.array([0.0, 0.004])
    p = spot.sound_pressure(x, 0.0 * x)
    expected = pc.radiation_pressure(p, focus.MEDIUM)
    np.testing.assert_allclose(spot.radiation_pressure(x, 0.0 * x), expected)
