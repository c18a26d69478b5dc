from __future__ import annotations

import dataclasses
import math
from collections import Counter
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.sampling import KEPT, _touches

bounded = settings(deadline=None, derandomize=True, max_examples=40)
lengths = st.floats(0.002, 0.12)
coordinates = st.floats(-0.3, 0.3)
positions = st.tuples(coordinates, coordinates, coordinates)
poses = st.builds(
    lambda position, seed: pc.Pose(
        position, tuple(Rotation.random(rng=np.random.default_rng(seed)).as_quat().tolist())
    ),
    positions,
    st.integers(0, 2**31),
)
strengths = st.floats(0.0, 1000.0)
points = st.builds(
    lambda position, pressure: pc.Point(position=position, radiation_pressure=pressure),
    positions,
    strengths,
)
surfaces = st.builds(
    lambda shape, pose, pressure: pc.Surface(shape=shape, pose=pose, radiation_pressure=pressure),
    st.one_of(
        st.builds(pc.Rectangle, lengths, lengths),
        st.builds(pc.Disc, lengths),
        st.builds(pc.Sphere, lengths),
    ),
    poses,
    strengths,
)
volumes = st.builds(
    lambda shape, felt, pose, pressure: pc.Volume(
        shape=shape, felt=felt, pose=pose, radiation_pressure=pressure
    ),
    st.one_of(
        st.builds(pc.Sphere, lengths),
        st.builds(lambda x, y, z: pc.Box((x, y, z)), lengths, lengths, lengths),
        st.builds(pc.Capsule, lengths, lengths),
    ),
    st.sampled_from(("shell", "interior")),
    poses,
    strengths,
)
objects = st.lists(st.one_of(points, surfaces, volumes), max_size=12).map(tuple)
ROOM = pc.Workspace((-0.15, -0.15, -0.15), (0.15, 0.15, 0.15))


def point(x: float, pressure: float = 1.0) -> pc.Point:
    return pc.Point(position=(x, 0.0, 0.2), radiation_pressure=pressure)


def square(width: float, pose: pc.Pose | None = None, pressure: float = 1.0) -> pc.Surface:
    shape = pc.Rectangle(width, width)
    return pc.Surface(shape=shape, pose=pose or pc.Pose(), radiation_pressure=pressure)


def moved(item: Any, pose: pc.Pose) -> Any:
    """The object after a rigid motion, by SciPy's rotations."""
    turn = Rotation.from_quat(pose.rotation)
    if isinstance(item, pc.Point):
        return replace(item, position=tuple(turn.apply(item.position) + pose.position))
    position = turn.apply(item.pose.position) + pose.position
    rotation = (turn * Rotation.from_quat(item.pose.rotation)).as_quat()
    return replace(item, pose=pc.Pose(tuple(position), tuple(rotation)))


@given(objects=objects, budget=st.integers(1, 300), room=st.sampled_from((None, ROOM)))
@bounded
def test_the_budget_is_never_exceeded(objects: Any, budget: int, room: Any) -> None:
    samples = pc.Sampler(budget=budget).sample(pc.Scene(objects, room))
    assert len(samples) <= budget
    assert samples.spacing >= 0.0085
    assert samples.dropped >= 0
    assert samples.culled >= 0


@given(objects=objects, budget=st.integers(1, 300), room=st.sampled_from((None, ROOM)))
@bounded
def test_every_sample_belongs_to_its_object(objects: Any, budget: int, room: Any) -> None:
    samples = pc.Sampler(budget=budget).sample(pc.Scene(objects, room))
    M = len(samples)
    assert samples.positions.shape == samples.normals.shape == (M, 3)
    assert samples.objects.shape == samples.radiation_pressure.shape == (M,)
    assert (np.diff(samples.objects) >= 0).all()
    for i, item in enumerate(objects):
        mine = samples.objects == i
        assert (samples.radiation_pressure[mine] == item.pressure).all()
        lengths = np.linalg.norm(samples.normals[mine], axis=1)
        if isinstance(item, pc.Point):
            assert mine.sum() <= 1
            assert (samples.positions[mine] == item.position).all()
            assert (lengths == 0.0).all()
        elif getattr(item, "felt", "shell") == "shell":
            assert lengths == pytest.approx(np.ones(mine.sum()))


@given(objects=objects, budget=st.integers(1, 300), room=st.sampled_from((None, ROOM)))
@bounded
def test_kept_dropped_and_culled_are_all_there_is(objects: Any, budget: int, room: Any) -> None:
    samples = pc.Sampler(budget=budget).sample(pc.Scene(objects, room))
    whole = [
        np.array([item.position])
        if isinstance(item, pc.Point)
        else item.pose.points(item.cover(samples.spacing).points)
        for item in objects
    ]
    if room is not None:  # an object that is wholly outside counts as one
        whole = [
            q if _touches(item, room) else q[:1] for item, q in zip(objects, whole, strict=True)
        ]
    everything = np.concatenate([np.empty((0, 3)), *whole])
    assert len(samples) + samples.dropped + samples.culled == len(everything)
    if room is not None:
        inside = room.holds(everything)
        assert samples.culled == (~inside).sum()
        everything = everything[inside]
    assert np.array_equal(samples.positions, everything[: len(samples)])


@given(objects=objects, pose=poses)
@bounded
def test_sampling_follows_a_rigid_motion_of_everything(objects: Any, pose: pc.Pose) -> None:
    here = pc.Sampler().sample(pc.Scene(objects))
    there = pc.Sampler().sample(pc.Scene(tuple(moved(item, pose) for item in objects)))
    turn = Rotation.from_quat(pose.rotation).as_matrix()
    assert there.positions == pytest.approx(here.positions @ turn.T + pose.position, abs=1e-12)
    assert there.normals == pytest.approx(here.normals @ turn.T, abs=1e-12)
    assert np.array_equal(there.objects, here.objects)
    assert np.array_equal(there.radiation_pressure, here.radiation_pressure)
    assert there.spacing == here.spacing


@given(objects=objects, index=st.integers(0, 11), pose=poses)
@bounded
def test_moving_one_object_moves_its_samples_and_no_other(
    objects: Any, index: int, pose: pc.Pose
) -> None:
    assume(index < len(objects))
    sampler = pc.Sampler()
    before = sampler.sample(pc.Scene(objects))
    changed = (*objects[:index], moved(objects[index], pose), *objects[index + 1 :])
    after = sampler.sample(pc.Scene(changed))
    mine = before.objects == index
    assert np.array_equal(after.objects, before.objects)
    assert np.array_equal(after.positions[~mine], before.positions[~mine])
    turn = Rotation.from_quat(pose.rotation).as_matrix()
    expected = before.positions[mine] @ turn.T + pose.position
    assert after.positions[mine] == pytest.approx(expected, abs=1e-12)


def counted() -> tuple[pc.SDF, Counter[str]]:
    """A ball that counts how often it is asked."""
    asked: Counter[str] = Counter()

    def distance(p: Any) -> Any:
        asked["distance"] += 1
        return np.linalg.norm(p, axis=1) - 0.03

    return pc.SDF(distance, (0.03, 0.03, 0.03)), asked


def test_a_moved_object_is_not_covered_again() -> None:
    shape, asked = counted()
    sampler = pc.Sampler()
    ball = pc.Volume(shape=shape, radiation_pressure=1.0)
    first = sampler.sample(pc.Scene((ball,)))
    before = asked["distance"]
    assert before > 0
    for x in (0.01, 0.02, 0.03):
        samples = sampler.sample(pc.Scene((replace(ball, pose=pc.Pose((x, 0, 0))),)))
        assert samples.positions == pytest.approx(first.positions + np.array([x, 0, 0]), abs=1e-15)
    changed = replace(ball, radiation_pressure=7.0, envelope=pc.Sine(200.0), name="ball")
    assert (sampler.sample(pc.Scene((changed,))).radiation_pressure == 7.0).all()
    assert asked["distance"] == before


def test_objects_of_one_shape_share_its_covering() -> None:
    shape, asked = counted()
    one = pc.Volume(shape=shape, radiation_pressure=1.0)
    pc.Sampler(budget=10_000).sample(pc.Scene((one,)))
    once = asked["distance"]
    asked.clear()
    many = tuple(
        pc.Volume(shape=shape, pose=pc.Pose((x, 0, 0)), radiation_pressure=1.0)
        for x in (0.0, 0.1, 0.2)
    )
    pc.Sampler(budget=10_000).sample(pc.Scene(many))
    assert asked["distance"] == once


def test_the_shell_and_the_interior_of_a_shape_are_covered_apart() -> None:
    shape = pc.Sphere(0.04)
    shell, inside = (
        pc.Volume(shape=shape, felt=felt, radiation_pressure=1.0) for felt in ("shell", "interior")
    )
    samples = pc.Sampler(budget=10_000).sample(pc.Scene((shell, inside)))
    r = np.linalg.norm(samples.positions, axis=1)
    assert r[samples.objects == 0].min() > 0.0399
    assert r[samples.objects == 1].min() < 0.02


def test_the_same_scene_gives_the_same_samples_object() -> None:
    sampler = pc.Sampler()
    scene, other = (pc.Scene((point(0.0), square(0.05))) for _ in range(2))
    samples = sampler.sample(scene)
    assert sampler.sample(scene) is samples
    assert sampler.sample(other) is not samples
    assert np.array_equal(sampler.sample(other).positions, samples.positions)


def test_an_empty_scene_has_no_samples() -> None:
    for workspace in (None, ROOM):
        samples = pc.Sampler().sample(pc.Scene((), workspace))
        assert len(samples) == samples.culled == samples.dropped == 0
        assert samples.positions.shape == samples.normals.shape == (0, 3)
        assert samples.radiation_pressure.shape == samples.objects.shape == (0,)
        assert samples.positions.dtype == samples.radiation_pressure.dtype == np.float64
        assert samples.objects.dtype.kind == "i"


def test_points_keep_a_sample_each_while_surfaces_are_covered_more_coarsely() -> None:
    scene = pc.Scene((square(0.2), *(point(0.01 * i) for i in range(50)), square(0.2)))
    samples = pc.Sampler(budget=100).sample(scene)
    counts = Counter(samples.objects.tolist())
    assert all(counts[i] == 1 for i in range(1, 51))
    assert samples.spacing > 0.0085
    assert samples.dropped == 0
    assert 20 < counts[0] + counts[51] <= 50


def test_the_spacing_is_as_asked_while_the_budget_suffices() -> None:
    samples = pc.Sampler(budget=36, spacing=0.01).sample(pc.Scene((square(0.06),)))
    assert len(samples) == 36
    assert samples.spacing == 0.01


@given(budget=st.integers(20, 1000))
@bounded
def test_most_of_the_budget_is_used(budget: int) -> None:
    scene = pc.Scene((pc.Surface(shape=pc.Disc(0.3), radiation_pressure=1.0),))
    samples = pc.Sampler(budget=budget).sample(scene)
    assert 0.65 * budget <= len(samples) <= budget  # the spacing's step is 2^(1/4)


@given(count=st.integers(1, 40), budget=st.integers(1, 40))
@bounded
def test_points_beyond_the_budget_are_dropped_last_first(count: int, budget: int) -> None:
    scene = pc.Scene(tuple(point(0.01 * i, float(i)) for i in range(count)))
    samples = pc.Sampler(budget=budget).sample(scene)
    assert samples.objects.tolist() == list(range(min(count, budget)))
    assert samples.radiation_pressure.tolist() == [float(i) for i in range(min(count, budget))]
    assert samples.dropped == max(0, count - budget)
    assert samples.spacing == 0.0085


def test_the_order_decides_who_is_dropped() -> None:
    line = tuple(point(0.01 * i) for i in range(10))
    ball = pc.Surface(shape=pc.Sphere(0.03), radiation_pressure=1.0)  # four samples at least
    first = pc.Sampler(budget=8).sample(pc.Scene((*line, ball)))
    last = pc.Sampler(budget=8).sample(pc.Scene((ball, *line)))
    assert first.objects.tolist() == list(range(8))
    assert last.objects.tolist() == [0, 0, 0, 0, 1, 2, 3, 4]
    assert first.dropped == last.dropped == 6


def test_the_workspace_culls_and_counts() -> None:
    scene = pc.Scene((point(0.05), point(0.5), point(-0.05), point(-0.5)))
    culled = replace(scene, workspace=pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3)))
    assert pc.Sampler().sample(scene).culled == 0
    samples = pc.Sampler().sample(culled)
    assert samples.objects.tolist() == [0, 2]
    assert samples.culled == 2
    assert samples.dropped == 0


def test_what_is_culled_takes_none_of_the_budget() -> None:
    far = square(0.2, pc.Pose((1.0, 0.0, 0.0)))
    near = square(0.08)
    alone = pc.Sampler(budget=100, spacing=0.008).sample(pc.Scene((near,), ROOM))
    both = pc.Sampler(budget=100, spacing=0.008).sample(pc.Scene((far, near), ROOM))
    assert np.array_equal(alone.positions, both.positions)
    assert both.culled == 1  # the whole object
    assert both.spacing == 0.008


def test_a_scene_outside_of_its_workspace_has_no_samples() -> None:
    far = pc.Pose((5.0, 0.0, 0.0))
    samples = pc.Sampler().sample(pc.Scene((square(0.05, far), point(3.0)), ROOM))
    assert len(samples) == 0
    assert samples.culled == 2  # each as a whole


def test_only_keeps_what_is_chosen_and_counts_the_rest() -> None:
    samples = pc.Sampler().sample(pc.Scene(tuple(point(0.01 * i) for i in range(5))))
    some = samples.only(np.array([True, False, True, False, False]))
    assert some.objects.tolist() == [0, 2]
    assert some.culled == 3
    assert len(samples) == 5
    assert some.only(np.zeros(2, dtype=bool)).culled == 5


def test_samples_are_values_that_cannot_be_set() -> None:
    samples = pc.Sampler().sample(pc.Scene((point(0.0),)))
    with pytest.raises(dataclasses.FrozenInstanceError):
        samples.positions = np.zeros((1, 3))  # type: ignore[misc]


def test_what_is_done_to_samples_does_not_reach_the_kept_coverings() -> None:
    sampler, scene = pc.Sampler(), pc.Scene((square(0.05),))
    samples = sampler.sample(scene)
    expected = samples.positions.copy()
    if samples.positions.flags.writeable:
        samples.positions[:] += 1.0
        samples.normals[:] += 1.0
    again = sampler.sample(pc.Scene(scene.objects))
    assert np.array_equal(again.positions, expected)
    assert (again.normals == [0.0, 0.0, 1.0]).all()


def test_whole_numbers_for_pressures_become_floats() -> None:
    whole = pc.Point(position=(0, 0, 0), radiation_pressure=5)
    assert pc.Sampler().sample(pc.Scene((whole,))).radiation_pressure.dtype == np.float64


def test_a_thousand_objects_are_sampled() -> None:
    shape = pc.Disc(0.02)
    scene = pc.Scene(
        tuple(
            pc.Surface(shape=shape, pose=pc.Pose((0.001 * i, 0, 0.2)), radiation_pressure=1.0)
            for i in range(1000)
        )
    )
    samples = pc.Sampler().sample(scene)
    assert len(samples) == 256
    assert samples.dropped == 744
    assert samples.objects.tolist() == list(range(256))
    rich = pc.Sampler(budget=20_000).sample(scene)
    assert len(rich) == 17_000
    assert rich.dropped == 0


def test_the_coverings_that_are_kept_are_bounded() -> None:
    sampler = pc.Sampler(budget=100_000)
    for start in range(0, 2 * KEPT, 128):
        shapes = [pc.Disc(0.001 + 1e-6 * i) for i in range(start, start + 128)]
        sampler.sample(pc.Scene(tuple(pc.Surface(shape=s, radiation_pressure=1.0) for s in shapes)))
        assert len(sampler._covers) <= KEPT
    assert len(sampler._covers) == KEPT


def test_a_covering_is_never_taken_for_that_of_a_shape_that_is_gone() -> None:
    sampler = pc.Sampler()
    for i in range(2000):  # ids of shapes that are gone come up again
        radius = 0.005 + 1e-5 * (i % 700)
        ball = pc.Surface(shape=pc.Sphere(radius), radiation_pressure=1.0)
        positions = sampler.sample(pc.Scene((ball,))).positions
        assert np.linalg.norm(positions[0]) == pytest.approx(radius)


@pytest.mark.parametrize("bad", [0, -1, 2.5, True, math.nan, math.inf, "many", None])
def test_a_bad_budget_is_refused(bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`budget` "):
        pc.Sampler(budget=bad)


@pytest.mark.parametrize("bad", [0.0, -0.01, math.nan, math.inf, 20.0, "wide", None])
def test_a_bad_spacing_is_refused(bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`spacing` "):
        pc.Sampler(spacing=bad)


@pytest.mark.parametrize(
    "big",
    [
        pc.Volume(shape=pc.Box((3.0, 3.0, 3.0)), felt="interior", radiation_pressure=1.0),
        pc.Volume(
            shape=pc.SDF(lambda p: np.linalg.norm(p, axis=1) - 0.5, (0.5, 0.5, 0.5)),
            radiation_pressure=1.0,
        ),
    ],
    ids=["interior", "SDF"],
)
def test_a_big_volume_is_sampled_more_coarsely(big: pc.Volume) -> None:
    assert 0 < len(pc.Sampler().sample(pc.Scene((big,)))) <= 256


def test_a_spacing_too_fine_for_memory_is_refused_or_coarsened() -> None:
    disc = pc.Surface(shape=pc.Disc(0.1), radiation_pressure=1.0)
    try:
        samples = pc.Sampler(spacing=1e-9).sample(pc.Scene((disc,)))
    except pc.ArgumentError:
        return
    assert 0 < len(samples) <= 256


def test_many_shapes_of_their_own_are_not_covered_again(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: Counter[str] = Counter()
    cover = pc.Sphere.cover

    def counting(self: pc.Sphere, spacing: float) -> Any:
        asked["cover"] += 1
        return cover(self, spacing)

    monkeypatch.setattr(pc.Sphere, "cover", counting)
    balls = tuple(
        pc.Surface(shape=pc.Sphere(0.01 + 1e-4 * i), radiation_pressure=1.0) for i in range(100)
    )
    sampler = pc.Sampler()
    sampler.sample(pc.Scene(balls))
    asked.clear()
    sampler.sample(pc.Scene(balls[::-1]))
    assert asked["cover"] == 0
