"""The interpolated field on a grid equals the reference, or interpolation is refused."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics import interpolated_field
from pacinian.acoustics.interpolated_field import RegularGrid

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

UNIT = pc.autd()
FOLDED = pc.autd(3, 1).fold("y", math.radians(40.0))
LIVE = pc.Array(
    UNIT.positions, UNIT.normals, pc.IDEAL, np.exp(1j * np.linspace(0.0, 6.0, len(UNIT)))
)
AIRS = pc.Air(), pc.Air(attenuation="absorbing", temperature=40.0)
PLANE = RegularGrid((-0.1, 0.0, 0.1), ((0.002, 0.0, 0.0), (0.0, 0.0, 0.002)), (100, 100))


def focused(array: pc.Array, point: Any) -> Complexes:
    phases = np.angle(pc.matrix(array, [point], pc.Air())[0])
    return np.asarray(np.exp(-1j * phases))


def plane(centre: Any, turn: Any, side: float, count: int) -> RegularGrid:
    """A square slice with any orientation."""
    axes = np.linalg.qr(np.array(turn).reshape(3, 3) + np.eye(3))[0]
    steps = axes[:2] * side / (count - 1)
    first = np.array(centre) - (count - 1) / 2.0 * steps.sum(axis=0)
    return RegularGrid(tuple(first.tolist()), tuple(map(tuple, steps.tolist())), (count, count))


def squares(p: Any) -> Floats:
    return np.asarray(np.abs(p) ** 2, np.float64)


numbers = st.floats(-1.0, 1.0)
places = st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.05, 0.3))


@given(
    st.sampled_from([UNIT, FOLDED, LIVE]),
    st.sampled_from(AIRS),
    st.one_of(
        st.none(), st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(0.01, 0.4))
    ),
    places,
    st.lists(numbers, min_size=9, max_size=9),
    st.floats(0.02, 0.3),
)
def test_what_is_interpolated_is_the_field_within_two_thousandths(
    array: pc.Array, air: pc.Air, focus: Any, centre: Any, turn: list[float], side: float
) -> None:
    turned = np.linspace(0.0, 900.0, len(array)) ** 2
    g = np.exp(1j * turned) if focus is None else focused(array, np.array(focus))
    where = plane(centre, turn, side, 70)
    found = where.interpolate_field(array, g, air)
    if found is not None:
        wanted = squares(pc.field(array, g, where.points, air))
        assert found.shape == wanted.shape
        assert np.abs(squares(found) - wanted).max() < 2e-3 * wanted.max()


@pytest.mark.parametrize("array", [UNIT, FOLDED, LIVE, pc.autd(3, 3)])
def test_a_slice_through_a_focus_takes_less_than_half_of_the_points(
    array: pc.Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    counted: list[int] = []

    def counts(array: Any, gains: Any, points: Floats, medium: Any) -> Complexes:
        counted.append(points.size // 3)
        return pc.field(array, gains, points, medium)

    monkeypatch.setattr(interpolated_field, "field", counts)
    g = focused(array, (0.0, 0.0, 0.3))
    where = RegularGrid((-0.1, 0.0, 0.2), ((0.0016, 0.0, 0.0), (0.0, 0.0, 0.0016)), (126, 126))
    found = where.interpolate_field(array, g, pc.Air())
    assert found is not None
    assert sum(counted) < 126 * 126 / 2
    wanted = squares(pc.field(array, g, where.points, medium=pc.Air()))
    assert np.abs(squares(found) - wanted).max() < 2e-3 * wanted.max()


def test_a_volume_and_a_line_are_grids_too() -> None:
    g = focused(UNIT, (0.0, 0.0, 0.2))
    steps = (0.0004, 0.0, 0.0), (0.0, 0.0004, 0.0), (0.0, 0.0, 0.0004)
    for axes in (1, 3):
        where = RegularGrid((-0.01, -0.01, 0.19), steps[:axes], (60,) * axes)
        assert where.points.shape == (60,) * axes + (3,)
        found = where.interpolate_field(UNIT, g, pc.Air())
        assert found is not None
        wanted = squares(pc.field(UNIT, g, where.points, medium=pc.Air()))
        assert np.abs(squares(found) - wanted).max() < 2e-3 * wanted.max()


def test_detail_that_the_nodes_miss_is_noticed() -> None:
    g = np.ones(len(UNIT))
    beside = UNIT.positions[100] + (0.0, 0.0, 0.001)
    assert plane(beside, [0.0] * 9, 0.2, 128).interpolate_field(UNIT, g, pc.Air()) is None
    on = plane(UNIT.positions[100], [0.0] * 9, 0.2, 128)
    assert on.interpolate_field(UNIT, g, pc.Air()) is None
    piston = pc.Array(UNIT.positions, UNIT.normals, pc.T4010A1)
    edge = PLANE.points[:, :, 2].min() - 0.15  # sound ends behind the array
    behind = RegularGrid((-0.1, 0.3, edge), PLANE.steps, PLANE.shape)
    assert behind.interpolate_field(piston, g, pc.Air()) is None


def test_few_points_and_silence_are_not_worth_it() -> None:
    few = RegularGrid((0.0, 0.0, 0.1), PLANE.steps, (20, 20))
    assert few.interpolate_field(UNIT, np.ones(len(UNIT)), pc.Air()) is None
    assert PLANE.interpolate_field(UNIT, np.zeros(len(UNIT)), pc.Air()) is None
    with pytest.raises(pc.ArgumentError, match="gains"):
        PLANE.interpolate_field(UNIT, np.ones(3), pc.Air())
