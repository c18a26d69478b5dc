"""The built-in scenes match their descriptions at every moment."""

import itertools
from pathlib import Path

import numpy as np
import pytest

import pacinian as pc
from pacinian import gallery
from pacinian.gallery import SCENES, TRACKED, balls, stone_mesh

ARRAY = pc.autd(3, 3)
MOMENTS = np.linspace(0.5, 1.5, 23).tolist()
TOUCHED = ["sliding-ball", "textured-plane", "mesh", "crowd", "palm", "rain"]
DOCS = Path(__file__).parents[2] / "docs"


def sampler() -> pc.Sampler:
    made = pc.Sampler()
    made.prepare(ARRAY, pc.Air())
    return made


def test_every_scene_is_shown_in_the_docs() -> None:
    text = (DOCS / "scenes.md").read_text()
    for name in SCENES:
        assert f"## {name}" in text
        if name == "empty":
            continue
        picture = DOCS / "pictures" / f"scene-{name}.png"
        assert picture.stat().st_size < 300_000
        assert f"(pictures/{picture.name})" in text


@pytest.mark.parametrize("name", TOUCHED)
def test_the_hand_always_touches_something(name: str) -> None:
    samples = [sampler().sample(SCENES[name](t), t) for t in MOMENTS]
    assert all(len(one) and one.force > 0.0 for one in samples)


def test_scenes_without_a_hand_have_a_focus_or_nothing() -> None:
    assert len(sampler().sample(SCENES["static-focus"](0.3), 0.3)) == 1
    assert len(sampler().sample(SCENES["stm-circle"](0.3), 0.3)) == 1
    assert len(sampler().sample(SCENES["empty"](0.3), 0.3)) == 0


@pytest.mark.parametrize("name", SCENES)
def test_between_two_updates_nothing_is_made_anew(name: str) -> None:
    t = 24.5 / TRACKED
    assert SCENES[name](t) is SCENES[name](t + 0.3 / TRACKED)


@pytest.mark.parametrize("name", ["sliding-ball", "textured-plane", "mesh", "crowd", "palm"])
def test_velocities_are_those_of_the_movement(name: str) -> None:
    """The last update predicts the pose of the next one, apart from acceleration."""
    swing = 2.0 * np.pi
    for k in range(0, 120, 7):
        a, b = (SCENES[name]((k + n + 0.5) / TRACKED) for n in (0, 1))
        most = 0.03 * swing**2 / TRACKED**2
        for one, two in zip(a.hands, b.hands, strict=True):
            assert one.joints is not None
            assert two.joints is not None
            told = one.joints if one.velocities is None else one.extrapolate(1.0 / TRACKED).joints
            assert told is not None
            assert np.abs(told - two.joints).max() < most
        for item, later in zip(a.objects, b.objects, strict=True):
            if item.motion is not None:
                foretold = item.motion.pose(item.pose, item.motion.time + 1.0 / TRACKED)
                d = np.subtract(foretold.position, later.pose.position)
                assert np.abs(d).max() < most


def test_in_the_crowd_three_balls_are_in_reach_and_all_are_felt() -> None:
    for t in MOMENTS:
        one = sampler()
        samples = one.sample(SCENES["crowd"](t), t)
        assert one.skipped["objects away from hands"] == 97
        assert set(samples.objects.tolist()) == {0, 1, 2}


@pytest.mark.parametrize("count", [1, 3, 10, 1000])
def test_there_are_as_many_balls_as_asked(count: int) -> None:
    scene = balls(count)
    assert len(scene.objects) == len({item.name for item in scene.objects}) == count
    one = sampler()
    one.sample(scene.with_hands(gallery.HAND))
    assert one.skipped["objects away from hands"] == max(0, count - 3)


def test_the_stone_is_a_solid_of_ten_thousand_triangles() -> None:
    stone = stone_mesh()
    assert stone.closed
    assert len(stone.faces) == pytest.approx(10_000, rel=0.05)


def test_the_whole_palm_and_its_fingers_are_pressed() -> None:
    samples = pc.Sampler(10_000).sample(SCENES["palm"](0.0), 0.0)
    low, high = samples.positions.min(axis=0), samples.positions.max(axis=0)
    assert high[1] - low[1] > 0.15  # from the wrist to the fingers
    assert len(samples) > 100


def test_ridges_go_by_under_the_fingertips() -> None:
    times = np.arange(0.0, 0.25, 1.0 / TRACKED)
    forces = [sampler().sample(SCENES["textured-plane"](t), t).force for t in times.tolist()]
    turns = sum(
        (b - a) * (c - b) < 0.0 for a, b, c in zip(forces, forces[1:], forces[2:], strict=False)
    )
    assert turns >= 2
    assert max(forces) > 1.05 * min(forces)


def test_drops_fall_one_after_the_other_and_each_is_felt_once_a_second() -> None:
    felt: list[set[int]] = []
    for k in range(120):
        t = (k + 0.5) / TRACKED
        scene = SCENES["rain"](t)
        (drops,) = scene.objects
        assert isinstance(drops, pc.Particles)
        assert len(drops.positions) == gallery.DROPS
        felt.append(set(sampler().sample(scene, t).keys.tolist()))
    assert max(map(len, felt)) <= 4
    assert len(set().union(*felt)) == gallery.DROPS
    begins = [len(b - a) for a, b in itertools.pairwise([felt[-1], *felt])]
    assert sum(begins) == gallery.DROPS
