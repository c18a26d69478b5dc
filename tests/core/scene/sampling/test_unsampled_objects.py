"""Objects without samples: the sampler says why."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.sampling.array_resolution import ArrayResolution
from pacinian.scene.sampling.distance_cache import DistanceCache
from pacinian.scene.sampling.pose_prediction import PosePredictor
from pacinian.scene.sampling.posed_skin import PosedSkin
from pacinian.scene.sampling.sample_counts import FACES_AWAY, FAR, OUTSIDE, SampleCounts
from pacinian.scene.sampling.unsampled_objects import (
    MAX_UNSEEN,
    is_silent,
    note_outside,
    note_unseen,
)

POINT = pc.Point(name="point", position=(0.0, 0.0, 0.2), radiation_pressure=3.0)
DISC = pc.Surface(
    name="disc", shape=pc.Disc(0.05), pose=pc.Pose((1.0, 0.0, 0.2)), radiation_pressure=3.0
)
OFF = pc.Constant(0.0)
ROOM = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
RESOLVING = ArrayResolution(pc.autd(), pc.Air())
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.2)))
SKIN = PosedSkin(HAND)
BACK = float(SKIN.points[np.linalg.norm(SKIN.points[:, :2], axis=1) < 0.01, 2].max())  # [m]


def ball(z: float, **how: Any) -> pc.Volume:
    return pc.Volume(
        shape=pc.Sphere(0.008), pose=pc.Pose((0.0, 0.0, z)), radiation_pressure=5.0, **how
    )


@pytest.mark.parametrize("item", [POINT, DISC, ball(0.2)])
def test_without_pressure_or_envelope_an_object_is_silent(item: Any) -> None:
    assert not is_silent(item)
    assert not is_silent(replace(item, envelope=pc.Sine(50.0)))
    assert is_silent(replace(item, envelope=OFF))
    assert is_silent(replace(item, radiation_pressure=0.0))


@pytest.mark.parametrize(("room", "reason"), [(ROOM, OUTSIDE), (None, FAR)])
def test_what_is_out_of_bounds_asks_for_samples_that_are_left_out(room: Any, reason: str) -> None:
    items = POINT, DISC, replace(DISC, name="off", envelope=OFF), replace(POINT, name="far")
    scene, counts = pc.Scene(items, room), SampleCounts(items)
    assert note_outside(scene, [0], 0.005, counts) == (2 if room else 0)
    area = np.pi * 0.05**2
    asked = {label: count.asked for label, count in counts.objects.items()}
    assert asked == {"disc": round(area / 0.005**2), "far": 1}
    assert all(one.rendered == 0 for one in counts.objects.values())
    assert all(set(one.reasons) == {reason} for one in counts.objects.values())


def test_by_default_regions_ask_for_closer_samples() -> None:
    counts = [SampleCounts((DISC,)) for _ in range(2)]
    for spacing, one in zip((None, 0.0085), counts, strict=True):
        note_outside(pc.Scene((DISC,), ROOM), [], spacing, one)
    usual, coarse = (one.objects["disc"].asked for one in counts)
    assert usual == pytest.approx(8.0 * coarse, rel=0.01)


def note(*items: Any, hands: Any = (SKIN,)) -> dict[str, dict[str, int]]:
    counts, near = SampleCounts(items), list(range(len(items)))
    scene = pc.Scene(items, hands=(HAND,))
    note_unseen(scene, 0.0, near, list(hands), PosePredictor(), RESOLVING, DistanceCache(), counts)
    return counts.deviations


def test_only_what_touches_nothing_but_the_back_of_the_hand_faces_away() -> None:
    back, palm, apart = ball(BACK, name="back"), ball(0.19, name="palm"), ball(0.4, name="apart")
    assert note(back, palm, apart) == {"back": {FACES_AWAY: 1}}
    assert note(back, hands=()) == {}
    assert note(replace(back, envelope=OFF), ball(BACK, envelope=OFF), palm) == {}
    assert note(replace(back, radiation_pressure=0.0)) == {}
    assert note(replace(POINT, position=(0.0, 0.0, BACK))) == {}


def test_some_objects_are_checked_and_not_all() -> None:
    many = [ball(BACK, name=str(i)) for i in range(MAX_UNSEEN + 3)]
    assert list(note(*many)) == [str(i) for i in range(MAX_UNSEEN)]
