"""The boxes in which anything can be felt lie in the workspace, near the array and around the hands."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.argument_checks import MAX_LENGTH
from pacinian.scene.sampling.culling_boxes import CullingBoxes, cut
from pacinian.scene.sampling.posed_skin import PosedSkin
from pacinian.scene.sampling.samples import no_samples

bounded = settings(max_examples=40)
ROOM = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
AWAY = pc.Workspace((0.5, 0.5, 0.1), (0.6, 0.6, 0.3))
HANDS = (
    pc.Hand.open("right", pc.Pose((-0.1, 0.0, 0.2))),
    pc.Hand.open("left", pc.Pose((0.1, 0.0, 0.2))),
)
SKINS = [PosedSkin(hand) for hand in HANDS]
CENTRES = [None, np.array([0.1, 0.2, 0.0])]


def corners(box: Any) -> tuple[Any, Any]:
    return box[:3], box[3:]


@pytest.mark.parametrize("centre", CENTRES, ids=["no array", "array"])
@pytest.mark.parametrize("room", [None, ROOM, AWAY], ids=["free", "room", "away"])
@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_box_holds_the_places_that_are_within_everything(
    centre: Any, room: pc.Workspace | None, count: int
) -> None:
    found = CullingBoxes(centre).find(pc.Scene(workspace=room, hands=HANDS[:count]), SKINS[:count])
    rng = np.random.default_rng(3)
    q = np.vstack([rng.uniform(-0.7, 0.7, (4000, 3)), rng.uniform(-90.0, 90.0, (4000, 3))])
    expected = np.ones(len(q), np.bool_)
    if centre is not None:
        expected &= (np.abs(q - centre) <= MAX_LENGTH).all(axis=1)
    if room is not None:
        expected &= room.holds(q)
    if count:
        points = [skin.box for skin in SKINS[:count]]
        expected &= np.any([((b[:3] <= q) & (q <= b[3:])).all(axis=1) for b in points], axis=0)
    inside = [((low <= q) & (q <= high)).all(axis=1) for low, high in map(corners, found)]
    assert np.array_equal(np.any(inside, axis=0) if inside else expected & False, expected)
    assert all((low <= high).all() for low, high in map(corners, found))


def test_a_scene_whose_hands_are_lost_has_no_box() -> None:
    assert CullingBoxes().find(pc.Scene(hands=HANDS), []).shape == (0, 6)


def test_a_box_of_another_workspace_is_not_kept() -> None:
    boxes = CullingBoxes(CENTRES[1])
    for room in (None, ROOM, AWAY, ROOM, ROOM, None, AWAY):
        scene = pc.Scene(workspace=room)
        assert np.array_equal(boxes.find(scene, []), CullingBoxes(CENTRES[1]).find(scene, []))


@given(seed=st.integers(0, 2**31), count=st.integers(0, 20))
@bounded
def test_what_is_outside_the_workspace_is_cut(seed: int, count: int) -> None:
    q = np.random.default_rng(seed).uniform((-0.15, -0.15, 0.05), (0.15, 0.15, 0.35), (count, 3))
    each = np.ones(count)
    samples = no_samples().changed(
        positions=q, radiation_pressure=each, normals=np.zeros((count, 3)), area=each,
        objects=np.zeros(count, np.intp), keys=np.arange(count), most=each,
        regions=np.full(count, -1),
    )  # fmt: skip
    assert cut(None, samples) is samples
    kept = cut(ROOM, samples)
    inside = [i for i in range(count) if (np.abs(q[i] - (0.0, 0.0, 0.2)) <= 0.1).all()]
    assert kept.keys.tolist() == inside
    assert np.array_equal(kept.positions, q[inside])
    assert (kept is samples) == (len(inside) == count)
