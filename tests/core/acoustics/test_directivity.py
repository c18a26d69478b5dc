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
TABLE = pc.DirectivityTable.sample(PISTON, 19)
PATTERNS = pytest.mark.parametrize("pattern", [pc.omni, pc.t4010a1, PISTON, TABLE])


def cosine(degrees: object) -> np.ndarray:
    return np.cos(np.radians(np.asarray(degrees, float)))


@pytest.mark.parametrize("off", [0.0, -1e-6, 1e-6])
def test_t4010a1_has_its_measured_value_on_both_sides_of_every_ten_degrees(off: float) -> None:
    D = pc.t4010a1(cosine(np.arange(10, 90, 10) + off))
    np.testing.assert_allclose(20 * np.log10(D), NODES[1:9], atol=3e-6)
    ends = 20 * np.log10(pc.t4010a1(cosine([0.0, 90.0 - 1e-7])))
    assert ends == pytest.approx([0.0, -15.0], abs=1e-3)  # the table has -14.9998


def test_omni_is_1_in_every_direction() -> None:
    assert np.array_equal(pc.omni(np.linspace(-1, 1, 11)), np.ones(11))


@pytest.mark.parametrize("radius", [0.0045, 0.02])
def test_piston_is_two_bessel_over_its_argument(radius: float) -> None:
    for c in cosine([0.01, 1, 30, 60, 89]).tolist():
        with mpmath.workdps(30):
            x = mpmath.mpf(K) * radius * mpmath.sqrt(1 - mpmath.mpf(c) ** 2)
            expected = float(2 * mpmath.besselj(1, x) / x)
        assert pc.Piston(radius, K)(np.array([c]))[0] == pytest.approx(expected, rel=1e-9)


def test_a_piston_is_1_on_its_axis_and_a_tiny_one_everywhere_in_front() -> None:
    assert PISTON(np.array([1.0]))[0] == 1.0
    assert PISTON(np.array([1.0 - 1e-15]))[0] == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(pc.Piston(1e-6, K)(cosine([0, 30, 60, 89])), 1.0, atol=1e-6)


@pytest.mark.parametrize("pattern", [pc.t4010a1, PISTON, TABLE])
def test_nothing_goes_behind_or_to_the_side(pattern: Callable[..., np.ndarray]) -> None:
    assert not pattern(np.array([0.0, -1e-12, -0.3, -1.0])).any()


@PATTERNS
@given(st.floats(-1.0, 1.0))
def test_the_pattern_never_exceeds_1(pattern: Callable[..., np.ndarray], c: float) -> None:
    assert -1.0 <= pattern(np.array([c]))[0] <= 1.0 + 1e-12


@PATTERNS
def test_a_pattern_is_evaluated_element_by_element_in_any_shape(
    pattern: Callable[..., np.ndarray],
) -> None:
    for shape in ((), (24,), (2, 3, 4), (24, 1), (0, 3)):
        c = np.random.default_rng(4).uniform(-1, 1, shape)
        one_by_one = [float(pattern(np.array([x]))[0]) for x in np.ravel(c)]
        D = np.asarray(pattern(c))
        assert D.shape == shape
        np.testing.assert_allclose(D.ravel(), one_by_one)


@pytest.mark.parametrize(
    ("argument", "given_as"),
    [
        ("radius", (0.0, K)),
        ("radius", (4.5e3, K)),
        ("wavenumber", (0.0045, -739.0)),
        ("wavenumber", (0.0045, math.nan)),
    ],
)
def test_a_piston_that_cannot_be_is_refused(argument: str, given_as: tuple[float, float]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
        pc.Piston(*given_as)


def test_a_table_of_a_piston_every_five_degrees_is_the_piston() -> None:
    """The table is exact at its rows and within 0.001 between them. It is flat on the axis, by symmetry."""
    np.testing.assert_allclose(TABLE(np.cos(TABLE.angles[:-1])), TABLE.values[:-1], atol=1e-12)
    between = cosine(np.linspace(0.0, 89.99, 4001))
    np.testing.assert_allclose(TABLE(between), PISTON(between), atol=1e-3)
    assert abs(TABLE(cosine([0.01]))[0] - 1.0) < 1e-6
    fine = pc.DirectivityTable.sample(PISTON)
    np.testing.assert_allclose(fine(between), PISTON(between), atol=2e-5)


def test_a_table_propagates_as_the_function_that_it_samples() -> None:
    q, g = np.random.default_rng(3).uniform(0.05, 0.2, (30, 3)), np.ones(249)
    one, other = (
        pc.field(pc.autd(transducer=pc.Transducer(directivity=D)), g, q, pc.Air())
        for D in (PISTON, pc.DirectivityTable.sample(PISTON))
    )
    np.testing.assert_allclose(one, other, atol=1e-4 * np.abs(one).max())


@pytest.mark.parametrize(
    ("angles", "values", "told"),
    [
        ((0.0,), (1.0,), "`angles` must be 2"),
        ((0.0, 1.0, 1.5708), (1.0, 0.5), "`values` must be 3"),
        ((0.0, 1.0, 1.0, 1.5708), (1.0, 0.5, 0.4, 0.2), "must ascend: 1 comes before 1"),
        ((0.0, 45.0, 90.0), (1.0, 0.5, 0.2), "were degrees given"),
        ((0.0, 1.0), (1.0, 0.5), "0 to pi/2"),
        ((0.1, 1.5708), (1.0, 0.5), "0 to pi/2"),
        ((0.0, 0.8, 1.5708), (0.0, -6.0, -15.0), "decibels"),
        ((0.0, 0.8, 1.5708), (1.0, math.nan, 0.2), "`values` must be finite"),
        ((0.0, 0.8, 1.5708), (1.0, 50.0, 0.2), "-10 to 10"),
    ],
)
def test_a_table_that_cannot_be_is_refused(angles: object, values: object, told: str) -> None:
    with pytest.raises(pc.ArgumentError, match=told):
        pc.DirectivityTable(angles, values)  # type: ignore[arg-type]
