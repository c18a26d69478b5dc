from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian import argument_checks
from pacinian.errors import ArgumentError


def refused(check: Any, *arguments: Any, **options: Any) -> str:
    """Return the message of the check's error, which must name the argument."""
    with pytest.raises(ArgumentError, match=r"^`thing` ") as caught:
        check("thing", *arguments, **options)
    assert caught.value.argument == "thing"
    return str(caught.value)


def test_numbers_become_float64_of_their_shape() -> None:
    array = argument_checks.check_numbers("thing", [[1, 2, 3], [4, 5, 6]], (None, 3))
    assert array.dtype == np.float64
    assert array.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_an_empty_list_is_no_points() -> None:
    assert argument_checks.check_numbers("thing", [], (None, 3)).shape == (0, 3)


@pytest.mark.parametrize("value", [[[1, 2]], [1, 2, 3], 1.0, [[[1, 2, 3]]]])
def test_numbers_of_another_shape_are_refused_with_both_shapes(value: Any) -> None:
    message = refused(argument_checks.check_numbers, value, (None, 3))
    assert "(any, 3)" in message
    assert str(np.shape(value)) in message


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused(bad: float) -> None:
    assert "finite" in refused(argument_checks.check_numbers, [1.0, bad], (2,))


@pytest.mark.parametrize("value", ["word", ["a", "b"], [[1, 2], [3]], [None, {}], {}, object()])
def test_what_is_no_numbers_is_refused(value: Any) -> None:
    assert "numbers" in refused(argument_checks.check_numbers, value, (2,))


@pytest.mark.parametrize("value", [[1j, 2.0], np.array([1j, 2.0])])
def test_complex_numbers_are_refused_where_real_ones_are_meant(value: Any) -> None:
    refused(argument_checks.check_numbers, value, (2,))


@given(st.floats(-1e6, 1e6))
def test_a_number_within_its_bounds_is_returned(x: float) -> None:
    assert argument_checks.check_number("thing", x) == x
    assert argument_checks.check_number("thing", x, low=x, high=x) == x


@pytest.mark.parametrize("value", ["word", None, [], [1.0], 1j, {}, np.array([1.0, 2.0])])
def test_what_is_no_number_is_refused(value: Any) -> None:
    assert "must be a number" in refused(argument_checks.check_number, value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused(value: float) -> None:
    assert "finite" in refused(argument_checks.check_number, value)


def test_a_number_out_of_bounds_is_refused_with_the_bounds() -> None:
    assert "0 or more and at most 1" in refused(
        argument_checks.check_number, 1.5, low=0.0, high=1.0
    )
    assert "0 or more" in refused(argument_checks.check_number, -1.0, low=0.0)
    assert "more than 0" in refused(argument_checks.check_number, 0.0, low=0.0, above=True)


def test_points_in_millimetres_are_refused_with_the_advice() -> None:
    points = np.array([[0.0, 0.0, 0.2], [0.0, 0.0, 200.0]])
    message = refused(argument_checks.check_near, points, np.zeros(3))
    assert "200 m" in message
    assert "metres" in message


def test_points_near_a_far_origin_are_accepted() -> None:
    origin = np.array([1e3, 0.0, 0.0])
    argument_checks.check_near("thing", origin + np.array([[1.0, 2.0, 3.0]]), origin)
    argument_checks.check_near("thing", np.empty((0, 3)), origin)


@pytest.mark.filterwarnings("ignore:overflow")
def test_absurdly_far_points_are_refused_too() -> None:
    refused(argument_checks.check_near, np.array([[1e200, 0.0, 0.0]]), np.zeros(3))


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, "long", None])
def test_a_length_of_nothing_is_refused(value: Any) -> None:
    refused(argument_checks.check_length, value)


def test_a_length_in_millimetres_is_refused_with_the_advice() -> None:
    assert "millimetres" in refused(argument_checks.check_length, 200.0)
    assert argument_checks.check_length("thing", 10.0) == 10.0


@pytest.mark.parametrize("value", [3, 3.0, np.int64(3), np.uint8(3)])
def test_a_whole_number_is_returned_as_int(value: Any) -> None:
    result = argument_checks.check_integer("thing", value, low=1)
    assert result == 3
    assert type(result) is int


@pytest.mark.parametrize(
    "value", [0, -3, 1.5, True, np.True_, "3", "word", None, math.nan, math.inf, [], [1], 1j, {}]
)
def test_what_is_no_whole_number_is_refused(value: Any) -> None:
    assert "whole number of at least 1" in refused(argument_checks.check_integer, value, low=1)


@pytest.mark.parametrize("given", [["A", "B"], ("A", "B"), "A,B", " A , B "])
def test_names_are_a_list_or_a_text_with_commas(given: object) -> None:
    assert argument_checks.check_names("thing", given) == ("A", "B")
    assert (
        argument_checks.check_names("thing", "") == argument_checks.check_names("thing", []) == ()
    )


@pytest.mark.parametrize("given", [["A", "A"], "A,,B", [1], 3, None, {"A": 1}])
def test_names_that_are_none_are_refused(given: object) -> None:
    assert "different names" in refused(argument_checks.check_names, given)


HIDES = np.ma.array([1.0, 9e9], mask=[0, 1])


@pytest.mark.parametrize(
    "name",
    [
        "positions",
        "normals",
        "points",
        "points of a list",
        "amplitudes",
        "phases",
        "regions",
        "gains",
    ],
)
def test_masked_values_are_refused_wherever_numbers_are_taken(name: str) -> None:
    array = pc.autd()
    masked: Any = np.ma.array(np.full((2, 3), 0.1), mask=np.eye(2, 3))
    places = [[0.0, 0.0, 0.15], [0.03, 0.0, 0.15]]
    session = pc.Session(array)
    session.solve(places, [1.0, 2.0])
    gains: Any = np.ma.array(np.ones(len(array), complex), mask=np.arange(len(array)) == 3)
    use: dict[str, Any] = {
        "positions": lambda: pc.Array(masked),
        "normals": lambda: pc.Array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]], masked),
        "points": lambda: session.solve(masked, [1.0, 2.0]),
        "points of a list": lambda: session.solve([masked[0], masked[1]], [1.0, 2.0]),
        "amplitudes": lambda: session.solve(places, HIDES),
        "phases": lambda: session.solve(places, [1.0, 2.0], HIDES),
        "regions": lambda: session.solve(places, [1.0, 2.0], regions=HIDES.astype(int)),
        "gains": lambda: session.certify(gains),
    }
    with pytest.raises(pc.ArgumentError, match="masked"):
        use[name]()
    shown = np.ma.array([1.0, 2.0], mask=False)
    assert session.solve(places, shown).error < 0.01
