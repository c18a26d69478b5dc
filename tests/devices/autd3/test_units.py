"""An array's units are where the AUTD3 packages have them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian_plugins.backends.autd3.units import Layout, layout_of_array, layout_of_description

if TYPE_CHECKING:
    from pacinian.types import Floats

BOARD = pc.autd()


def theirs(layout: Layout) -> Floats:
    """Where the packages have the transducers [m]."""
    return 1e-3 * np.concatenate([unit.positions() for unit in layout.geometry()]).astype(float)


def turned(k: int, axis: str, angle: float, position: tuple[float, float, float]) -> pc.Board:
    return pc.Board(serial=str(k), pose=pc.Pose(position).rotate(axis, math.radians(angle)))


@pytest.mark.parametrize(
    "array",
    [
        pc.autd(),
        pc.autd(3, 3),
        pc.autd(2, 1).fold("y", math.radians(30.0)),
        pc.autd().transform(pc.Pose((0.1, -0.2, 0.5)).rotate("x", math.pi)) + pc.autd(),
    ],
)
def test_whole_units_are_found(array: pc.Array) -> None:
    layout = layout_of_array(array)
    np.testing.assert_allclose(theirs(layout), array.positions, atol=1e-6)
    np.testing.assert_array_equal(layout.places, np.arange(len(array)))


@given(
    st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: sum(v * v for v in q) > 0.01),
)
def test_a_unit_is_found_wherever_it_is(
    position: tuple[float, float, float], turn: tuple[float, float, float, float]
) -> None:
    q = np.array(turn) / np.sqrt(sum(v * v for v in turn))
    array = BOARD.transform(pc.Pose(position, tuple(q.tolist())))
    np.testing.assert_allclose(theirs(layout_of_array(array)), array.positions, atol=1e-6)


NO_UNITS: dict[str, tuple[pc.Array, str]] = {
    "another number": (pc.lattice(0.1, 0.1), "121 transducers are no whole units of 249"),
    "another order": (
        pc.Array(BOARD.positions[::-1], BOARD.normals),
        "transducers 0 to 248 are not those of a unit",
    ),
    "another place": (
        pc.Array(
            BOARD.positions + 1e-3 * (np.arange(249) == 100)[:, None] * np.eye(3)[0], BOARD.normals
        ),
        "one is 1 mm from its place",
    ),
    "pointing back": (pc.Array(BOARD.positions, -BOARD.normals), "not those of a unit"),
    "in one place": (
        pc.Array(np.arange(249)[:, None] * [1e-3, 0.0, 0.0]),
        "not those of a unit",
    ),
}


@pytest.mark.parametrize("case", NO_UNITS)
def test_what_is_not_made_of_units_is_refused(case: str) -> None:
    array, problem = NO_UNITS[case]
    with pytest.raises(pc.BackendError, match=problem):
        layout_of_array(array)


def test_a_description_says_where_units_are_and_what_is_dead() -> None:
    boards = (
        pc.Board(serial="a", dead=(0, 17, 248)),
        turned(1, "z", 90.0, (0.3, 0.0, 0.01)),
        turned(2, "y", -20.0, (-0.2, 0.1, 0.0)),
    )
    description = pc.DeviceDescription(boards)
    array = description.array()
    layout = layout_of_description(description, array)
    np.testing.assert_allclose(theirs(layout)[layout.places], array.positions, atol=1e-6)
    assert len(array) == 3 * 249 - 3
    assert set(range(3 * 249)) - set(layout.places.tolist()) == {0, 17, 248}


def test_a_description_must_be_of_units_and_of_this_array() -> None:
    unit = pc.DeviceDescription((pc.Board(),))
    with pytest.raises(pc.BackendError, match="not that of the `description`"):
        layout_of_description(unit, pc.autd(2, 1))
    with pytest.raises(pc.BackendError, match="not that of the `description`"):
        layout_of_description(unit, pc.autd().transform(pc.Pose((0.0, 0.0, 0.01))))
    reversed_ = pc.DeviceDescription((pc.Board(order=tuple(range(248, -1, -1))),))
    with pytest.raises(pc.BackendError, match="must have no `order`"):
        layout_of_description(reversed_, reversed_.array())
    from pacinian.devices.layouts import Grid

    grid = pc.DeviceDescription((pc.Board(layout=Grid()),))
    with pytest.raises(pc.BackendError, match=r"must have the layout"):
        layout_of_description(grid, grid.array())
