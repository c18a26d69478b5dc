from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.material import FULL_PRESSURE_DEPTH, Material

stiffnesses = st.one_of(st.none(), st.floats(1.0, 1e6))
mosts = st.floats(1e-3, 1e4)
DEPTHS = np.linspace(-0.01, 0.05, 601)


@given(stiffness=stiffnesses, most=mosts)
def test_pressure_grows_with_depth_from_nothing_to_the_most(
    stiffness: float | None, most: float
) -> None:
    P = Material(stiffness).pressure(DEPTHS, most)
    assert (P[DEPTHS <= 0.0] == 0.0).all()
    assert (np.diff(P) >= 0.0).all()
    assert P.max() <= most


@given(stiffness=stiffnesses, most=mosts)
def test_it_is_a_spring_until_it_saturates(stiffness: float | None, most: float) -> None:
    material = Material(stiffness)
    slope = most / FULL_PRESSURE_DEPTH if stiffness is None else stiffness
    where = most / slope
    depth = np.array([0.25, 0.5, 1.0, 2.0]) * where
    assert material.pressure(depth, most) == pytest.approx([most / 4, most / 2, most, most])


@given(stiffness=stiffnesses, most=mosts)
def test_pressure_never_jumps(stiffness: float | None, most: float) -> None:
    slope = most / FULL_PRESSURE_DEPTH if stiffness is None else stiffness
    steps = np.abs(np.diff(Material(stiffness).pressure(DEPTHS, most)))
    assert steps.max() <= slope * (DEPTHS[1] - DEPTHS[0]) * (1.0 + 1e-9)


@given(stiffness=stiffnesses, most=mosts, reach=st.floats(0.0, 0.01))
def test_it_tells_how_deep_its_most_begins(
    stiffness: float | None, most: float, reach: float
) -> None:
    material = Material(stiffness, reach=reach)
    enough = material.compute_full_depth(most)
    assert material.pressure(np.array([reach + enough]), most)[0] == pytest.approx(most)


def test_nothing_to_press_with_presses_nothing() -> None:
    for material in (Material(), Material(stiffness=100.0)):
        assert (material.pressure(DEPTHS, 0.0) == 0.0).all()


@pytest.mark.parametrize(
    ("name", "bad"), [("stiffness", 0.0), ("stiffness", "hard"), ("reach", -0.1), ("reach", 11.0)]
)
def test_a_bad_argument_is_refused_by_name(name: str, bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{name}` "):
        Material(**{name: bad})
