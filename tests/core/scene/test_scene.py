from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.hands.hand import Hand
from pacinian.scene.material import Material
from pacinian.scene.motion import MAX_EXTRAPOLATION, Motion
from pacinian.scene.objects import Particles, Path
from pacinian.scene.shapes.curves import Circle

bounded = settings(max_examples=80)
names = st.sampled_from(["", "a", "b", "c", "d"])
places = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
motions = st.one_of(st.none(), st.builds(Motion, places, places, st.floats(0.0, 10.0)))


def made(what: int, name: str, at: Any, motion: Motion | None) -> Any:
    how: dict[str, Any] = {"radiation_pressure": 1.0, "name": name, "motion": motion}
    if what == 0:
        return pc.Point(position=at, **how)
    pose = pc.Pose(at)
    if what == 1:
        return pc.Volume(shape=pc.Sphere(0.03), pose=pose, material=Material(reach=0.01), **how)
    if what == 2:
        return Path(shape=Circle(0.02), pose=pose, **how)
    return Particles(positions=((0.0, 0.0, 0.1),), pose=pose, **how)


items = st.builds(made, st.integers(0, 3), names, places, motions)
steps = st.lists(
    st.one_of(
        st.tuples(st.just("put"), st.lists(items, max_size=4)),
        st.tuples(st.just("remove"), st.lists(names, max_size=3)),
        st.tuples(st.just("held"), st.booleans()),
    ),
    max_size=8,
)


def same(scene: pc.Scene, other: pc.Scene) -> None:
    """Check that two scenes are equal, including their cached data."""
    assert scene.objects == other.objects
    assert scene.hands == other.hands
    assert scene.workspace is other.workspace
    assert np.array_equal(scene.bounds, other.bounds)
    assert scene.bounds.shape == (len(scene.objects), 8)
    assert scene._index == other._index
    assert scene.moves_until >= other.moves_until


@given(steps=steps)
@bounded
def test_a_changed_scene_is_as_one_built_anew(steps: Any) -> None:
    scene, hand = pc.Scene((), pc.Workspace((-1.0,) * 3, (1.0,) * 3)), Hand.open()
    objects: list[Any] = []
    for what, how in steps:
        if what == "put":
            scene = scene.put(*how)
            for item in how:
                where = [i for i, x in enumerate(objects) if item.name and x.name == item.name]
                if where:
                    objects[where[0]] = item
                else:
                    objects.append(item)
        elif what == "remove":
            scene = scene.remove(*how)
            objects = [x for x in objects if not x.name or x.name not in how]
        else:
            scene = scene.with_hands(*([hand] if how else []))
        same(scene, pc.Scene(tuple(objects), scene.workspace, scene.hands))


def test_a_scene_is_not_changed_by_what_comes_of_it() -> None:
    a, b, c = (made(1, name, (0.0, 0.0, 0.1), None) for name in "abc")
    root = pc.Scene((a,))
    bounds = root.bounds.copy()
    same(root.put(b), pc.Scene((a, b)))
    same(root.put(c), pc.Scene((a, c)))
    same(root.put(b).put(c).remove("b").put(b), pc.Scene((a, c, b)))
    same(root.put(b, c).remove("a", "b"), pc.Scene((c,)))
    _ = root.put(replace(a, pose=pc.Pose((0.5, 0.0, 0.0)))), root.remove("a")
    same(root, pc.Scene((a,)))
    assert np.array_equal(root.bounds, bounds)


def test_put_twice_at_once_the_last_counts() -> None:
    first, second = (made(0, "a", (x, 0.0, 0.1), None) for x in (0.1, 0.2))
    same(pc.Scene().put(first, second), pc.Scene((second,)))


def test_a_change_of_hands_shares_the_objects() -> None:
    scene = pc.Scene((made(0, "a", (0.0, 0.0, 0.1), None),))
    bounds = scene.bounds
    held = scene.with_hands(Hand.open("left"), Hand.open("right"))
    assert held.objects is scene.objects
    assert held.bounds is bounds
    assert [hand.name for hand in held.hands] == ["left", "right"]


@given(item=items, t=st.floats(0.0, 12.0), seed=st.integers(0, 2**31))
@bounded
def test_all_that_is_felt_of_an_object_is_within_its_bound(item: Any, t: float, seed: int) -> None:
    centre, v, (seen, radius) = np.split(pc.Scene((item,)).bounds[0], [3, 6])
    now = item.pose if item.motion is None else item.motion.pose(item.pose, t)
    points = now.points(item.sample_surface(0.005).points)
    age = min(max(t - seen, 0.0), MAX_EXTRAPOLATION)
    away = np.linalg.norm(points - (centre + age * v), axis=1).max()
    assert away + getattr(item, "radius", 0.0) + item.material.reach <= radius + 1e-9


def test_it_tells_when_all_stand_still() -> None:
    still = made(0, "still", (0.0, 0.0, 0.1), Motion(time=5.0))
    moving = made(0, "moving", (0.0, 0.0, 0.1), Motion((1.0, 0.0, 0.0), time=3.0))
    turning = made(1, "turning", (0.0, 0.0, 0.1), Motion((0.0,) * 3, (1.0, 0.0, 0.0), time=4.0))
    assert pc.Scene().moves_until == -math.inf
    assert pc.Scene((still,)).moves_until == -math.inf
    assert pc.Scene((still, moving)).moves_until == 3.0 + MAX_EXTRAPOLATION
    assert pc.Scene((turning, moving)).moves_until == 4.0 + MAX_EXTRAPOLATION


# ---------------------------------------------------------------------------------- bad input


def test_names_are_unique() -> None:
    a = made(0, "ball", (0.0, 0.0, 0.1), None)
    with pytest.raises(pc.ArgumentError, match=r"^`objects` must have unique names.*'ball'"):
        pc.Scene((a, a))
    unnamed = made(0, "", (0.0, 0.0, 0.1), None)
    assert len(pc.Scene((unnamed, unnamed)).objects) == 2


def test_hands_have_names_of_their_own_too() -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`hands` must have unique names"):
        pc.Scene(hands=(Hand.open(), Hand.open()))
    assert len(pc.Scene(hands=(Hand.open(name="mine"), Hand.open(name="yours"))).hands) == 2


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("items", lambda bad: pc.Scene().put(bad)),
        (r"hands\[0\]", lambda bad: pc.Scene().with_hands(bad)),
        (r"objects\[1\]", lambda bad: pc.Scene((made(0, "", (0.0, 0.0, 0.1), None), bad))),
        (r"hands\[0\]", lambda bad: pc.Scene(hands=(bad,))),
        ("hands", lambda _: pc.Scene(hands=5)),
        ("objects", lambda _: pc.Scene(made(0, "", (0.0, 0.0, 0.1), None))),
    ],
)
def test_what_is_no_object_or_hand_is_refused_and_named(argument: str, make: Any) -> None:
    for bad in (None, pc.Sphere(0.1)):
        with pytest.raises(pc.ArgumentError, match=f"^`{argument}` must be a"):
            make(bad)


def test_what_is_not_there_may_be_removed() -> None:
    scene = pc.Scene((made(0, "a", (0.0, 0.0, 0.1), None),))
    assert scene.remove("b", "") is scene


# ---------------------------------------------------------------------------------------- many


def test_the_index_of_names_is_copied_once_however_many_names_are_new() -> None:
    class Names(dict[str, int]):
        copies = 0

        def copy(self) -> Names:
            Names.copies += 1
            return Names(self)

    scene = pc.Scene()
    scene.__dict__["_index"] = Names()
    scene.put(*(made(0, f"{i}", (0.0, 0.0, 0.1), None) for i in range(100)))
    assert Names.copies == 1


def test_of_a_hundred_thousand_objects_only_the_one_that_is_touched_is_looked_at() -> None:
    def never(points: Any) -> Any:
        pytest.fail("an object out of reach was asked for its distance")

    shape = pc.SDF(never, (0.03, 0.03, 0.03))
    far = pc.Volume(shape=shape, pose=pc.Pose((5.0, 5.0, 5.0)), radiation_pressure=1.0)
    ball = made(1, "ball", (0.0, 0.0, 0.2), None)
    scene = pc.Scene((far,) * 100_000).put(ball)
    scene = scene.with_hands(Hand.open("right", pc.Pose((0.0, 0.0, 0.21))))
    samples = pc.Sampler().sample(scene)
    assert set(samples.objects.tolist()) == {100_000}
    assert samples.items[100_000] is ball
