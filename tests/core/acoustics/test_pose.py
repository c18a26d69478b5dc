from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Callable

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


@given(quaternions(), st.floats(0.9905, 1.0095))
def test_a_slightly_long_quaternion_is_normalised(q: Any, factor: float) -> None:
    pose = pc.Pose(rotation=tuple(factor * x for x in q))
    assert np.linalg.norm(pose.rotation) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(pose.rotation, q, atol=1e-14)


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("rotation", lambda: pc.Pose(rotation=(0, 0, 0, 0))),
        ("rotation", lambda: pc.Pose(rotation=(0, 0, 0, 1.02))),
        ("rotation", lambda: pc.Pose(rotation=(0, 0, 0, 0.98))),
        ("rotation", lambda: pc.Pose(rotation=(1.7e308,) * 4)),
        ("rotation", lambda: pc.Pose(rotation=(0, 0, 0, math.nan))),
        ("rotation", lambda: pc.Pose(rotation=(0, 0, 1))),  # type: ignore[arg-type]
        ("position", lambda: pc.Pose((0, 0))),  # type: ignore[arg-type]
        ("position", lambda: pc.Pose((math.inf, 0, 0))),
        ("axis", lambda: pc.Pose.turned("w", 30.0)),
        ("axis", lambda: pc.Pose.turned(None, 30.0)),  # type: ignore[arg-type]
        ("angle", lambda: pc.Pose.turned("x", math.nan)),
    ],
)
def test_what_is_no_pose_is_refused_by_name(argument: str, make: Callable[[], pc.Pose]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
        make()


def test_a_pose_takes_anything_like_an_array() -> None:
    pose = pc.Pose(position=np.array([1, 2, 3]), rotation=[0, 0, 0, 1])  # type: ignore[arg-type]
    assert (pose.position, pose.rotation) == ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
    assert pose == pc.Pose(position=(1, 2, 3))


def test_a_pose_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        pc.Pose().position = (1.0, 0.0, 0.0)  # type: ignore[misc]
