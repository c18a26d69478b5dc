from __future__ import annotations

import dataclasses
from collections import Counter
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.modulation.technique import STM
from pacinian.scene.motion import Motion
from pacinian.scene.objects import Particles, Path
from pacinian.scene.sampling.sample_cache import MAX_ENTRIES, SampleCache
from pacinian.scene.sampling.sample_sources import SinglePoint, WholeObject
from pacinian.scene.sampling.sampler import SamplingMode
from pacinian.scene.sampling.spacing import REGION_SPACING
from pacinian.scene.shapes.curves import Circle, Line

from ..tools import moved, random_pose

bounded = settings(max_examples=40)
lengths = st.floats(0.002, 0.12)
coordinates = st.floats(-0.3, 0.3)
positions = st.tuples(coordinates, coordinates, coordinates)
poses = st.builds(
    lambda position, seed: pc.Pose(position, random_pose(seed).rotation),
    positions,
    st.integers(0, 2**31),
)
strengths = st.floats(0.01, 1000.0)
points = st.builds(pc.Point, position=positions, radiation_pressure=strengths)
surfaces = st.builds(
    pc.Surface,
    shape=st.one_of(
        st.builds(pc.Rectangle, lengths, lengths),
        st.builds(pc.Disc, lengths),
        st.builds(pc.Sphere, lengths),
    ),
    pose=poses,
    radiation_pressure=strengths,
)
volumes = st.builds(
    pc.Volume,
    shape=st.one_of(
        st.builds(pc.Sphere, lengths),
        st.builds(lambda x, y, z: pc.Box((x, y, z)), lengths, lengths, lengths),
        st.builds(pc.Capsule, lengths, lengths),
    ),
    felt=st.sampled_from(("shell", "interior")),
    pose=poses,
    radiation_pressure=strengths,
)
paths = st.builds(
    Path,
    shape=st.one_of(st.builds(Line, lengths), st.builds(Circle, lengths)),
    pose=poses,
    radiation_pressure=strengths,
)
particles = st.builds(
    Particles,
    positions=st.lists(positions, max_size=5).map(tuple),
    pose=poses,
    radiation_pressure=strengths,
)


def apart(objects: Any) -> Any:
    """Return objects of different groups, so that none are merged."""
    return tuple(replace(item, envelope=pc.Sine(1.0 + i)) for i, item in enumerate(objects))


objects = st.lists(st.one_of(points, surfaces, volumes, paths, particles), max_size=12).map(apart)
ROOM = pc.Workspace((-0.15, -0.15, -0.15), (0.15, 0.15, 0.15))


def point(x: float, pressure: float = 1.0) -> pc.Point:
    return pc.Point(position=(x, 0.0, 0.2), radiation_pressure=pressure)


def square(width: float, pose: pc.Pose | None = None, pressure: float = 1.0) -> pc.Surface:
    shape = pc.Rectangle(width, width)
    return pc.Surface(shape=shape, pose=pose or pc.Pose(), radiation_pressure=pressure)


def sampled(objects: Any, room: Any = None, **how: Any) -> tuple[Any, Counter[str]]:
    """Return samples and the counts of what was left out."""
    sampler = pc.Sampler(**how)
    return sampler.sample(pc.Scene(tuple(objects), room)), sampler.skipped


def spacing(samples: Any, index: int = 0) -> float:
    """Return the smallest distance between samples of one object [m]."""
    q = samples.positions[samples.objects == index]
    d = np.linalg.norm(q[:, None] - q, axis=2)
    return float(d[d > 0.0].min())


@given(objects=objects, budget=st.integers(1, 300), room=st.sampled_from((None, ROOM)))
@bounded
def test_the_budget_is_never_exceeded(objects: Any, budget: int, room: Any) -> None:
    samples, skipped = sampled(objects, room, budget=budget)
    assert len(samples) <= budget
    assert all(count >= 0 for count in skipped.values())


@given(objects=objects, budget=st.integers(1, 300), room=st.sampled_from((None, ROOM)))
@bounded
def test_every_sample_belongs_to_its_object(objects: Any, budget: int, room: Any) -> None:
    samples, _ = sampled(objects, room, budget=budget)
    M = len(samples)
    assert samples.positions.shape == samples.normals.shape == (M, 3)
    for each in (samples.radiation_pressure, samples.area, samples.objects, samples.keys):
        assert each.shape == (M,)
    assert (np.diff(samples.objects) >= 0).all()
    assert len(set(samples.keys.tolist())) == M
    assert samples.items == objects
    assert samples.capsules is None
    for i, item in enumerate(objects):
        mine = samples.objects == i
        assert (samples.radiation_pressure[mine] == item.pressure).all()
        assert (samples.most[mine] == item.pressure).all()
        lengths = np.linalg.norm(samples.normals[mine], axis=1)
        if isinstance(item, (pc.Point, Path, Particles)):
            assert (lengths == 0.0).all()
        elif getattr(item, "felt", "shell") == "shell":
            assert lengths == pytest.approx(np.ones(mine.sum()))
        away = np.linalg.norm(samples.positions[mine] - item.pose.position, axis=1)
        assert (away <= item.bounding_radius + 1e-9).all()


def is_ball(item: Any) -> bool:
    """Return whether an object is a plain ball, whose samples do not turn with it."""
    return isinstance(getattr(item, "shape", None), pc.Sphere) and item.texture is None


@given(objects=objects, room=st.sampled_from((None, ROOM)))
@bounded
def test_within_the_budget_all_of_an_object_is_covered(objects: Any, room: Any) -> None:
    samples, _ = sampled(objects, room, budget=100_000, spacing=0.0085)
    covers = [(item, item.sample_surface(0.0085)) for item in objects]
    whole = [
        (pc.Pose(item.pose.position) if is_ball(item) else item.pose).points(cover.points)
        for item, cover in covers
    ]
    area = np.concatenate([np.empty(0), *(cover.area for _, cover in covers)])
    everything = np.concatenate([np.empty((0, 3)), *whole])
    if room is not None:
        inside = room.holds(everything)
        everything, area = everything[inside], area[inside]
    assert samples.positions == pytest.approx(everything, abs=1e-12)
    assert samples.area == pytest.approx(area)


@given(objects=objects, pose=poses)
@bounded
def test_sampling_follows_a_rigid_motion_of_everything(objects: Any, pose: pc.Pose) -> None:
    here, _ = sampled(objects)
    there, _ = sampled(moved(item, pose) for item in objects)
    turned = Rotation.from_quat(pose.rotation).as_matrix()
    rolls = np.isin(here.objects, [i for i, item in enumerate(objects) if is_ball(item)])
    for from_, to, there_ in (
        (here.positions, here.positions @ turned.T + pose.position, there.positions),
        (here.normals, here.normals @ turned.T, there.normals),
    ):
        assert there_[~rolls] == pytest.approx(to[~rolls], abs=1e-12)
        for i in set(here.objects[rolls].tolist()):
            own = here.objects == i
            way = there_[own] - from_[own]
            assert way == pytest.approx(np.broadcast_to(way[0], way.shape), abs=1e-12)
    for name in ("objects", "keys", "area", "radiation_pressure"):
        assert np.array_equal(getattr(there, name), getattr(here, name))


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
    assert np.array_equal(after.keys, before.keys)
    assert np.array_equal(after.positions[~mine], before.positions[~mine])
    turn = Rotation.from_quat(pose.rotation).as_matrix()
    expected = before.positions[mine] @ turn.T + pose.position
    if is_ball(objects[index]):
        at = changed[index].pose.position
        expected = before.positions[mine] - objects[index].pose.position + at
    assert after.positions[mine] == pytest.approx(expected, abs=1e-12)


@given(objects=objects, seed=st.integers(0, 2**31))
@bounded
def test_samples_of_named_objects_keep_their_keys_in_any_order(objects: Any, seed: int) -> None:
    named = [replace(item, name=f"{i}") for i, item in enumerate(objects)]
    sampler = pc.Sampler(budget=100_000)
    before = sampler.sample(pc.Scene(tuple(named)))
    order = np.random.default_rng(seed).permutation(len(named))
    after = sampler.sample(pc.Scene(tuple(named[i] for i in order)))
    assert sorted(after.keys.tolist()) == sorted(before.keys.tolist())
    place = dict(zip(before.keys.tolist(), before.positions, strict=True))
    for key, at in zip(after.keys.tolist(), after.positions, strict=True):
        assert np.array_equal(place[key], at)


def counted() -> tuple[pc.SDF, Counter[str]]:
    """Return a ball that counts its calls."""
    asked: Counter[str] = Counter()

    def distance(p: Any) -> Any:
        asked["distance"] += 1
        return np.linalg.norm(p, axis=1) - 0.03

    ball = pc.SDF(distance, (0.03, 0.03, 0.03))
    assert ball.area > 0.0  # measured once
    asked.clear()
    return ball, asked


def test_a_moved_object_is_not_covered_again_and_others_of_its_shape_are_not_at_all() -> None:
    shape, asked = counted()
    sampler = pc.Sampler(budget=10_000)
    ball = pc.Volume(shape=shape, radiation_pressure=1.0)
    first = sampler.sample(pc.Scene((ball,)))
    before = asked["distance"]
    assert before > 0
    for x in (0.01, 0.02, 0.03):
        samples = sampler.sample(pc.Scene((replace(ball, pose=pc.Pose((x, 0, 0))),)))
        assert samples.positions == pytest.approx(first.positions + np.array([x, 0, 0]), abs=1e-15)
    changed = replace(ball, radiation_pressure=7.0, envelope=pc.Sine(200.0), name="ball")
    assert (sampler.sample(pc.Scene((changed,))).radiation_pressure == 7.0).all()
    many = [replace(ball, pose=pc.Pose((x, 0, 0))) for x in (0.0, 0.1, 0.2)]
    assert len(sampler.sample(pc.Scene(tuple(many)))) == 3 * len(first)
    assert asked["distance"] == before


def test_the_shell_and_the_interior_of_a_shape_are_covered_apart() -> None:
    shape = pc.Sphere(0.04)
    shell, inside = (
        pc.Volume(shape=shape, felt=felt, radiation_pressure=1.0) for felt in ("shell", "interior")
    )
    samples = pc.Sampler(budget=10_000).sample(pc.Scene((shell, inside)))
    r = np.linalg.norm(samples.positions, axis=1)
    assert r[samples.objects == 0].min() > 0.0399
    assert r[samples.objects == 1].min() < 0.02


def test_one_key_is_one_place_on_an_object_however_finely_it_is_covered() -> None:
    places: dict[int, Any] = {}
    sampler = pc.Sampler(budget=2000)
    sampler.prepare(pc.autd(), pc.Air())
    plate = replace(square(0.1), name="plate")
    for allowed in (2000, 100, 30):
        sampler.allowed = allowed
        for z in np.linspace(0.1, 1.0, 19).tolist():
            there = replace(plate, pose=pc.Pose((0.0, 0.0, z)))
            samples = sampler.sample(pc.Scene((there,)))
            for key, at in zip(samples.keys.tolist(), samples.positions - [0, 0, z], strict=True):
                assert places.setdefault(key, at) == pytest.approx(at, abs=1e-12)


def test_the_same_scene_gives_the_same_samples_object() -> None:
    sampler = pc.Sampler()
    scene, other = (pc.Scene((point(0.0), square(0.05))) for _ in range(2))
    samples = sampler.sample(scene)
    assert sampler.sample(scene) is samples
    assert sampler.sample(scene, 1.0) is samples
    assert sampler.sample(other) is not samples
    assert np.array_equal(sampler.sample(other).positions, samples.positions)


def test_a_moving_object_is_sampled_anew_until_it_stands_still() -> None:
    moving = replace(square(0.05), motion=Motion((1.0, 0.0, 0.0), time=0.0))
    sampler, scene = pc.Sampler(), pc.Scene((moving,))
    for t in (0.0, 0.03, 0.08):
        assert sampler.sample(scene, t).positions[:, 0].mean() == pytest.approx(t)
    last = sampler.sample(scene, 0.2)
    assert last.positions[:, 0].mean() == pytest.approx(0.1)
    assert sampler.sample(scene, 0.3) is last


def test_an_object_that_is_updated_arrives_where_it_is() -> None:
    sampler = pc.Sampler()
    item = replace(square(0.05), name="plate", motion=Motion())
    sampler.sample(pc.Scene((item,)), 0.0)
    item = replace(item, pose=pc.Pose((0.01, 0.0, 0.0)), motion=Motion(time=1.0))
    scene = pc.Scene((item,))
    x = [sampler.sample(scene, 1.0 + 0.001 * i).positions[:, 0].mean() for i in range(15)]
    assert x[0] == pytest.approx(0.0)  # without a jump
    assert np.diff(x).max() < 0.0011
    assert x[-1] == pytest.approx(0.01)


def test_an_empty_scene_has_no_samples() -> None:
    samples, _ = sampled((), ROOM)
    assert len(samples) == samples.force == 0
    assert samples.positions.shape == samples.normals.shape == (0, 3)
    assert samples.radiation_pressure.shape == samples.objects.shape == (0,)
    assert samples.positions.dtype == samples.radiation_pressure.dtype == np.float64
    assert samples.objects.dtype.kind == samples.keys.dtype.kind == "i"


def test_what_does_not_press_gives_no_samples() -> None:
    silent = replace(square(0.05), envelope=pc.Constant(0.0))
    samples, _ = sampled((square(0.05, pressure=0.0), silent, point(0.0, 0.0)))
    assert len(samples) == 0


def test_points_keep_a_sample_each_while_surfaces_are_covered_more_coarsely() -> None:
    line = [point(0.01 * i) for i in range(50)]
    samples, skipped = sampled((square(0.2), *line, square(0.2)), budget=100)
    counts = Counter(samples.objects.tolist())
    assert all(counts[i] == 1 for i in range(1, 51))
    assert spacing(samples) > 0.0085
    assert not skipped["samples over budget"]
    assert 10 < counts[0] + counts[51] <= 50


def test_the_spacing_is_as_asked_while_the_budget_suffices() -> None:
    samples, _ = sampled((square(0.06),), budget=49, spacing=0.01)
    assert len(samples) == 49
    assert spacing(samples) == pytest.approx(0.01)


def test_a_regions_spacing_follows_what_the_array_resolves_and_the_wavelength() -> None:
    seen = []
    for z in (0.1, 0.3, 0.6, 1.2):
        sampler = pc.Sampler(budget=100_000)
        sampler.prepare(pc.autd(), pc.Air())
        samples = sampler.sample(pc.Scene((square(0.12, pc.Pose((0.0, 0.0, z))),)))
        seen.append(spacing(samples))
    assert seen == sorted(seen)
    assert seen[0] == pytest.approx(REGION_SPACING * 0.0085, rel=0.05)
    assert seen[-1] > REGION_SPACING * 0.02


def test_on_a_transducer_the_spacing_is_that_of_a_wavelength() -> None:
    array = pc.lattice(0.2, 0.2, 0.02)
    x, y, z = array.positions[0]
    sampler = pc.Sampler(budget=2000)
    sampler.prepare(array.transform(pc.Pose((0.01 - x, 0.01 - y, 0.01 - z))), pc.Air())
    plate = square(0.1, pc.Pose((0.012, 0.012, 0.012)))
    assert spacing(sampler.sample(pc.Scene((plate,)))) == pytest.approx(
        REGION_SPACING * 0.0085, rel=0.1
    )


def test_a_single_transducer_resolves_nothing() -> None:
    sampler = pc.Sampler()
    sampler.prepare(pc.Array(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])), pc.Air())
    for z in (0.05, 0.2, 5.0):
        samples = sampler.sample(pc.Scene((square(0.2, pc.Pose((0.0, 0.0, z))),)))
        assert len(samples) == 1


@given(budget=st.integers(20, 1000))
@bounded
def test_most_of_the_budget_is_used(budget: int) -> None:
    disc = pc.Surface(shape=pc.Disc(0.3), radiation_pressure=1.0)
    samples, _ = sampled((disc,), budget=budget)
    assert 0.45 * budget <= len(samples) <= budget  # the spacing's step is 2^(1/2)


@pytest.mark.parametrize(
    ("radius", "count", "frame"), [(0.02, 320, 640), (0.03, 320, 640), (0.04, 640, 640)]
)
def test_one_object_in_free_air_may_have_twice_the_budget(
    radius: float, count: int, frame: int
) -> None:
    """If its field can be steered, and nothing else is in the scene."""
    ball = pc.Volume(shape=pc.Sphere(radius), radiation_pressure=1.0, pose=pc.Pose((0, 0, 0.175)))
    other = point(0.1, 1.0)
    sampler = pc.Sampler()
    sampler.prepare(pc.autd(3, 3), pc.Air())
    sampler.mode = SamplingMode(steers=True, bands=2)
    samples = sampler.sample(pc.Scene((ball,)))
    assert 0.4 * count < len(samples) <= count
    assert sampler.frame_budget == frame
    for changed in ("other", "steers", "strict", "technique"):
        sampler.reset()
        sampler.mode = SamplingMode(bands=2, steers=changed != "steers", strict=changed == "strict")
        lm = pc.LM(100.0, 0.001) if changed == "technique" else ball.technique
        items = (replace(ball, technique=lm), *((other,) if changed == "other" else ()))
        try:
            sampler.sample(pc.Scene(items))
        except pc.ArgumentError:
            assert changed == "strict"
        assert sampler.frame_budget == sampler.budget


@given(count=st.integers(1, 40), budget=st.integers(1, 40))
@bounded
def test_points_beyond_the_budget_are_dropped_last_first(count: int, budget: int) -> None:
    line = tuple(point(0.01 * i, float(i + 1)) for i in range(count))
    samples, skipped = sampled(line, budget=budget)
    assert samples.objects.tolist() == list(range(min(count, budget)))
    assert samples.radiation_pressure.tolist() == [i + 1.0 for i in range(min(count, budget))]
    assert skipped["samples over budget"] == max(0, count - budget)


def test_the_order_decides_who_is_dropped_and_before_it_the_priority() -> None:
    line = tuple(point(0.01 * i) for i in range(10))
    ball = pc.Surface(shape=pc.Sphere(0.03), radiation_pressure=1.0)
    first, dropped = sampled((*line, ball), budget=8)
    assert set(first.objects.tolist()) == set(range(8))
    assert dropped["samples over budget"] > 0
    last, _ = sampled((ball, *line), budget=8)
    assert 0 in last.objects
    urgent, _ = sampled((*line, replace(ball, priority=1)), budget=8)
    assert 10 in urgent.objects
    urgent, _ = sampled((ball, *line[:5], replace(line[5], priority=1)), budget=8)
    assert urgent.objects[0] == 6


def test_fewer_are_made_while_fewer_are_allowed_but_of_a_region() -> None:
    places = tuple((0.01 * i, 0.01 * j, 0.0) for i in range(12) for j in range(12))
    points = pc.Particles(positions=places, radiation_pressure=1.0)
    sampler, scene = pc.Sampler(), pc.Scene((points,))
    assert len(sampler.sample(scene)) == 144
    sampler.allowed = 20
    assert len(sampler.sample(scene)) <= 20
    sampler.allowed = 256
    for _ in range(5):
        samples = sampler.sample(pc.Scene(scene.objects))
    assert len(samples) > 100
    other = pc.Sampler()
    other.allowed = 20
    assert len(other.sample(pc.Scene((square(0.03),)))) > 100


def test_the_workspace_cuts_and_counts() -> None:
    scene = pc.Scene((point(0.05), point(0.5), point(-0.05), point(-0.5)))
    assert len(pc.Sampler().sample(scene)) == 4
    room = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    samples, skipped = sampled(scene.objects, room)
    assert samples.objects.tolist() == [0, 2]
    assert skipped["objects outside the workspace"] == 2
    assert not skipped["samples over budget"]


def test_what_is_outside_takes_none_of_the_budget() -> None:
    far = square(0.2, pc.Pose((1.0, 0.0, 0.0)))
    near = square(0.08)
    alone, _ = sampled((near,), ROOM, budget=121, spacing=0.008)
    both, skipped = sampled((far, near), ROOM, budget=121, spacing=0.008)
    assert np.array_equal(alone.positions, both.positions)
    assert skipped["objects outside the workspace"] == 1
    assert spacing(both, 1) == pytest.approx(0.008)


def test_what_is_too_far_from_the_array_is_out_of_reach() -> None:
    sampler = pc.Sampler()
    sampler.prepare(pc.autd(), pc.Air())
    samples = sampler.sample(pc.Scene((point(0.0), point(100.0))))
    assert samples.objects.tolist() == [0]
    assert sampler.skipped["objects away from hands"] == 1


def test_objects_of_one_group_that_meet_are_merged() -> None:
    three = point(0.0, 2.0), point(0.002, 4.0), point(0.05, 1.0)
    samples, skipped = sampled(three)
    assert samples.objects.tolist() == [0, 2]
    assert samples.radiation_pressure == pytest.approx([3.0, 1.0])
    assert samples.force == pytest.approx(sum(p.pressure * p.area for p in three))
    assert skipped["samples merged"] == 1
    for other in ({"envelope": pc.Sine(50.0)}, {"technique": STM(50.0)}):
        kept, _ = sampled((three[0], replace(three[1], **other), three[2]))
        assert len(kept) == 3


def test_only_keeps_what_is_chosen() -> None:
    samples, _ = sampled(point(0.01 * i, 1.0 + i) for i in range(5))
    some = samples.only(np.array([True, False, True, False, False]))
    assert some.objects.tolist() == [0, 2]
    assert some.radiation_pressure.tolist() == [1.0, 3.0]
    assert len(samples) == 5
    assert len(some.only(np.zeros(2, dtype=bool))) == 0
    assert samples.only(np.array([3, 1])).objects.tolist() == [3, 1]


def test_forgotten_it_begins_anew() -> None:
    sampler, scene = pc.Sampler(ramp=0.01), pc.Scene((point(0.0),))
    for t in (0.0, 0.01, 0.02):
        sampler.sample(scene, t)
    assert sampler.sample(scene, 0.03).radiation_pressure.tolist() == [1.0]
    sampler.reset()
    assert sampler.sample(scene, 0.04).radiation_pressure.tolist() == [0.0]


@pytest.mark.parametrize("times", [[5.0] * 20, [0.001 * -i for i in range(20)], [1e9, -1e9, 0.0]])
def test_whatever_time_does_there_are_samples_of_at_most_what_was_asked(times: Any) -> None:
    sampler = pc.Sampler(ramp=0.005)
    moving = replace(square(0.05), motion=Motion((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.05), name="a")
    scene = pc.Scene((moving, point(0.0)))
    for t in times:
        samples = sampler.sample(scene, t)
        assert np.isfinite(samples.positions).all()
        assert (samples.radiation_pressure >= 0.0).all()
        assert (samples.radiation_pressure <= samples.most).all()


def test_what_is_done_to_samples_does_not_reach_the_kept_coverings() -> None:
    sampler, scene = pc.Sampler(), pc.Scene((square(0.05),))
    samples = sampler.sample(scene)
    with pytest.raises(dataclasses.FrozenInstanceError):
        samples.positions = np.zeros((1, 3))  # type: ignore[misc]
    expected = samples.positions.copy()
    for values in (samples.positions, samples.normals, samples.area):
        if values.flags.writeable:
            values[:] += 1.0
    again = sampler.sample(pc.Scene(scene.objects))
    assert np.array_equal(again.positions, expected)
    assert (again.normals == [0.0, 0.0, 1.0]).all()
    assert again.force == pytest.approx(0.05 * 0.05)


def test_a_thousand_objects_are_sampled() -> None:
    shape = pc.Disc(0.02)
    scene = pc.Scene(
        tuple(
            pc.Surface(shape=shape, pose=pc.Pose((0.05 * i, 0, 0.2)), radiation_pressure=1.0)
            for i in range(1000)
        )
    )
    samples = pc.Sampler().sample(scene)
    assert len(samples) == 320
    assert samples.objects.tolist() == list(range(320))
    each = len(shape.sample_surface(REGION_SPACING * 0.0085).points)
    rich = pc.Sampler(budget=1000 * each).sample(scene)
    assert len(rich) == 1000 * each


def test_the_coverings_that_are_kept_are_bounded() -> None:
    sampler = pc.Sampler(budget=100_000)
    for start in range(0, 2 * MAX_ENTRIES, 128):
        shapes = [pc.Disc(0.001 + 1e-6 * i) for i in range(start, start + 128)]
        sampler.sample(pc.Scene(tuple(pc.Surface(shape=s, radiation_pressure=1.0) for s in shapes)))
        assert len(sampler._covers._samples) <= MAX_ENTRIES
    assert len(sampler._covers._samples) == MAX_ENTRIES


def test_a_covering_is_never_taken_for_that_of_a_shape_that_is_gone() -> None:
    sampler = pc.Sampler()
    for i in range(2000):  # `id` values of deleted shapes are used again
        radius = 0.005 + 1e-5 * (i % 700)
        ball = pc.Surface(shape=pc.Sphere(radius), radiation_pressure=1.0)
        positions = sampler.sample(pc.Scene((ball,))).positions
        assert np.linalg.norm(positions[0]) == pytest.approx(radius)


@pytest.mark.parametrize(
    ("argument", "bad"), [("budget", 0), ("budget", 2.5), ("spacing", 1e-9), ("spacing", 20.0)]
)
def test_a_bad_argument_is_refused_by_name(argument: str, bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
        pc.Sampler(**{argument: bad})


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


def test_many_shapes_of_their_own_are_not_covered_again(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: Counter[str] = Counter()
    cover = pc.Sphere.sample_surface

    def counting(self: pc.Sphere, spacing: float) -> Any:
        asked["cover"] += 1
        return cover(self, spacing)

    monkeypatch.setattr(pc.Sphere, "sample_surface", counting)
    balls = tuple(
        pc.Surface(shape=pc.Sphere(0.01 + 1e-4 * i), radiation_pressure=1.0) for i in range(100)
    )
    sampler = pc.Sampler()
    sampler.sample(pc.Scene(balls))
    asked.clear()
    sampler.sample(pc.Scene(balls[::-1]))
    assert asked["cover"] == 0


@bounded
@given(points, poses.map(lambda pose: pose.position), st.integers(0, 1000), st.integers(0, 2**31))
def test_a_lone_point_is_as_any_object_rendered_whole(
    point: pc.Point, at: tuple[float, float, float], index: int, name: int
) -> None:
    asked = point, index, name, pc.Pose(at), SampleCache(), (point,)
    quick, slow = SinglePoint(*asked).at(0.01), WholeObject(*asked).at(0.01)
    for field in dataclasses.fields(slow):
        mine, other = getattr(quick, field.name), getattr(slow, field.name)
        np.testing.assert_array_equal(mine, other)
        assert getattr(mine, "dtype", None) == getattr(other, "dtype", None)


@pytest.mark.parametrize("x", [-0.11, -0.1, 0.1, 0.11])
def test_one_point_is_cut_as_many_are(x: float) -> None:
    room = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    one = pc.Point(position=(x, 0.0, 0.2), radiation_pressure=5.0)
    pair = Particles(positions=((0.0, 0.0, 0.2), (x, 0.0, 0.2)), radiation_pressure=5.0)
    alone, both = (len(pc.Sampler(ramp=0.0).sample(pc.Scene((i,), room))) for i in (one, pair))
    assert alone == both - 1 == (abs(x) <= 0.1)
