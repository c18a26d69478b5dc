from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.motion import MAX_EXTRAPOLATION, Motion

from .tools import random_pose

vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3)
spins = st.tuples(*[st.floats(-30.0, 30.0)] * 3)
seeds = st.integers(0, 2**31)


@given(velocity=vectors, spin=spins, seed=seeds, age=st.floats(0.0, MAX_EXTRAPOLATION))
def test_it_goes_straight_on_at_a_constant_turn(
    velocity: Any, spin: Any, seed: int, age: float
) -> None:
    seen = random_pose(seed)
    now = Motion(velocity, spin, time=2.0).pose(seen, 2.0 + age)
    assert now.position == pytest.approx(np.array(seen.position) + age * np.array(velocity))
    turn = Rotation.from_rotvec(age * np.array(spin)) * Rotation.from_quat(seen.rotation)
    assert now.matrix == pytest.approx(turn.as_matrix(), abs=1e-9)


@given(velocity=vectors, spin=spins, seed=seeds)
def test_its_velocities_are_the_rates_of_its_pose(velocity: Any, spin: Any, seed: int) -> None:
    motion, seen, h = Motion(velocity, spin), random_pose(seed), 1e-5
    before, after = motion.pose(seen, 0.03 - h), motion.pose(seen, 0.03 + h)
    rate = np.subtract(after.position, before.position) / (2.0 * h)
    assert rate == pytest.approx(velocity, abs=1e-6)
    turn = (after.matrix - before.matrix) / (2.0 * h) @ motion.pose(seen, 0.03).matrix.T
    assert [turn[2, 1], turn[0, 2], turn[1, 0]] == pytest.approx(spin, abs=1e-4)
    assert turn == pytest.approx(-turn.T, abs=1e-4)


@given(velocity=vectors, spin=spins, seed=seeds, first=st.floats(0.0, 0.05))
def test_seen_again_on_its_way_it_goes_the_same_way(
    velocity: Any, spin: Any, seed: int, first: float
) -> None:
    motion, seen = Motion(velocity, spin), random_pose(seed)
    again = Motion(velocity, spin, time=first).pose(motion.pose(seen, first), 0.08)
    straight = motion.pose(seen, 0.08)
    assert again.position == pytest.approx(straight.position, abs=1e-12)
    assert again.matrix == pytest.approx(straight.matrix, abs=1e-12)


@pytest.mark.parametrize("t", [-1e9, 4.999, 5.0])
def test_before_it_was_seen_it_is_where_it_was_seen(t: float) -> None:
    motion, seen = Motion((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), time=5.0), random_pose(1)
    assert motion.pose(seen, t).position == seen.position
    assert motion.pose(seen, t).rotation == pytest.approx(seen.rotation)


@pytest.mark.parametrize("t", [MAX_EXTRAPOLATION, 1e9])
def test_without_an_update_it_stands_still_after_a_while(t: float) -> None:
    motion, seen = Motion((1.0, 0.0, 0.0), (0.0, 0.0, 3.0)), random_pose(2)
    assert motion.pose(seen, t) == motion.pose(seen, MAX_EXTRAPOLATION)
    assert motion.pose(seen, t).position[0] == pytest.approx(seen.position[0] + MAX_EXTRAPOLATION)


def test_a_still_thing_keeps_its_very_pose() -> None:
    seen = random_pose(3)
    now = Motion(time=1.0).pose(seen, 1.05)
    assert now.position == seen.position
    assert now.rotation is seen.rotation or now.rotation == pytest.approx(seen.rotation, abs=1e-15)


@pytest.mark.parametrize(
    ("argument", "given_as"),
    [
        ("velocity", {"velocity": (1.0, 2.0)}),
        ("velocity` .*metres a second", {"velocity": (500.0, 0.0, 0.0)}),
        ("angular_velocity", {"angular_velocity": (0.0, 0.0, math.nan)}),
        ("time", {"time": math.inf}),
    ],
)
def test_a_bad_argument_is_refused_by_name(argument: str, given_as: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}"):
        Motion(**given_as)
