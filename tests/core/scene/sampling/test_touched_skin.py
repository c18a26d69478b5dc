"""Random places on touched skin: they lie on it, cover all of it, and ask for what the material asks for there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.scene.hands.capsule_skin import CapsuleSkin
from pacinian.scene.hands.capsules import make_capsules
from pacinian.scene.sampling.touched_skin import INNER, OUTER, TouchedSkinObserver
from pacinian_lab.regions import skin
from pacinian_lab.regions.contacts import CONTACTS

AIR, ARRAY = pc.Air(), pc.autd(3, 3)
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.21)))
RADIUS, CENTRE, FULL_DEPTH = 0.02, np.array([0.0, 0.0, 0.178]), 0.002
BALL = pc.Volume(
    name="ball",
    shape=pc.Sphere(RADIUS),
    pose=pc.Pose(tuple(CENTRE)),
    radiation_pressure=6.0,
)


def scatter(*items: Any, count: int = 4000, **how: Any) -> pc.Samples:
    observer = TouchedSkinObserver(ARRAY, AIR)
    return observer.scatter_places(pc.Scene(items, **({"hands": (HAND,)} | how)), 0.0, count)


def find_touched(item: pc.Volume) -> tuple[Any, Any]:
    """Return the points of a fine skin that a ball touches, and what its material asks for, (K, 3) [m], (K,) [Pa]."""
    points = skin._fine().place(HAND).points
    depth = RADIUS - np.linalg.norm(points - item.pose.position, axis=1)
    touched = (depth > 0.0) & (points[:, 2] < 0.2)  # not the back of the hand
    return points[touched], np.minimum(depth[touched] / FULL_DEPTH, 1.0) * item.radiation_pressure


def test_places_lie_on_the_skin_and_ask_for_what_the_material_asks() -> None:
    places = scatter(BALL)
    inside = places.only(places.regions >= 0)
    found = CapsuleSkin().closest(HAND, inside.positions)
    assert np.abs(found.distance).max() < 2e-4
    depth = RADIUS - np.linalg.norm(inside.positions - CENTRE, axis=1)
    expected = np.minimum(depth / FULL_DEPTH, 1.0) * 6.0
    np.testing.assert_allclose(inside.radiation_pressure, expected, rtol=1e-9)


def test_places_cover_the_touched_skin_evenly() -> None:
    places = scatter(BALL)
    inside = places.only(places.regions >= 0)
    points, asked = find_touched(BALL)
    assert KDTree(inside.positions).query(points)[0].max() < 1.5e-3
    rim = 2.0  # [Pa]
    assert (inside.radiation_pressure < rim).mean() == pytest.approx((asked < rim).mean(), abs=0.03)
    assert inside.radiation_pressure.mean() == pytest.approx(asked.mean(), rel=0.02)
    again = scatter(BALL, count=50)
    assert 30 < (again.regions >= 0).sum() <= 50


def test_the_ends_of_a_flat_letter_are_covered() -> None:
    """Behind a sheet, skin just outside its outline is far from it, but skin between its points may be inside."""
    scene = CONTACTS["letter S, at the palm"]()
    places = scatter(*scene.objects, hands=scene.hands)
    fine, solved = pc.Sampler(100_000, 1e-3, perception=False), pc.Sampler(640, perception=False)
    fine.skin = skin._fine()
    found = []
    for sampler in (fine, solved):
        sampler.prepare(ARRAY, AIR)
        found.append(sampler.sample(scene).positions)
    touched, samples = found
    inside = places.positions[places.regions >= 0]
    assert KDTree(inside).query(touched)[0].max() < 1.6e-3
    assert KDTree(samples).query(touched)[0].max() < 2.1e-3


def test_places_beside_touch_nothing_and_are_3_to_30_mm_away() -> None:
    places = scatter(BALL)
    beside = places.only(places.regions == -2)
    assert len(beside) > 300
    assert not beside.radiation_pressure.any()
    assert (np.linalg.norm(beside.positions - CENTRE, axis=1) > RADIUS).all()
    away = KDTree(places.only(places.regions >= 0).positions).query(beside.positions)[0]
    assert away.min() > INNER - 2e-3
    assert np.median(away) > 6e-3
    assert away.max() < OUTER
    towards = ARRAY.positions - beside.positions[:, None]
    assert (np.einsum("mnk,mk->mn", towards, beside.normals) > 0.0).any(axis=1).all()


def test_two_objects_on_the_same_skin_ask_for_the_mean() -> None:
    other = pc.Volume(
        name="other",
        shape=pc.Sphere(RADIUS),
        pose=pc.Pose((0.006, *CENTRE[1:].tolist())),
        radiation_pressure=2.0,
    )
    places = scatter(BALL, other)
    for k, item in enumerate((BALL, other)):
        own = places.only((places.regions >= 0) & (places.objects == k))
        asked = np.array(
            [
                np.clip(
                    (RADIUS - np.linalg.norm(own.positions - one.pose.position, axis=1))
                    / FULL_DEPTH,
                    0.0,
                    1.0,
                )
                * one.radiation_pressure
                for one in (BALL, other)
            ]
        )
        mean = asked.sum(axis=0) / (asked > 0.0).sum(axis=0)
        np.testing.assert_allclose(own.radiation_pressure, mean, rtol=1e-6, err_msg=item.name)


def test_each_hand_and_each_object_has_places_of_its_own() -> None:
    away = pc.Pose((0.12, 0.0, 0.21))
    hands = HAND, pc.Hand.open("left", away)
    twin = pc.Volume(
        name="twin",
        shape=pc.Sphere(RADIUS),
        pose=pc.Pose((0.12, *CENTRE[1:].tolist())),
        radiation_pressure=1.0,
    )
    places = scatter(BALL, twin, count=100, hands=hands)
    inside = places.regions >= 0
    assert set(places.objects[inside].tolist()) == {0, 1}
    assert len(set(places.regions[inside].tolist())) == 2
    assert (places.radiation_pressure[places.objects == 1] <= 1.0).all()
    assert places.capsules is not None  # one hand may shade the other
    assert len(places.capsules) == 2 * len(make_capsules(HAND))


def test_nothing_is_scattered_without_contact_or_where_a_technique_moves_the_samples() -> None:
    far = pc.Volume(shape=pc.Sphere(RADIUS), pose=pc.Pose((0.0, 0.0, 0.1)), radiation_pressure=6.0)
    moved = pc.Volume(
        shape=pc.Sphere(RADIUS), pose=BALL.pose, radiation_pressure=6.0,
        technique=pc.STM(frequency=50.0),
    )  # fmt: skip
    point = pc.Point(position=(0.0, 0.0, 0.195), radiation_pressure=6.0)
    for items in ((), (far,), (moved,), (point,)):
        assert not len(scatter(*items))
    assert not len(scatter(BALL, hands=()))
    workspace = pc.Workspace((-1.0, -1.0, 0.0), (1.0, 0.0, 1.0))
    assert (scatter(BALL, workspace=workspace).positions[:, 1] <= 0.0).all()
