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
angles = st.floats(-2.0 * math.pi, 2.0 * math.pi)


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


@st.composite
def poses(draw: st.DrawFn) -> pc.Pose:
    return pc.Pose(draw(vectors), draw(quaternions()))  # type: ignore[arg-type]


def agree(a: pc.Pose, b: pc.Pose) -> None:
    """The poses place points alike; q and -q are one rotation."""
    np.testing.assert_allclose(a.position, b.position, atol=1e-12)
    np.testing.assert_allclose(a.matrix, b.matrix, atol=1e-12)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@given(angle=angles, position=vectors)
def test_rotate_turns_about_an_axis_as_scipy_does(axis: str, angle: float, position: Any) -> None:
    pose = pc.Pose(position).rotate(axis, angle)
    expected = Rotation.from_euler(axis, angle).as_matrix()
    np.testing.assert_allclose(pose.matrix, expected, atol=1e-13)
    assert pose.position == position


@given(poses(), vectors, angles)
def test_any_direction_is_an_axis_of_the_world(pose: pc.Pose, axis: Any, angle: float) -> None:
    size = np.linalg.norm(axis)
    assume(size > 1e-3)
    turned = pose.rotate(axis, angle)
    by = Rotation.from_rotvec(angle * np.array(axis) / size)
    np.testing.assert_allclose(turned.matrix, by.as_matrix() @ pose.matrix, atol=1e-12)
    assert turned.position == pose.position


def test_rotations_follow_one_another_about_the_worlds_axes() -> None:
    pose = pc.Pose((0.1, 0.2, 0.3)).rotate("z", 0.7).rotate("x", -0.4).rotate("y", 1.1)
    by = Rotation.from_euler("zxy", [0.7, -0.4, 1.1])  # extrinsic
    np.testing.assert_allclose(pose.matrix, by.as_matrix(), atol=1e-14)
    assert pose.position == (0.1, 0.2, 0.3)


@pytest.mark.parametrize("rotation", [(0, 0, 0, 1), [0, 0, 0, 1], (1, 0, 0, 0)])
def test_a_rotation_of_integers_is_one_of_floats(rotation: Any) -> None:
    pose = pc.Pose((0, 0, 1), rotation)
    assert {type(x) for x in (*pose.position, *pose.rotation)} == {float}
    assert pose.matrix.dtype == np.float64


@given(poses(), vectors)
def test_translate_shifts_and_does_not_turn(pose: pc.Pose, offset: Any) -> None:
    moved = pose.translate(offset)
    assert moved.position == pytest.approx(np.add(pose.position, offset))
    assert moved.rotation == pytest.approx(pose.rotation, abs=1e-15)


@given(poses(), poses(), vectors)
def test_a_product_is_one_pose_after_the_other(a: pc.Pose, b: pc.Pose, point: Any) -> None:
    q = np.array([point])
    np.testing.assert_allclose((a @ b).points(q), a.points(b.points(q)), atol=1e-12)


@given(poses(), poses(), poses())
def test_products_are_associative_and_have_inverses(a: pc.Pose, b: pc.Pose, c: pc.Pose) -> None:
    agree((a @ b) @ c, a @ (b @ c))
    agree(a @ a.inverse(), pc.Pose())
    agree(a.inverse() @ a, pc.Pose())
    agree(a @ pc.Pose(), a)
    agree(pc.Pose(a.position) @ pc.Pose(rotation=a.rotation), a)


def test_about_its_own_axes_a_pose_turns_by_a_product_from_the_right() -> None:
    pose = pc.Pose((1.0, 0.0, 0.0)).rotate("z", math.pi / 2.0)  # its x-axis is the world's y-axis
    own, world = pose @ pc.Pose().rotate("x", 0.3), pose.rotate("y", 0.3)
    agree(own, world)


def test_a_pose_is_not_multiplied_by_anything_else() -> None:
    with pytest.raises(TypeError):
        _ = pc.Pose() @ (0.0, 0.0, 0.1)  # type: ignore[operator]


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
        ("axis", lambda: pc.Pose().rotate("w", math.radians(30.0))),
        ("axis", lambda: pc.Pose().rotate(None, math.radians(30.0))),  # type: ignore[arg-type]
        ("axis", lambda: pc.Pose().rotate((0.0, 0.0, 0.0), 1.0)),
        ("axis", lambda: pc.Pose().rotate((0.0, math.inf, 0.0), 1.0)),
        ("axis", lambda: pc.Pose().rotate((1.0, 0.0), 1.0)),
        ("angle", lambda: pc.Pose().rotate("x", math.nan)),
        ("angle", lambda: pc.Pose().rotate("x", "90")),  # type: ignore[arg-type]
        ("offset", lambda: pc.Pose().translate((1.0, 2.0))),
        ("offset", lambda: pc.Pose().translate((1.0, 2.0, math.nan))),
    ],
)
def test_what_is_no_pose_is_refused_by_name(argument: str, make: Callable[[], pc.Pose]) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
        make()


@pytest.mark.parametrize(
    ("name", "use"),
    [
        ("angle", lambda angle: pc.Pose().rotate("z", angle)),
        ("angle", lambda angle: pc.lattice(0.02, 0.02).fold("x", angle)),
        ("angle", lambda angle: pc.LM(50.0, 0.001, angle)),
        ("phase", lambda angle: pc.Lissajous(0.02, 0.02, phase=angle)),
    ],
)
@pytest.mark.parametrize("angle", [90.0, -45.0, 6.3])
def test_degrees_are_refused_with_the_conversion(name: str, use: Any, angle: float) -> None:
    with pytest.raises(pc.ArgumentError, match=rf"`{name}` is {angle:g}.*math\.radians"):
        use(angle)


def test_a_pose_takes_anything_like_an_array() -> None:
    pose = pc.Pose(position=np.array([1, 2, 3]), rotation=[0, 0, 0, 1])  # type: ignore[arg-type]
    assert (pose.position, pose.rotation) == ((1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
    assert pose == pc.Pose(position=(1, 2, 3))


def test_a_pose_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        pc.Pose().position = (1.0, 0.0, 0.0)  # type: ignore[misc]
