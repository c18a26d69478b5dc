from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Callable

NODES = [0, 0, 0, -1, -3, -6, -9, -12, -14, -15]  # [dB] at 0, 10 .. 90 degrees
K = 2 * math.pi * 40e3 / 340.0  # [rad/m]
PISTON = pc.Piston(0.0045, K)
PATTERNS = pytest.mark.parametrize("pattern", [pc.omni, pc.t4010a1, PISTON])


def cosine(degrees: object) -> np.ndarray:
    return np.cos(np.radians(np.asarray(degrees, float)))


@pytest.mark.parametrize(("tens", "decibels"), list(enumerate(NODES[:9])))
def test_t4010a1_has_its_measured_value_every_ten_degrees(tens: int, decibels: float) -> None:
    D = pc.t4010a1(cosine([10.0 * tens]))[0]
    assert 20 * math.log10(D) == pytest.approx(decibels, abs=1e-6)


def test_t4010a1_is_15_decibels_down_just_before_90_degrees() -> None:
    D = pc.t4010a1(cosine([90.0 - 1e-7]))[0]
    assert 20 * math.log10(D) == pytest.approx(-15.0, abs=1e-3)  # the table has -14.9998


@pytest.mark.parametrize("node", range(10, 90, 10))
def test_t4010a1_is_continuous_where_its_segments_meet(node: int) -> None:
    before, after = pc.t4010a1(cosine([node - 1e-6, node + 1e-6]))
    assert before == pytest.approx(after, abs=1e-7)


@pytest.mark.parametrize("degrees", range(5, 90, 10))
def test_t4010a1_lies_between_its_nodes_in_the_middle_of_a_segment(degrees: int) -> None:
    first = 10 ** (NODES[degrees // 10] / 20)
    last = 10 ** (NODES[degrees // 10 + 1] / 20)
    assert last - 0.005 <= pc.t4010a1(cosine([degrees]))[0] <= first + 0.005


def test_omni_is_1_in_every_direction() -> None:
    assert np.array_equal(pc.omni(np.linspace(-1, 1, 11)), np.ones(11))


@pytest.mark.parametrize("radius", [0.0045, 0.02])
@pytest.mark.parametrize("degrees", [0.01, 1, 10, 30, 45, 60, 75, 89])
def test_piston_is_two_bessel_over_its_argument(radius: float, degrees: float) -> None:
    c = float(cosine(degrees))
    with mpmath.workdps(30):
        x = mpmath.mpf(K) * radius * mpmath.sqrt(1 - mpmath.mpf(c) ** 2)
        expected = float(2 * mpmath.besselj(1, x) / x)
    assert pc.Piston(radius, K)(np.array([c]))[0] == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_piston_is_1_on_its_axis() -> None:
    assert PISTON(np.array([1.0]))[0] == 1.0
    assert PISTON(np.array([1.0 - 1e-15]))[0] == pytest.approx(1.0, abs=1e-14)


def test_a_tiny_piston_is_omnidirectional_in_front() -> None:
    np.testing.assert_allclose(pc.Piston(1e-6, K)(cosine([0, 30, 60, 89])), 1.0, atol=1e-6)


@pytest.mark.parametrize("pattern", [pc.t4010a1, PISTON])
def test_nothing_goes_behind_or_to_the_side(pattern: Callable[..., np.ndarray]) -> None:
    assert not pattern(np.array([0.0, -1e-12, -0.3, -1.0])).any()


@PATTERNS
@given(st.floats(-1.0, 1.0))
def test_the_pattern_never_exceeds_1(pattern: Callable[..., np.ndarray], c: float) -> None:
    assert -1.0 <= pattern(np.array([c]))[0] <= 1.0 + 1e-12


@PATTERNS
@pytest.mark.parametrize("shape", [(), (24,), (4, 6), (6, 4), (2, 3, 4), (1, 24), (24, 1), (0, 3)])
def test_a_pattern_is_evaluated_element_by_element_in_any_shape(
    pattern: Callable[..., np.ndarray], shape: tuple[int, ...]
) -> None:
    c = np.random.default_rng(4).uniform(-1, 1, shape)
    one_by_one = [float(pattern(np.array([x]))[0]) for x in np.ravel(c)]
    D = np.asarray(pattern(c))
    assert D.shape == shape
    np.testing.assert_allclose(D.ravel(), one_by_one)


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan, 4.5e3])
def test_a_radius_that_is_no_length_is_refused(radius: float) -> None:
    with pytest.raises(pc.ArgumentError, match="`radius`"):
        pc.Piston(radius, K)


@pytest.mark.parametrize("wavenumber", [math.nan, -739.0, math.inf])
def test_a_wavenumber_that_is_none_is_refused(wavenumber: float) -> None:
    with pytest.raises(pc.ArgumentError, match="`wavenumber`"):
        pc.Piston(0.0045, wavenumber)
