from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.hands.bones import BONES
from pacinian.scene.hands.capsules import distance_to_skin, find_bounds, find_closest, make_capsules
from pacinian.scene.hands.hand import Hand
from pacinian.scene.hands.mesh_skin import MeshSkin
from pacinian.scene.hands.skin_cache import get_skin
from pacinian.scene.hands.skin_lod import SPACINGS

from ..tools import to_capsules

if TYPE_CHECKING:
    from pacinian.scene.hands.skin import Skin
    from pacinian.types import Floats

REST = Hand.open()
SKIN = get_skin(REST)
ALL = np.arange(len(SKIN))
SHOWN = np.flatnonzero(
    ~SKIN.hidden
)  # the others, on the backs of joints, are exposed only by bending
LEVELS = range(len(SPACINGS))


def bent(joints: Floats, turns: list[Any]) -> Floats:
    """Return the joints after turning, at each finger joint, the joints beyond it."""
    joints, turns = np.array(joints), list(turns)
    for first in (3, 7, 12, 17, 22):
        for joint in range(first, first + (2 if first == 3 else 3)):
            rest = slice(joint + 1, first + (3 if first == 3 else 4))
            turn = Rotation.from_rotvec(turns.pop())
            joints[rest] = joints[joint] + turn.apply(joints[rest] - joints[joint])
    return joints


@st.composite
def hands(draw: st.DrawFn) -> Hand:
    """Draw hands of any size, bent in any way."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    wild = draw(st.floats(0.0, 2.0))
    joints = bent(REST.joints, list(rng.normal(0.0, wild, (14, 3))))  # type: ignore[arg-type]
    joints = draw(st.floats(0.7, 1.2)) * joints + rng.normal(0.0, 1e-3 * wild, (26, 3))
    hand = Hand(
        joints,
        REST.radii * rng.uniform(0.7, 1.3, 26),
        side=draw(st.sampled_from(["left", "right"])),
    )
    turn = tuple(Rotation.random(random_state=rng.integers(2**31)).as_quat().tolist())
    return hand.transform(pc.Pose(position=tuple(rng.normal(size=3)), rotation=turn))


def test_at_rest_every_point_is_on_the_skin_faces_out_of_it_and_is_seen() -> None:
    placed = SKIN.place(REST)
    away = to_capsules(placed.capsules, placed.points)
    np.testing.assert_allclose(away.min(axis=1)[SHOWN], 0.0, atol=1e-12)
    np.testing.assert_allclose(away[ALL, SKIN.bone], 0.0, atol=1e-12)
    np.testing.assert_array_equal(SKIN.find_exposed(placed, ALL), ~SKIN.hidden)
    np.testing.assert_allclose(placed.points, SKIN.surface.points, atol=1e-12)
    assert 6000 < len(SKIN) < 12_000
    out = distance_to_skin(placed.capsules, placed.points + 1e-4 * placed.normals)
    # the others are in creases, inside another part of the hand
    assert (out[SHOWN] > 0.5e-4).mean() > 0.998


@pytest.mark.parametrize(
    ("longer", "thicker", "off"), [(1.0, 1.0, 0.015), (1.15, 1.0, 0.04), (1.0, 0.9, 0.04)]
)
def test_the_area_is_that_of_the_skin(longer: float, thicker: float, off: float) -> None:
    """The volume within 0.5 mm of the skin is its area times 1 mm, apart from terms of second order."""
    placed = SKIN.place(Hand(longer * REST.joints, thicker * REST.radii))  # type: ignore[operator]
    low, high = placed.points.min(axis=0) - 1e-3, placed.points.max(axis=0) + 1e-3
    points = np.random.default_rng(2).uniform(low, high, (1_500_000, 3))
    near = np.abs(distance_to_skin(placed.capsules, points)) < 5e-4
    area = near.mean() * np.prod(high - low) / 1e-3
    shown = SKIN.find_exposed(placed, ALL)
    assert placed.area[shown].sum() == pytest.approx(
        area, rel=off
    )  # on other hands, folds are elsewhere
    if longer == thicker:  # a hand has 2 to 2.5 % of a body's skin, some 1.8 m^2
        assert 0.035 < area < 0.055  # [m^2]


def test_a_bent_joint_has_skin_on_its_back() -> None:
    """With joints bent by 70 degrees, each point of the visible skin has a skin point nearby."""
    turns = [np.zeros(3)] * 14
    turns[1:4] = [np.array([-1.2, 0.0, 0.0])] * 3  # the ring finger
    hand = Hand(bent(REST.joints, turns))  # type: ignore[arg-type]
    placed = SKIN.place(hand)
    exposed = placed.points[SKIN.find_exposed(placed, ALL)]
    out = np.random.default_rng(4).normal(size=(4000, 3))
    out *= 0.03 / np.linalg.norm(out, axis=1, keepdims=True)
    for joint in (17, 18, 19):
        met = find_closest(placed.capsules, hand.carriers[joint] + out).points
        assert KDTree(exposed).query(met)[0].max() < 1.5 * SPACINGS[0]


def test_the_skin_has_no_holes() -> None:
    """Each point of the visible skin has a skin point within the finest spacing."""
    rng = np.random.default_rng(3)
    from_ = rng.uniform([-0.12, -0.1, -0.05], [0.08, 0.15, 0.05], (20_000, 3))
    flesh = make_capsules(REST)
    outside = from_[distance_to_skin(flesh, from_) > 0.0]
    met = find_closest(flesh, outside).points
    assert KDTree(SKIN.surface.points).query(met)[0].max() < 1.5 * SPACINGS[0]


@settings(max_examples=40)
@given(hands())
def test_in_any_pose_a_point_stays_on_its_own_capsule(hand: Hand) -> None:
    placed = SKIN.place(hand)
    away = to_capsules(placed.capsules, placed.points)
    np.testing.assert_allclose(away[ALL, SKIN.bone], 0.0, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(placed.normals, axis=1), 1.0, atol=1e-9)
    np.testing.assert_array_equal(placed.capsules, make_capsules(hand))
    away[ALL, SKIN.bone] = np.inf
    slack = np.where(SKIN.hidden, 0.0, 5e-4)
    clear = np.abs(away.min(axis=1) + slack) > 1e-9
    shown = away.min(axis=1) > -slack
    np.testing.assert_array_equal(SKIN.find_exposed(placed, ALL)[clear], shown[clear])
    some = ALL[::7]
    np.testing.assert_array_equal(
        SKIN.find_exposed(placed, some), SKIN.find_exposed(placed, ALL)[some]
    )


@settings(max_examples=40)
@given(hands(), st.integers(0, 2**31))
def test_the_skin_moves_with_the_hand(hand: Hand, seed: int) -> None:
    turn = Rotation.random(random_state=seed)
    pose = pc.Pose(position=(0.3, -0.2, 0.1), rotation=tuple(turn.as_quat().tolist()))
    before, after = SKIN.place(hand), SKIN.place(hand.transform(pose))
    np.testing.assert_allclose(after.points, pose.points(before.points), atol=1e-9)
    np.testing.assert_allclose(after.normals, pose.directions(before.normals), atol=1e-7)
    np.testing.assert_allclose(after.area, before.area, rtol=1e-9)


@settings(max_examples=20)
@given(hands())
def test_the_mirrored_hand_has_the_mirrored_skin(hand: Hand) -> None:
    mirror = np.array([-1.0, 1.0, 1.0])
    other = "left" if hand.side == "right" else "right"
    mirrored = Hand(mirror * hand.joints, hand.radii, side=other)  # type: ignore[arg-type]
    before, after = SKIN.place(hand), SKIN.place(mirrored)
    np.testing.assert_allclose(after.points, mirror * before.points, atol=1e-9)
    np.testing.assert_allclose(after.normals, mirror * before.normals, atol=1e-7)


def test_a_bent_finger_carries_its_skin_without_spinning_it() -> None:
    """Bending the middle finger turns the parts beyond each joint about x, and nothing else."""
    angles = np.radians([80.0, 100.0, 70.0])
    middle = [np.zeros(3)] * 14
    for joint, angle in enumerate(angles):
        middle[14 - 1 - 5 - joint] = np.array([-angle, 0.0, 0.0])  # thumb 2, index 3, then middle
    # Each joint turns in its present pose, after the joints nearer to the palm.
    placed = SKIN.place(Hand(bent(REST.joints, middle)))  # type: ignore[arg-type]
    for c, bone in enumerate(BONES):
        if bone.base[0] in (12, 13, 14) and bone.base[0] == bone.base[1]:
            turn = Rotation.from_rotvec([-angles[: bone.base[0] - 11].sum(), 0.0, 0.0])
            on = SKIN.bone == c
            np.testing.assert_allclose(
                placed.normals[on], turn.apply(SKIN.surface.normals[on]), atol=1e-9
            )


def test_the_skin_moves_continuously_as_the_hand_closes() -> None:
    rng = np.random.default_rng(4)
    # From fingers to a fist, with twist and spread, beyond what a hand can do.
    axes = np.array([-1.0, 0.0, 0.0]) + rng.normal(0.0, 0.1, (14, 3))
    steps = [
        SKIN.place(Hand(bent(REST.joints, list(angle * axes)))).points  # type: ignore[arg-type]
        for angle in np.linspace(0.0, 2.2, 221)
    ]
    # A step of 0.01 rad in each of three joints cannot move a point 0.13 m away by more.
    assert np.abs(np.diff(steps, axis=0)).max() < 4e-3


def area_density(rods: Floats) -> Floats:
    """Return the area of each skin point, up to its constant share of its bone's mantle or cap, (K,) [m^2].

    On a mantle, this is the area of a thin frustum; on a cap, that of the cap's zone.
    """
    rod, h = rods[SKIN.bone], 1e-6
    length = np.linalg.norm(rod[:, 3:6] - rod[:, :3], axis=1)
    first, last = rod[:, 6], rod[:, 7]
    lean = (first - last) / length

    def ring(s: Floats) -> tuple[Floats, Floats]:
        r = first + s * (last - first)
        return s * length + r * lean, r * np.sqrt(1.0 - lean**2)

    (z0, rho0), (z1, rho1) = ring(SKIN.along - h), ring(SKIN.along + h)
    frustum = np.pi * (rho0 + rho1) * np.hypot(z1 - z0, rho1 - rho0) / h
    zone = (
        2.0 * np.pi * np.where(SKIN.along == 0.0, first**2 * (1.0 + lean), last**2 * (1.0 - lean))
    )
    return np.where(SKIN.axial == 0.0, frustum, zone)


@pytest.mark.parametrize(("longer", "thicker"), [(2.0, 1.0), (1.0, 2.0), (1.3, 0.7), (2.0, 2.0)])
def test_area_stretches_with_the_bone(longer: float, thicker: float) -> None:
    hand = Hand(longer * REST.joints, thicker * REST.radii)  # type: ignore[operator]
    stretch = area_density(make_capsules(hand)) / area_density(make_capsules(REST))
    np.testing.assert_allclose(SKIN.place(hand).area, stretch * SKIN.area, rtol=1e-6)
    assert 0.6 < (SKIN.axial == 0.0).mean() < 1.0


def test_the_skin_of_a_straight_finger_has_no_steps() -> None:
    """Along the underside of each finger, the slope is at most that by which the finger tapers."""
    joints, radii = REST.carriers, REST.radii
    flesh = make_capsules(REST)
    for knuckle in (7, 12, 17, 22):
        s = np.linspace(0.7, 3.0, 400)  # closer to the palm, the palm is nearest
        at = np.stack(
            [np.interp(s, range(4), joints[knuckle : knuckle + 4, k]) for k in range(3)], axis=-1
        )
        below = at - [0.0, 0.0, 0.05]
        height = 0.05 - distance_to_skin(flesh, below)
        slope = np.diff(height) / np.linalg.norm(np.diff(at, axis=0), axis=1)
        steepest = np.abs(
            np.diff(radii[knuckle : knuckle + 4])
            / np.linalg.norm(np.diff(joints[knuckle : knuckle + 4], axis=0), axis=1)
        ).max()
        assert np.abs(slope).max() < 1.1 * steepest


@pytest.mark.parametrize("kept", [[], [0, 1, 2, 3], [1, 12], [7, 12, 22]])
def test_joints_that_coincide_give_numbers(kept: list[int]) -> None:
    joints = np.full((26, 3), 0.2)
    joints[kept] = REST.joints[kept]  # type: ignore[index]
    hand = Hand(joints)
    placed = SKIN.place(hand)
    for array in placed:
        assert np.isfinite(array).all()
    np.testing.assert_allclose(
        to_capsules(placed.capsules, placed.points)[ALL, SKIN.bone], 0.0, atol=1e-12
    )
    for found in find_closest(placed.capsules, joints):
        assert np.isfinite(found).all()


def test_a_joint_bent_back_on_itself_gives_numbers() -> None:
    joints = np.array(REST.joints)
    for first in (12, 7):  # the middle finger exactly, the index finger roughly
        joints[first + 1 : first + 4] = 2 * joints[first] - joints[first + 1 : first + 4]
    joints[8] += 1e-9
    placed = SKIN.place(Hand(joints))
    np.testing.assert_allclose(
        to_capsules(placed.capsules, placed.points)[ALL, SKIN.bone], 0.0, atol=1e-9
    )


def least_apart(skin: Skin, points: Floats, nodes: Any, within: float) -> float:
    """Return the smallest distance of nodes on the same side [m], up to `within` [m]. points: of the skin."""
    pairs = KDTree(points[nodes]).query_pairs(within, output_type="ndarray")
    i, j = nodes[pairs].T
    n, fingers = skin.surface.normals, skin.surface.fingers
    same = (n[i] * n[j]).sum(axis=1) > 0.0
    same &= (fingers[i] == fingers[j]) | (fingers[i] == 0) | (fingers[j] == 0)
    return float(np.linalg.norm(points[i] - points[j], axis=1)[same].min(initial=np.inf))


@pytest.mark.parametrize("level", LEVELS)
def test_the_nodes_of_a_level_are_its_spacing_apart(level: int) -> None:
    nodes = np.intersect1d(np.arange(SKIN.counts[level]), SHOWN)
    near = least_apart(SKIN, SKIN.surface.points, nodes, 2.0 * SPACINGS[level])
    assert SPACINGS[level] <= near < 2.0 * SPACINGS[level]
    area = SKIN.node_area[level]  # nodes stand for all the skin
    assert area.shape == (SKIN.counts[level],)
    assert area[nodes].sum() == pytest.approx(SKIN.area[SHOWN].sum())
    assert area.min() > 0.0


def test_levels_are_nested_from_fine_to_coarse() -> None:
    assert SKIN.counts[0] == len(SKIN)
    assert list(SKIN.counts) == sorted(SKIN.counts, reverse=True)
    np.testing.assert_allclose(SKIN.levels[1:] / SKIN.levels[:-1], math.sqrt(2.0))
    assert (SKIN.levels[0], SKIN.levels[-1]) == (0.00175, pytest.approx(0.028))


@pytest.mark.parametrize("level", LEVELS)
def test_shares_keep_the_force_on_its_side_of_the_skin(level: int) -> None:
    indices, weights = SKIN.share[level]
    assert (weights >= 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-12)
    assert indices.min() >= 0
    assert indices.max() < SKIN.counts[level]
    nodes = ALL[: SKIN.counts[level]]
    np.testing.assert_array_equal(indices[nodes][:, 0], nodes)
    np.testing.assert_array_equal(weights[nodes][:, 0], 1.0)
    used = weights > 0.0
    cosine = (SKIN.surface.normals[:, None] * SKIN.surface.normals[indices]).sum(axis=2)
    assert cosine[used].min() > 0.0
    mine, theirs = SKIN.surface.fingers[:, None], SKIN.surface.fingers[indices]
    assert not (used & (mine != theirs) & (mine > 0) & (theirs > 0)).any()
    # The force stays near its place.
    middle = (weights[..., None] * SKIN.surface.points[indices]).sum(axis=1)
    moved = np.linalg.norm(middle - SKIN.surface.points, axis=1)
    assert moved[SHOWN].mean() < 0.4 * SPACINGS[level]
    assert moved[SHOWN].max() < 1.75 * SPACINGS[level]


def test_shares_change_smoothly_over_the_skin() -> None:
    """Neighbouring fine points share their force among nodes in nearly the same way."""
    indices, weights = SKIN.share[5]
    full = np.zeros((len(SKIN), SKIN.counts[5]), dtype=np.float32)
    np.add.at(full, (ALL[:, None], indices), weights)
    pairs = KDTree(SKIN.surface.points).query_pairs(5e-3, output_type="ndarray")
    close = (SKIN.surface.normals[pairs[:, 0]] * SKIN.surface.normals[pairs[:, 1]]).sum(axis=1)
    pairs = pairs[close > 0.9]
    change = np.abs(full[pairs[:, 0]] - full[pairs[:, 1]]).sum(axis=1) / 2.0  # 0 same, 1 disjoint
    assert np.median(change) < 0.45
    assert np.quantile(change, 0.99) < 0.95


def test_every_bone_has_points() -> None:
    assert len(BONES) == len(make_capsules(REST))
    np.testing.assert_array_equal(np.unique(SKIN.bone), np.arange(len(BONES)))


@settings(max_examples=20)
@given(hands())
def test_bounds_hold_each_bones_points(hand: Hand) -> None:
    placed = SKIN.place(hand)
    np.testing.assert_array_equal(placed.bounds, find_bounds(placed.capsules))
    centre, radius = placed.bounds[SKIN.bone, :3], placed.bounds[SKIN.bone, 3]
    assert (np.linalg.norm(placed.points - centre, axis=1) <= radius + 1e-12).all()


def test_a_way_out_that_goes_round_in_circles_goes_straight_on() -> None:
    """In this crushed hand, each of four bones leads into the next."""
    ends = 1e-3 * np.array(
        [
            [-29, 11, 16, 2, -2, -12, 11],
            [16, 6, 13, -6, -18, -18, 6],
            [6, 5, -1, 0, -1, 16, 7],
            [0, -58, 13, 4, 7, 14, 15],
        ]
    )  # [m]
    ends = np.c_[ends, ends[:, 6]]
    found = find_closest(ends, np.zeros((1, 3)))
    on = to_capsules(ends, found.points)[0]
    assert on.min() == pytest.approx(0.0, abs=1e-9)
    assert on[found.bone[0]] == pytest.approx(0.0, abs=1e-9)
    step = to_capsules(ends, found.points + 1e-5 * found.normals)[0]
    assert step[found.bone[0]] == pytest.approx(1e-5, abs=1e-9)


@settings(max_examples=30)
@given(hands(), st.integers(0, 2**31))
def test_the_closest_skin_is_on_the_union_and_no_other_is_closer(hand: Hand, seed: int) -> None:
    flesh = make_capsules(hand)
    rng = np.random.default_rng(seed)
    points = hand.joints.mean(axis=0) + rng.normal(0.0, 0.05, (200, 3))  # type: ignore[union-attr]
    found = find_closest(flesh, points)
    away = to_capsules(flesh, points).min(axis=1)
    np.testing.assert_allclose(found.distance, away, atol=1e-12)
    np.testing.assert_array_equal(distance_to_skin(flesh, points), found.distance)
    on = to_capsules(flesh, found.points)
    np.testing.assert_allclose(on[np.arange(200), found.bone], 0.0, atol=1e-9)
    assert on.min() > -1e-9
    outside = away > 1e-9
    travel = np.linalg.norm(found.points - points, axis=1)
    np.testing.assert_allclose(travel[outside], away[outside], atol=1e-9)
    way = (points - found.points)[outside] / travel[outside, None]
    np.testing.assert_allclose(found.normals[outside], way, atol=1e-6)
    step = to_capsules(flesh, found.points + 1e-5 * found.normals)[np.arange(200), found.bone]
    np.testing.assert_allclose(step, 1e-5, atol=1e-9)


def blob() -> tuple[Floats, Any]:
    """Return an ellipsoid of a hand's size."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    return np.array(ball.vertices) * [0.04, 0.09, 0.015], np.array(ball.faces)


@pytest.mark.parametrize("inside_out", [False, True])
def test_a_mesh_has_a_skin_too(inside_out: bool) -> None:
    vertices, faces = blob()
    hand = Hand(vertices=vertices, faces=faces[:, ::-1] if inside_out else faces)
    skin = get_skin(hand)
    placed, mesh = skin.place(hand), trimesh.Trimesh(vertices, faces)
    assert placed.area.sum() == pytest.approx(mesh.area)
    assert (placed.normals * placed.points / np.array([0.04, 0.09, 0.015]) ** 2).sum(
        axis=1
    ).min() > 0
    on, away, _ = trimesh.proximity.closest_point_naive(mesh, placed.points[::20])
    np.testing.assert_allclose(on, placed.points[::20], atol=1e-9)
    assert away.max() < 1e-9
    assert skin.find_exposed(placed, np.arange(5)).all()
    for level in LEVELS:
        nodes = np.arange(skin.counts[level])
        assert least_apart(skin, placed.points, nodes, SPACINGS[level]) >= SPACINGS[level]
        np.testing.assert_allclose(skin.share[level].weights.sum(axis=1), 1.0)
    centre, radius = placed.bounds[skin.bone, :3], placed.bounds[skin.bone, 3]
    assert (np.linalg.norm(placed.points - centre, axis=1) <= radius + 1e-12).all()
    assert placed.bounds[:, 3].max() < 0.06


def test_a_mesh_carries_its_skin() -> None:
    vertices, faces = blob()
    hand = Hand(vertices=vertices, faces=faces)
    skin = get_skin(hand)
    assert get_skin(Hand(vertices=0.9 * vertices, faces=faces.tolist())) is skin
    assert get_skin(Hand(vertices=vertices, faces=faces[:-1])) is not skin
    before = skin.place(hand)
    pose = pc.Pose((0.1, 0.2, 0.3)).rotate("y", math.radians(50.0))
    after = skin.place(hand.transform(pose))
    np.testing.assert_allclose(after.points, pose.points(before.points), atol=1e-12)
    np.testing.assert_allclose(after.normals, pose.directions(before.normals), atol=1e-9)
    smaller = skin.place(Hand(vertices=0.5 * vertices, faces=faces))
    np.testing.assert_allclose(smaller.area, before.area / 4.0)
    flat = skin.place(Hand(vertices=np.zeros_like(vertices), faces=faces))
    assert not np.isnan(np.concatenate([flat.points, flat.normals])).any()
    assert flat.area.sum() == 0.0


def test_the_closest_skin_of_a_mesh() -> None:
    vertices, faces = blob()
    hand = Hand(vertices=vertices, faces=faces)
    skin = get_skin(hand)
    points = np.array([[0.0, 0.0, -0.1], [0.0, 0.0, 0.014], [0.1, 0.0, 0.0]])
    found = skin.closest(hand, points)
    np.testing.assert_allclose(found.distance, [0.085, -0.001, 0.06], atol=1e-4)
    np.testing.assert_allclose(found.points[0], [0.0, 0.0, -0.015], atol=1e-4)
    np.testing.assert_allclose(found.normals[0], [0.0, 0.0, -1.0], atol=0.05)
    assert (found.bone < 24).all()
    inside_out = Hand(vertices=vertices, faces=faces[:, ::-1])
    turned = get_skin(inside_out).closest(inside_out, points)
    np.testing.assert_allclose(turned.distance, found.distance, atol=1e-12)
    np.testing.assert_allclose(turned.normals, found.normals, atol=1e-9)


def test_hands_of_other_kinds_are_refused() -> None:
    vertices, faces = blob()
    mesh = Hand(vertices=vertices, faces=faces)
    with pytest.raises(pc.ArgumentError, match="joints"):
        SKIN.place(mesh)
    with pytest.raises(pc.ArgumentError, match="vertices"):
        get_skin(mesh).place(REST)
    lost = Hand(vertices=np.full_like(vertices, math.nan), faces=faces[1:])
    with pytest.raises(pc.ArgumentError, match="lost"):
        get_skin(lost)
    with pytest.raises(pc.ArgumentError, match="area"):
        get_skin(Hand(vertices=[[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]], faces=[[0, 1, 2]]))


def test_all_hands_of_joints_share_one_skin() -> None:
    assert get_skin(Hand.open("left")) is SKIN
    assert SKIN.closest(REST, np.zeros((1, 3))).distance[0] == pytest.approx(
        distance_to_skin(make_capsules(REST), np.zeros((1, 3)))[0]
    )


# ---------------------------------------------------------------------- points between the others


def place_all_between(skin: Skin, hand: Hand, level: int) -> tuple[Floats, Floats, Floats]:
    every = np.arange(len(skin.bones_between))
    assert skin.between is not None
    return skin.place_between(hand, every, skin.between.area[level][len(skin) :])


@given(hands())
@settings(max_examples=10)
def test_points_between_the_others_lie_on_their_bones_of_every_hand(hand: Hand) -> None:
    points, normals, area = place_all_between(SKIN, hand, 0)
    capsules = make_capsules(hand)
    away = to_capsules(capsules, points)[np.arange(len(points)), SKIN.bones_between]
    np.testing.assert_allclose(away, 0.0, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    assert (area >= 0.0).all()


def test_points_between_the_others_are_denser_level_by_level_and_have_all_the_area() -> None:
    between = SKIN.between
    assert between is not None
    placed = SKIN.place(REST)
    points, _, area = place_all_between(SKIN, REST, 0)
    nearest = np.repeat(ALL, np.diff(between.first))  # the coarse point of each point in between
    assert np.linalg.norm(points - placed.points[nearest], axis=1).max() <= SPACINGS[0]
    counts = [np.count_nonzero(one) for one in between.area]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] == SKIN.count > 6 * len(SKIN)
    assert counts[-1] > 2 * len(SKIN)
    for level, spacing in enumerate(between.levels):
        of_level = between.area[level]
        assert of_level.sum() == pytest.approx(SKIN.area.sum())
        used = of_level[len(SKIN) :] > 0.0
        np.testing.assert_array_equal(between.find(ALL, level), np.flatnonzero(used))
        if level:  # the finest level has all points
            shown = used & ~SKIN.hidden_between
            tree = KDTree(np.concatenate([placed.points[SHOWN], points[shown]]))
            apart = tree.query(points[shown], 2)[0][:, 1]
            assert (apart > 0.99 * spacing).mean() > 0.97  # points on two sides of a gap are closer
    np.testing.assert_allclose(area, between.area[0][len(SKIN) :])
    some = np.array([3, 700, 4000])
    found = between.find(some, 1)
    assert set(nearest[found].tolist()) <= set(some.tolist())
    assert len(between.find(some[:0], 0)) == 0


def test_a_mesh_has_points_between_the_others_too() -> None:
    vertices, faces = blob()
    hand = Hand(vertices=vertices, faces=faces)
    skin = get_skin(hand)
    assert skin.between is not None
    pose = pc.Pose((0.1, 0.2, 0.3)).rotate("y", math.radians(50.0))
    points, normals, area = place_all_between(skin, hand, 0)
    moved, turned, same = place_all_between(skin, hand.transform(pose), 0)
    np.testing.assert_allclose(moved, pose.points(points), atol=1e-12)
    np.testing.assert_allclose(turned, pose.directions(normals), atol=1e-9)
    np.testing.assert_allclose(same, area)
    on, away, _ = trimesh.proximity.closest_point_naive(
        trimesh.Trimesh(vertices, faces), points[::200]
    )
    np.testing.assert_allclose(on, points[::200], atol=1e-6)
    assert away.max() < 1e-6
    finest = skin.between.area[0]
    own = finest[: len(skin)].sum()
    assert own + area.sum() == pytest.approx(trimesh.Trimesh(vertices, faces).area)


@pytest.mark.parametrize("side", range(3, 12))
@pytest.mark.parametrize("turned", [False, True])
def test_a_flat_sheet_looks_where_the_corners_of_its_faces_go_anticlockwise(
    side: int, turned: bool
) -> None:
    """The side that looks away from its middle is a matter of rounding."""
    x, y = np.meshgrid(np.linspace(-0.04, 0.04, side), np.linspace(-0.03, 0.05, side))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.full(side * side, 0.2)])
    faces = []
    for j in range(side - 1):
        for i in range(side - 1):
            a = j * side + i
            faces += [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
    order = np.array(faces)[:, ::-1] if turned else np.array(faces)
    normals = MeshSkin(pc.Hand(vertices=vertices, faces=order)).surface.normals
    assert normals[:, 2] == pytest.approx(1.0 if turned else -1.0)
