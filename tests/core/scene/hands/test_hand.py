from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.hands.hand import RADII, Hand

NAMES = ["palm", "wrist"]
NAMES += [f"thumb {part}" for part in ("metacarpal", "proximal", "distal", "tip")]
NAMES += [
    f"{finger} {part}"
    for finger in ("index", "middle", "ring", "little")
    for part in ("metacarpal", "proximal", "intermediate", "distal", "tip")
]
poses = st.builds(
    lambda q, r: pc.Pose(position=r, rotation=tuple(Rotation.from_rotvec(q).as_quat().tolist())),
    st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)


def at(hand: Hand, name: str) -> Any:
    return hand.joints[NAMES.index(name)]  # type: ignore[index]


def test_the_open_hand_looks_down_with_its_thumb_at_the_left_of_the_right_hand() -> None:
    hand = Hand.open()
    np.testing.assert_array_equal(at(hand, "palm"), 0.0)
    for finger in ("index", "middle", "ring", "little"):
        forward = at(hand, f"{finger} tip") - at(hand, f"{finger} proximal")
        assert forward[1] > 0.9 * np.linalg.norm(forward)
        straight = np.cross(forward, at(hand, f"{finger} distal") - at(hand, f"{finger} proximal"))
        assert np.linalg.norm(straight) < 1e-12
    assert at(hand, "wrist")[1] < 0.0
    across = [at(hand, f"{finger} tip")[0] for finger in ("thumb", "index", "middle", "ring")]
    assert across == sorted(across)
    assert at(hand, "thumb tip")[2] < 0.0  # the thumb is on the palm's side, which is below
    # A right hand: fingers forward and palm down, the thumb points to the body's left.
    forward, down = at(hand, "middle tip") - at(hand, "wrist"), np.array([0.0, 0.0, -1.0])
    assert np.cross(forward, down) @ (at(hand, "thumb tip") - at(hand, "little tip")) > 0.0


def test_the_open_hand_is_an_adults() -> None:
    hand = Hand.open()
    tip, wrist = at(hand, "middle tip"), at(hand, "wrist")
    assert 0.175 < np.linalg.norm(tip - wrist) + hand.radii[NAMES.index("middle tip")] < 0.2
    knuckles = at(hand, "little proximal") - at(hand, "index proximal")
    assert 0.07 < np.linalg.norm(knuckles) + 0.02 < 0.09
    middle = (at(hand, "middle metacarpal") + at(hand, "middle proximal")) / 2.0
    np.testing.assert_allclose(middle, at(hand, "palm"), atol=1e-12)  # as in OpenXR


def test_the_left_hand_is_the_mirror_image_of_the_right() -> None:
    left, right = Hand.open("left"), Hand.open("right")
    np.testing.assert_array_equal(left.joints, right.joints * [-1.0, 1.0, 1.0])
    assert (left.name, right.name) == ("left", "right")
    assert Hand.open("left", name="Ada's").name == "Ada's"


@given(poses, poses)
def test_a_pose_moves_the_hand_and_turns_its_velocities(first: pc.Pose, second: pc.Pose) -> None:
    rng = np.random.default_rng(1)
    hand = Hand.open(pose=first, velocities=rng.normal(size=(26, 3)), time=2.0)
    moved = hand.transform(second)
    np.testing.assert_allclose(moved.joints, second.points(hand.joints), atol=1e-12)  # type: ignore[arg-type]
    later = hand.extrapolate(0.01).transform(second)
    np.testing.assert_allclose(later.joints, moved.extrapolate(0.01).joints, atol=1e-12)
    assert later.time == pytest.approx(2.01)
    assert moved.radii is hand.radii


def test_translate_shifts_the_whole_hand_or_each_of_its_carriers() -> None:
    hand = Hand.open(velocities=(0.1, 0.0, 0.0))
    moved = hand.translate((0.01, 0.02, 0.03))
    assert moved.joints == pytest.approx(hand.joints + np.array([0.01, 0.02, 0.03]))  # type: ignore[operator]
    assert moved.velocities is hand.velocities
    each = np.arange(78.0).reshape(26, 3) / 1000.0
    assert hand.translate(each).joints == pytest.approx(hand.joints + each)  # type: ignore[operator]


@pytest.mark.parametrize("offset", [0.1, (0.1, 0.2), np.zeros((5, 3)), (0.0, 0.0, np.nan), "up"])
def test_an_offset_that_does_not_fit_is_refused(offset: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`offset`"):
        Hand.open().translate(offset)


def test_only_a_pose_transforms_a_hand() -> None:
    with pytest.raises(pc.ArgumentError, match="`pose`"):
        Hand.open().transform((0.0, 0.0, 0.1))  # type: ignore[arg-type]


def test_a_hand_of_unknown_velocity_stays() -> None:
    hand = Hand.open()
    assert hand.extrapolate(1.0) is hand
    lost = Hand.open(velocities=np.full((26, 3), math.nan))
    assert lost.velocities is None
    assert not lost.lost
    np.testing.assert_allclose(
        Hand.open(velocities=(0.1, 0.0, -0.2)).extrapolate(0.5).joints,
        hand.joints + np.array([0.05, 0.0, -0.1]),
    )


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", [(3, 1), slice(None)])
def test_a_hand_with_unknown_joints_is_lost(bad: float, where: Any) -> None:
    joints = np.array(Hand.open().joints)
    joints[where] = bad
    hand = Hand(joints, np.full(26, math.nan), velocities=np.full((26, 3), bad))
    assert hand.lost
    assert hand.transform(pc.Pose()).lost
    np.testing.assert_array_equal(hand.radii, RADII)
    assert not Hand.open().lost


@pytest.mark.parametrize(
    ("given_", "word"),
    [
        ({"joints": np.zeros((25, 3))}, "`joints`"),
        ({"joints": None}, "`joints`"),
        ({"joints": 1e3 * Hand.open().joints}, "`joints`.*millimetres"),  # type: ignore[operator]
        ({"radii": np.zeros(26)}, "`radii`"),
        ({"radii": 1e3 * RADII}, "`radii`"),
        ({"radii": np.full(26, math.nan)}, "`radii`"),
        ({"radii": 0.01}, "`radii`"),
        ({"side": "both"}, "`side`"),
        ({"velocities": np.zeros((25, 3))}, "`velocities`"),
        ({"velocities": [[0.0], [0.0, 1.0]]}, "`velocities`"),
        ({"time": "now"}, "`time`"),
        ({"vertices": np.zeros((3, 3))}, "`vertices`"),
        ({"vertices": np.zeros((3, 3)), "faces": [[0, 1, 3]]}, "`faces`"),
        ({"vertices": np.zeros((3, 3)), "faces": [[0.0, 1.0, 0.5]]}, "`faces`"),
        ({"vertices": np.zeros((3, 3)), "faces": [0, 1, 2]}, "`faces`"),
        ({"vertices": np.zeros((3, 3)), "faces": [[0, 1], [2]]}, "`faces`"),
        ({"vertices": 190.0 * np.eye(3), "faces": [[0, 1, 2]]}, "`vertices`"),
    ],
)
def test_what_cannot_be_meant_is_refused(given_: dict[str, Any], word: str) -> None:
    with pytest.raises(pc.ArgumentError, match=word):
        Hand(**{"joints": Hand.open().joints, **given_})


def test_a_mesh_is_a_hand_too() -> None:
    vertices, faces = 0.1 * np.eye(3), [[0, 1, 2]]
    hand = Hand(vertices=vertices, faces=faces, velocities=(0.0, 0.0, 1.0))
    assert hand.joints is None
    np.testing.assert_allclose(hand.extrapolate(0.1).vertices, vertices + np.array([0, 0, 0.1]))
    assert hand.extrapolate(0.1).faces is hand.faces
    assert Hand(vertices=[[0, 0, math.nan], [1, 0, 0], [0, 1, 0]], faces=faces).lost


def test_a_hand_cannot_be_changed() -> None:
    joints = np.array(Hand.open().joints)
    hand = Hand(joints)
    joints[0] = 7.0
    assert hand.joints[0, 0] == 0.0  # type: ignore[index]
    for array in (hand.joints, hand.radii, hand.transform(pc.Pose()).joints):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0  # type: ignore[index]
    other = replace(hand, joints=np.full((26, 3), math.nan), name="Ada's")
    assert (other.lost, other.name, hand.name) == (True, "Ada's", "right")
    with pytest.raises(AttributeError):
        hand.side = "left"  # type: ignore[misc]


def leap() -> dict[str, Any]:
    """Return a hand in LeapC's layout: digits along y at x = 0, 20 .. 80 mm, bones of 50, 40, 30, 20 mm."""
    bones, widths = np.zeros((5, 4, 2, 3)), np.zeros((5, 4))
    for digit in range(5):
        y = 0.0
        for bone, length in enumerate((0.0 if digit == 0 else 50.0, 40.0, 30.0, 20.0)):
            bones[digit, bone] = [[20.0 * digit, y, 0.0], [20.0 * digit, y + length, 0.0]]
            widths[digit, bone] = 0.0 if length == 0.0 else 20.0 - 2.0 * bone - digit
            y += length
    return {
        "bones": 1e-3 * bones,
        "widths": 1e-3 * widths,
        "wrist": (0.04, -0.03, 0.0),
        "side": "right",
    }


def test_a_hand_from_leap() -> None:
    hand = Hand.leap(**leap(), time=3.0)
    expected = {
        "palm": (40, 25),
        "wrist": (40, -30),
        "thumb metacarpal": (0, 0),
        "thumb proximal": (0, 40),
        "thumb distal": (0, 70),
        "thumb tip": (0, 90),
        "index metacarpal": (20, 0),
        "index proximal": (20, 50),
        "index intermediate": (20, 90),
        "index distal": (20, 120),
        "index tip": (20, 140),
        "little metacarpal": (80, 0),
        "little tip": (80, 140),
    }
    for name, place in expected.items():
        np.testing.assert_allclose(at(hand, name), [*(1e-3 * np.array(place)), 0.0], atol=1e-12)
    radii = 1e3 * hand.radii
    # Widths of the thumb's bones 18, 16, 14 mm; of the index's 19, 17, 15, 13 mm.
    np.testing.assert_allclose(radii[2:6], [9.0, 8.5, 7.5, 7.0])
    np.testing.assert_allclose(radii[6:11], [9.5, 9.0, 8.0, 7.0, 6.5])
    assert hand.time == 3.0


def test_a_lost_hand_from_leap() -> None:
    assert Hand.leap(**{**leap(), "wrist": (math.nan, 0.0, 0.0)}).lost
    assert Hand.leap(**{**leap(), "bones": np.full((5, 4, 2, 3), math.nan), "widths": [0]}).lost


@pytest.mark.parametrize(
    ("given_", "word"),
    [
        ({"bones": np.zeros((5, 3, 2, 3))}, "bones"),
        ({"widths": np.zeros((5, 3))}, "widths"),
        ({"widths": np.zeros((5, 4))}, "radii"),
        ({"wrist": (0.0, 0.0)}, "wrist"),
        ({"bones": 1e3 * leap()["bones"]}, "millimetres"),
    ],
)
def test_what_leap_cannot_mean_is_refused(given_: dict[str, Any], word: str) -> None:
    with pytest.raises(pc.ArgumentError, match=word):
        Hand.leap(**{**leap(), **given_})


@settings(max_examples=30)
@given(st.sampled_from(["left", "right"]), poses)
def test_a_hand_opens_where_it_is_put(side: Any, pose: pc.Pose) -> None:
    hand = Hand.open(side, pose)
    np.testing.assert_allclose(at(hand, "palm"), pose.position, atol=1e-15)
    np.testing.assert_allclose(hand.joints, Hand.open(side).transform(pose).joints, atol=1e-15)
    with pytest.raises(pc.ArgumentError, match="`pose` must be a Pose"):
        Hand.open(side, pose.position)  # type: ignore[arg-type]
