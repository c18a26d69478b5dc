from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.motion import MAX_EXTRAPOLATION, Motion
from pacinian.scene.sampling.pose_prediction import (
    BLEND_TIME,
    MAX_BLENDED_ERROR,
    MAX_OBJECTS,
    PosePredictor,
)

bounded = settings(max_examples=60)
TICK = 0.001
CORNERS = 0.05 * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])


def ball(position: Any = (0.0, 0.0, 0.0), motion: Motion | None = None, **how: Any) -> pc.Volume:
    how = {"name": "ball", "radiation_pressure": 1.0, "motion": motion or Motion()} | how
    rotation = how.pop("rotation", (0.0, 0.0, 0.0, 1.0))
    return pc.Volume(shape=pc.Sphere(0.05), pose=pc.Pose(tuple(position), rotation), **how)


updates = st.lists(
    st.tuples(
        st.integers(0, 40),  # ticks since the last update
        st.tuples(*[st.floats(-0.02, 0.02)] * 3),  # offset from the pose shown
        st.tuples(*[st.floats(-1.0, 1.0)] * 3),
        st.tuples(*[st.floats(-5.0, 5.0)] * 3),
        st.floats(-0.2, 0.02),  # timestamp relative to now [s]
        st.floats(-0.5, 0.5),  # rotation [rad]
    ),
    min_size=1,
    max_size=6,
)


@given(updates=updates)
@bounded
def test_no_update_makes_an_object_jump(updates: Any) -> None:
    tracks, t, item = PosePredictor(), 0.0, ball()
    shown = tracks.pose(item, t)
    for ticks, d, velocity, spin, age, angle in updates:
        for _ in range(ticks + 1):
            t += TICK
            now = tracks.pose(item, t)
            # speed limit of the corners [m/s]
            speed = 1.8 + MAX_BLENDED_ERROR / BLEND_TIME + 0.05 * (9.0 + 3.2 / BLEND_TIME)
            moved = np.linalg.norm(now.points(CORNERS) - shown.points(CORNERS), axis=1).max()
            assert moved <= speed * TICK
            shown = now
        rotation = Rotation.from_rotvec([0, 0, angle]) * Rotation.from_quat(shown.rotation)
        at, turn = np.add(shown.position, d), tuple(rotation.as_quat().tolist())
        item = ball(at.tolist(), Motion(velocity, spin, time=t + age), rotation=turn)
        now = tracks.pose(item, t)
        if math.dist(item.motion.pose(item.pose, t).position, shown.position) < MAX_BLENDED_ERROR:
            assert now.points(CORNERS) == pytest.approx(shown.points(CORNERS), abs=1e-9)
        shown = now  # differs after a teleport


@given(updates=updates)
@bounded
def test_it_is_soon_where_its_motion_says(updates: Any) -> None:
    tracks, t = PosePredictor(), 0.0
    for ticks, d, velocity, spin, age, _ in updates:
        item = ball(d, Motion(velocity, spin, time=t + age))
        for i in range(ticks + 1):
            tracks.pose(item, t + i * TICK)
        t += ticks * TICK
    later = t + BLEND_TIME
    assert later >= tracks.blends_until - 1e-12
    assert tracks.pose(item, later).position == pytest.approx(
        item.motion.pose(item.pose, later).position, abs=1e-9
    )
    assert tracks.pose(item, later).matrix == pytest.approx(
        item.motion.pose(item.pose, later).matrix, abs=1e-9
    )


@given(
    first=st.integers(0, 2**31),
    by=st.tuples(*[st.floats(-1.7, 1.7)] * 3),
    signs=st.tuples(*[st.sampled_from([-1.0, 1.0])] * 2),
)
@bounded
def test_it_is_turned_the_shorter_way_however_its_rotation_is_written(
    first: int, by: Any, signs: tuple[float, float]
) -> None:
    """A quaternion and its negative are the same rotation, and trackers send either."""
    was = Rotation.random(rng=np.random.default_rng(first))
    now = Rotation.from_rotvec(by) * was  # at most 170 degrees
    one, other = (
        tuple((sign * r.as_quat()).tolist()) for sign, r in zip(signs, (was, now), strict=True)
    )
    tracks = PosePredictor()
    tracks.pose(ball(rotation=one), 0.0)
    item, left = ball(rotation=other), []
    for t in np.linspace(0.0, BLEND_TIME, 11):
        shown = Rotation.from_quat(tracks.pose(item, float(t)).rotation)
        left.append((now * shown.inv()).magnitude())
        # on the shortest way between the two rotations
        assert (shown * was.inv()).magnitude() + left[-1] == pytest.approx(left[0], abs=1e-6)
    assert left[0] == pytest.approx(np.linalg.norm(by), abs=1e-6)
    assert left[-1] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(left) <= 1e-6).all()


def test_a_teleport_is_followed_at_once() -> None:
    tracks = PosePredictor()
    tracks.pose(ball(), 0.0)
    far = ball((1.1 * MAX_BLENDED_ERROR, 0.0, 0.0))
    assert tracks.pose(far, TICK).position == far.pose.position


def test_a_late_update_is_where_it_must_be_by_now() -> None:
    item = ball(motion=Motion((1.0, 0.0, 0.0), time=-0.05))
    assert PosePredictor().pose(item, 0.0).position[0] == pytest.approx(0.05)
    old = ball(motion=Motion((1.0, 0.0, 0.0), time=-100.0))
    assert PosePredictor().pose(old, 0.0).position[0] == pytest.approx(MAX_EXTRAPOLATION)


def test_without_a_motion_or_a_name_nothing_is_blended() -> None:
    tracks = PosePredictor()
    for item in (replace(ball(), motion=None), ball(name="")):
        tracks.pose(item, 0.0)
        assert tracks.pose(replace(item, pose=pc.Pose((0.01, 0, 0))), TICK).position[0] == 0.01


@given(times=st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=12), d=st.floats(-0.03, 0.03))
@bounded
def test_whatever_time_does_it_is_between_where_it_was_and_is(times: Any, d: float) -> None:
    tracks = PosePredictor()
    tracks.pose(ball(), 0.0)
    item = ball((d, 0.0, 0.0))
    for t in (0.0, *times):
        x = tracks.pose(item, t).position[0]
        assert min(0.0, d) - 1e-12 <= x <= max(0.0, d) + 1e-12


def test_while_time_stands_still_so_does_it() -> None:
    tracks, item = PosePredictor(), ball(motion=Motion((1.0, 0.0, 0.0)))
    assert len({tracks.pose(item, 0.02) for _ in range(5)}) == 1


def test_no_more_than_so_many_are_tracked() -> None:
    tracks = PosePredictor()
    for i in range(MAX_OBJECTS + 100):
        tracks.pose(ball(name=f"{i}"), 0.0)
    assert len(tracks._tracks) == MAX_OBJECTS
