from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import pacinian as pc

vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3)
angles = st.floats(-720.0, 720.0)


@st.composite
def quaternions(draw: st.DrawFn) -> tuple[float, ...]:
    q = np.array(draw(st.tuples(*[st.floats(-1.0, 1.0)] * 4)))
    size = np.linalg.norm(q)
    assume(size > 1e-3)
    return tuple((q / size).tolist())


@given(quaternions(), vectors, vectors)
def test_a_pose_turns_then_moves_as_scipy_does(q: Any, position: Any, point: Any) -> None:
    pose = pc.Pose(position=position, rotation=q)
    turned = Rotation.from_quat(q).apply([point])
    np.testing.assert_allclose(pose.matrix, Rotation.from_quat(q).as_matrix(), atol=1e-14)
    np.testing.assert_allclose(pose.points(np.array([point])), turned + position, atol=1e-13)
    np.testing.assert_allclose(pose.directions(np.array([point])), turned, atol=1e-13)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@given(angle=angles, position=vectors)
def test_turned_turns_about_an_axis_as_scipy_does(axis: str, angle: float, position: Any) -> None:
    pose = pc.Pose.turned(axis, angle, position)
    expected = Rotation.from_euler(axis, angle, degrees=True).as_matrix()
    np.testing.assert_allclose(pose.matrix, expected, atol=1e-13)
    assert pose.position == position


def test_turned_by_90_about_z_takes_x_to_y() -> None:
    pose = pc.Pose.turned("z", 90.0)
    np.testing.assert_allclose(pose.points(np.array([[1.0, 0, 0]])), [[0, 1, 0]], atol=1e-15)


@given(quaternions())
def test_a_rotation_keeps_lengths_and_handedness(q: Any) -> None:
    R = pc.Pose(rotation=q).matrix
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1.0)


@given(quaternions(), st.floats(0.9905, 1.0095))
def test_a_slightly_long_quaternion_is_normalised(q: Any, factor: float) -> None:
    pose = pc.Pose(rotation=tuple(factor * x for x in q))
    assert np.linalg.norm(pose.rotation) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(pose.rotation, q, atol=1e-14)


@pytest.mark.parametrize(
    "q",
    [
        (0, 0, 0, 0),
        (0, 0, 0, 1.02),
        (0, 0, 0, 0.98),
        (1, 1, 1, 1),
        (1.4e154, 0, 0, 1),
        (1.7e308, 1.7e308, 1.7e308, 1.7e308),
        (0, 0, 0, math.nan),
        (0, 0, 1),
        "turned",
        None,
    ],
)
def test_a_quaternion_that_is_none_is_refused(q: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`rotation`"):
        pc.Pose(rotation=q)


@pytest.mark.parametrize("r", [(0, 0), (0, 0, 0, 0), (math.inf, 0, 0), ((0, 0, 0),), "here", None])
def test_a_position_that_is_none_is_refused(r: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`position`"):
        pc.Pose(position=r)


@pytest.mark.parametrize("axis", ["w", "X", "", None])
def test_an_unknown_axis_is_refused(axis: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`axis`"):
        pc.Pose.turned(axis, 30.0)


@pytest.mark.parametrize("angle", [math.nan, math.inf, "quarter"])
@pytest.mark.filterwarnings("ignore:invalid value")
def test_an_angle_that_is_no_number_is_refused(angle: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`angle`"):
        pc.Pose.turned("x", angle)


def test_a_pose_takes_anything_like_an_array() -> None:
    pose = pc.Pose(position=np.array([1, 2, 3]), rotation=[0, 0, 0, 1])  # type: ignore[arg-type]
    assert (pose.position, pose.rotation) == ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
    assert pose == pc.Pose(position=(1, 2, 3))


def test_a_pose_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        pc.Pose().position = (1.0, 0.0, 0.0)  # type: ignore[misc]
