"""Hands in contact with objects: which samples there are, where, and how strong."""

from __future__ import annotations

import functools
import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy import integrate
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.hands.hand import Hand
from pacinian.scene.material import FULL_PRESSURE_DEPTH, Material
from pacinian.scene.modulation.technique import STM
from pacinian.scene.motion import Motion
from pacinian.scene.objects import Particles, Path
from pacinian.scene.sampling.array_resolution import ArrayResolution, weigh_incidence
from pacinian.scene.sampling.hand_tracking import HOLD_TIME, LOST_HAND_FADE_TIME
from pacinian.scene.sampling.posed_skin import PosedSkin
from pacinian.scene.sampling.sampler import SamplingMode
from pacinian.scene.shapes.csg import Difference, Intersection, Placed, Union
from pacinian.scene.shapes.curves import Circle
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.texture import grating
from pacinian.scene.shapes.voxels import Voxels

from ..tools import moved, random_pose, to_capsules

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples

few = settings(max_examples=12)
seeds = st.integers(0, 2**31)
FINEST = 0.00175  # spacing of nodes at the finest level of a skin [m]
APART = 0.03  # largest distance between neighbouring samples of a contact [m]
HAND = Hand.open("right", pc.Pose((0.0, 0.0, 0.2)))


def bent(seed: int, side: Any = "right") -> Hand:
    """Return a hand whose finger joints are bent about x by up to 50 degrees, by SciPy's rotations."""
    rng = np.random.default_rng(seed)
    open_ = Hand.open(side)
    assert open_.joints is not None
    joints = open_.joints.copy()
    for first, last in ((2, 6), (6, 11), (11, 16), (16, 21), (21, 26)):
        for i in range(first + 1, last - 1):
            turn = Rotation.from_rotvec([-rng.uniform(0.0, 0.9), 0.0, 0.0])
            joints[i + 1 : last] = turn.apply(joints[i + 1 : last] - joints[i]) + joints[i]
    return Hand(joints, side=side).transform(pc.Pose((0.0, 0.0, 0.2)))


def ball(radius: float = 0.03, at: Any = (0.0, 0.0, 0.17), **how: Any) -> pc.Volume:
    how = {"radiation_pressure": 10.0} | how
    return pc.Volume(shape=pc.Sphere(radius), pose=pc.Pose(tuple(at)), **how)


def plate(z: float, size: float = 0.4, **how: Any) -> pc.Surface:
    """Return a plate that presses upwards."""
    how = {"radiation_pressure": 10.0} | how
    pose = pc.Pose((0.0, 0.0, z))
    return pc.Surface(shape=pc.Rectangle(size, size), pose=pose, **how)


OBJECTS = {
    "ball": ball(),
    "interior": ball(0.06, felt="interior"),
    "plate": plate(0.19),
    "grating": plate(0.192, texture=grating(0.02)),
    "soft": ball(material=Material(stiffness=500.0, reach=0.004)),
    "point": pc.Point(position=(0.0, 0.0, 0.188), radiation_pressure=10.0),
    "path": Path(shape=Circle(0.02), pose=pc.Pose((0.0, 0.0, 0.189)), radiation_pressure=10.0),
    "particles": Particles(
        positions=((0.0, 0.0, 0.188), (0.02, 0.04, 0.19), (0.0, 0.0, 0.1)), radiation_pressure=10.0
    ),
}
each_object = pytest.mark.parametrize("item", OBJECTS.values(), ids=OBJECTS.keys())


def touched(*objects: Any, hands: Any = (HAND,), **how: Any) -> Samples:
    """Return all samples, without thresholds of perception."""
    sampler = pc.Sampler(**({"budget": 20_000, "spacing": FINEST, "perception": False} | how))
    return sampler.sample(pc.Scene(tuple(objects), hands=tuple(hands)))


@functools.lru_cache(maxsize=4)
def dense(hand: Hand, step: float = 1e-3) -> tuple[Any, Any]:
    """Return dense points on a hand's skin and their areas, by an independent grid on each capsule."""
    capsules = PosedSkin(hand).capsules
    points, areas, counts = [np.empty((0, 3))], [np.empty(0)], list[int]()
    for capsule in capsules:
        begin = len(areas)
        a, b, first, last = capsule[:3], capsule[3:6], capsule[6], capsule[7]
        length, r = float(np.linalg.norm(b - a)), max(first, last)
        lean = (first - last) / length
        flat = np.sqrt(1.0 - lean * lean)
        z = (b - a) / length
        x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
        x /= np.linalg.norm(x)
        y = np.cross(z, x)
        n = max(8, round(2.0 * np.pi * r / step))
        phi = 2.0 * np.pi * (np.arange(n) + 0.5) / n
        ring = np.cos(phi)[:, None] * x + np.sin(phi)[:, None] * y
        k = max(1, round(length / step))
        for s in (np.arange(k) + 0.5) / k:
            here = first + s * (last - first)
            points.append(a + s * (b - a) + here * (flat * ring + lean * z))
            areas.append(np.full(n, 2.0 * np.pi * here * flat * flat * length / k / n))
        m = max(4, round(0.5 * np.pi * r / step))
        for end, up, radius, low in ((a, -z, first, -lean), (b, z, last, lean)):
            for h in low + (1.0 - low) * (np.arange(m) + 0.5) / m:  # equal areas of a sphere
                points.append(end + radius * (np.sqrt(1.0 - h * h) * ring + h * up))
                areas.append(np.full(n, 2.0 * np.pi * radius**2 * (1.0 - low) / m / n))
        counts.append(sum(map(len, areas[begin:])))
    q, area = np.concatenate(points), np.concatenate(areas)
    away = to_capsules(capsules, q)
    before = np.arange(len(capsules)) < np.repeat(np.arange(len(capsules)), counts)[:, None]
    free = (away > np.where(before, 1e-9, -1e-9)).all(
        axis=1
    )  # a sphere that two bones share counts once
    return q[free], area[free]


# ------------------------------------------------------------------------------- where it is felt


@each_object
@pytest.mark.parametrize(
    ("hand", "spacing"),
    [
        (Hand.open("left", pc.Pose((0.0, 0.0, 0.2))), FINEST),
        (bent(1, "left"), 0.02),
        (bent(1), FINEST),
    ],
    ids=["open left", "bent left", "bent right"],
)
def test_samples_lie_on_the_skin_with_its_normals(item: Any, hand: Hand, spacing: float) -> None:
    samples = touched(item, hands=(hand,), spacing=spacing)
    assert len(samples)
    assert (samples.most == item.pressure).all()
    assert (samples.radiation_pressure > 0.0).all()
    # at coarser levels, a node at a bent joint stands for more skin than its own area
    if spacing == FINEST:
        assert (samples.radiation_pressure <= samples.most * (1.0 + 1e-9)).all()
    capsules = PosedSkin(hand).capsules
    d = to_capsules(capsules, samples.positions)
    nearest = np.abs(d).min(axis=1)
    assert nearest.max() < 1e-9
    assert d.min() > -6e-4  # in creases, points up to 0.5 mm inside another capsule are still skin
    h = 1e-6
    own = np.abs(d).argmin(axis=1)
    out = to_capsules(capsules, samples.positions + h * samples.normals)
    assert out[np.arange(len(own)), own] == pytest.approx(h, rel=1e-3)
    assert np.linalg.norm(samples.normals, axis=1) == pytest.approx(np.ones(len(samples)))


@given(at=st.tuples(*[st.floats(-0.1, 0.1)] * 3), radius=st.floats(0.005, 0.05), seed=seeds)
@few
def test_skin_is_touched_where_it_is_inside_and_nowhere_else(
    at: Any, radius: float, seed: int
) -> None:
    hand = bent(seed)
    centre = np.add(at, (0.0, 0.03, 0.19))
    samples = touched(ball(radius, centre, thickness=0.2), hands=(hand,))
    away = np.linalg.norm(samples.positions - centre, axis=1)
    assert (away < radius + 2.0 * FINEST).all()  # a node stands for the skin around it
    inside = (np.linalg.norm(dense(hand, 2e-3)[0] - centre, axis=1) < radius - FINEST).any()
    assert bool(len(samples)) >= bool(inside)
    outside = to_capsules(PosedSkin(hand).capsules, centre[None]).min() > radius + 1e-9
    assert not (outside and len(samples))


# ----------------------------------------------------------------------------- how strong it is


@given(seed=seeds, at=st.tuples(*[st.floats(-0.04, 0.04)] * 3), radius=st.floats(0.02, 0.06))
@few
def test_the_force_is_the_integral_of_pressure_over_the_skin(
    seed: int, at: Any, radius: float
) -> None:
    hand, centre = bent(seed), np.add(at, (0.0, 0.03, 0.18))
    q, area = dense(hand, 1.5e-3)
    depth = radius - np.linalg.norm(q - centre, axis=1)
    expected = (np.clip(depth / FULL_PRESSURE_DEPTH, 0.0, 1.0) * 10.0) @ area
    whole = ball(radius, centre, thickness=1.0)
    # at the rim, the error is that of a stripe as wide as the spacing of skin points
    rim = 10.0 * area[np.abs(depth) < FINEST].sum()
    for spacing in (FINEST, 0.0085, 0.02):
        force = touched(whole, hands=(hand,), spacing=spacing).force
        assert abs(force - expected) <= 0.2 * rim + 0.03 * expected


@pytest.mark.parametrize("noise", [0.0, 1e-6, 1e-4, 1e-3, 1e-2])
def test_a_hand_collapsed_to_a_line_has_finite_samples_of_at_most_twice_the_pressure(
    noise: float,
) -> None:
    joints = np.array(Hand.open("right", pc.Pose((0.0, 0.0, 0.215))).joints)
    joints[:, :2] = 0.0
    joints += noise * np.random.default_rng(1).standard_normal(joints.shape)
    for spacing in (FINEST, 0.0085, 0.02):
        samples = touched(ball(at=(0.0, 0.0, 0.2)), hands=(Hand(joints),), spacing=spacing)
        assert len(samples)
        assert np.isfinite(samples.radiation_pressure).all()
        assert samples.radiation_pressure.max() <= 2.0 * 10.0 * (1.0 + 1e-9)
        assert samples.area.min() > 0.0


@pytest.mark.parametrize("hand", [Hand.open("left"), bent(3)], ids=["open", "bent"])
def test_all_of_a_hand_within_a_volume_is_pressed(hand: Hand) -> None:
    sea = pc.Volume(shape=pc.Box((1.0, 1.0, 1.0)), felt="interior", radiation_pressure=2.0)
    expected = 2.0 * dense(hand)[1].sum()
    for spacing in (FINEST, 0.0085, 0.02):
        samples = touched(sea, hands=(hand,), spacing=spacing)
        assert samples.force == pytest.approx(expected, rel=0.05)
        assert samples.radiation_pressure == pytest.approx(2.0, rel=0.5)
    shell = replace(sea, felt="shell")
    assert len(touched(shell, hands=(hand,))) == 0


@pytest.mark.parametrize("depth", [0.0005, 0.001, 0.003])
def test_a_plate_on_a_flat_palm_presses_as_the_formula_says(depth: float) -> None:
    slab = flat_hand((0.08, 0.16, 0.03), 0.2)
    share = min(depth / FULL_PRESSURE_DEPTH, 1.0)
    small, large = (touched(plate(0.2 + depth, size), hands=(slab,)) for size in (0.06, 0.3))
    assert small.force == pytest.approx(10.0 * share * 0.06 * 0.06, rel=0.06)
    assert small.positions[:, 2] == pytest.approx(0.2, abs=1e-9)
    assert small.normals == pytest.approx(np.tile([0.0, 0.0, -1.0], (len(small), 1)))
    sides = (
        2.0
        * (0.08 + 0.16)
        * (max(depth - FULL_PRESSURE_DEPTH, 0.0) + share * min(depth, FULL_PRESSURE_DEPTH) / 2.0)
    )
    assert large.force == pytest.approx(10.0 * (share * 0.08 * 0.16 + sides), rel=0.03)


def flat_hand(size: Any, z: float) -> Hand:
    """Return a box-shaped hand mesh of small faces, whose palm is at z."""
    import trimesh

    box = trimesh.creation.box(size)
    for _ in range(4):
        box = box.subdivide()
    return Hand(vertices=box.vertices, faces=box.faces).transform(
        pc.Pose((0, 0, z + size[2] / 2.0))
    )


@pytest.mark.parametrize("depth", [0.0005, 0.0015])
def test_a_plate_on_a_finger_presses_as_the_formula_says(depth: float) -> None:
    """On a straight cylinder of radius r, a bed of springs k gives 2 k r (r sin a - (r - h) a) per metre."""
    r, length = 0.01, 0.3
    vertices, faces = cylinder(r, length)
    finger = Hand(vertices=vertices, faces=faces).transform(pc.Pose((0.0, 0.0, 0.2 + r)))
    wide = pc.Surface(
        shape=pc.Rectangle(0.2, 0.1), pose=pc.Pose((0.0, 0.0, 0.2 + depth)), radiation_pressure=10.0
    )
    a = math.acos((r - depth) / r)
    expected = 0.2 * 2.0 * 10.0 / FULL_PRESSURE_DEPTH * r * (r * math.sin(a) - (r - depth) * a)
    assert touched(wide, hands=(finger,)).force == pytest.approx(expected, rel=0.08)


def cylinder(r: float, length: float, around: int = 96, along: int = 60) -> tuple[Any, Any]:
    """Return a tube along x."""
    phi, x = 2.0 * np.pi * np.arange(around) / around, np.linspace(-length / 2, length / 2, along)
    P, X = np.meshgrid(phi, x)
    vertices = np.stack([X, r * np.cos(P), r * np.sin(P)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(along - 1), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    quads = np.stack([a, b, b + around, a + around], axis=-1).reshape(-1, 4)
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def test_a_texture_presses_with_its_share() -> None:
    whole, striped = touched(plate(0.2)), touched(plate(0.2, texture=grating(0.01)))
    assert striped.force == pytest.approx(whole.force / 2.0, rel=0.05)


def test_a_softer_object_presses_less() -> None:
    forces = [touched(ball(material=Material(k))).force for k in (100.0, 200.0, 1e3, 1e4)]
    assert forces[0] > 0.0
    assert (np.diff(forces) > 0.0).all()


def test_an_object_is_felt_from_its_reach_on() -> None:
    away = ball(0.03, (0.0, 0.0, 0.2 - 0.03 - 0.016))
    assert len(touched(away)) == 0
    assert touched(replace(away, material=Material(reach=0.01))).force > 0.0


BALLS = ["sdf", "placed", "union", "intersection", "difference", "mesh", "voxels"]


@functools.cache
def same_balls(radius: float) -> dict[str, Any]:
    """Return the same ball several times."""
    import trimesh

    sphere = trimesh.creation.icosphere(4, radius)
    vertices, faces = sphere.vertices.tolist(), sphere.faces.tolist()
    grid = np.linspace(-0.04, 0.04, 65)
    r = np.linalg.norm(np.stack(np.meshgrid(grid, grid, grid, indexing="ij")), axis=0)
    shell = pc.Sphere(radius)
    return {
        "sdf": pc.SDF(lambda p: np.linalg.norm(p, axis=1) - radius, (radius,) * 3),
        "placed": Placed(pc.Sphere(radius), random_pose(0, 0.0)),
        "union": Union((shell, pc.Sphere(0.5 * radius))),
        "intersection": Intersection((shell, pc.Box((0.2, 0.2, 0.2)))),
        "difference": Difference(shell, (Placed(shell, pc.Pose((1.0, 0.0, 0.0))),)),
        "mesh": pc.Mesh(vertices=vertices, faces=faces),
        "voxels": Voxels(
            values=np.clip(0.5 + (radius - r) / 0.005, 0.0, 1.0), pitch=grid[1] - grid[0]
        ),
    }


@pytest.mark.parametrize("name", BALLS)
def test_a_ball_is_a_ball_however_it_is_described(name: str) -> None:
    shape = same_balls(0.03)[name]
    for z, felt in itertools.product((0.16, 0.175, 0.195), ("shell", "interior")):
        plain = ball(at=(0.0, 0.02, z), felt=felt, thickness=0.01)
        one, other = touched(plain), touched(replace(plain, shape=shape))
        if name in ("mesh", "voxels"):
            assert other.force == pytest.approx(one.force, rel=0.02)
        else:
            assert np.array_equal(one.keys, other.keys)
            assert other.radiation_pressure == pytest.approx(one.radiation_pressure, abs=1e-6)


def test_a_plate_is_a_plate_however_it_is_described() -> None:
    corners = ((-0.2, -0.2, 0.0), (0.2, -0.2, 0.0), (0.2, 0.2, 0.0), (-0.2, 0.2, 0.0))
    one = touched(plate(0.191))
    for shape in (
        HeightMap(heights=np.zeros((3, 3)), width=0.4, height=0.4),
        pc.Mesh(vertices=corners, faces=((0, 1, 2), (0, 2, 3))),
        pc.Disc(0.3),
    ):
        other = touched(replace(plate(0.191), shape=shape))
        assert np.array_equal(one.keys, other.keys)
        assert other.radiation_pressure == pytest.approx(one.radiation_pressure, abs=1e-6)


# --------------------------------------------------------------------------------- as it moves


@each_object
@given(seed=seeds)
@few
def test_a_rigid_motion_of_everything_changes_nothing_else(item: Any, seed: int) -> None:
    pose, hand = random_pose(seed), bent(seed)
    here = touched(item, hands=(hand,))
    there = touched(moved(item, pose), hands=(hand.transform(pose),))
    assert np.array_equal(here.keys, there.keys)
    assert there.positions == pytest.approx(pose.points(here.positions), abs=1e-9)
    assert there.normals == pytest.approx(pose.directions(here.normals), abs=1e-7)
    # a path is sampled in its own frame, and its nearest points may lie between two equally near fingers
    assert there.radiation_pressure == pytest.approx(here.radiation_pressure, rel=1e-6, abs=1e-6)
    assert there.area == pytest.approx(here.area, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "spacing"), [("ball", 0.0085), ("interior", FINEST), ("soft", FINEST)]
)
def test_the_force_does_not_jump_as_a_contact_slides(name: str, spacing: float) -> None:
    item, step = OBJECTS[name], 1e-4
    stiffness = item.material.stiffness or item.pressure / FULL_PRESSURE_DEPTH
    sampler = pc.Sampler(5000, spacing, perception=False)
    skin = dense(HAND, 2e-3)
    forces, bounds = [], []
    for i in range(500):
        centre = np.array([-0.03 + step * i, 0.04, 0.175])
        slid = replace(item, pose=pc.Pose(tuple(centre)))
        forces.append(sampler.sample(pc.Scene((slid,), hands=(HAND,)), 0.001 * i).force)
        near = np.linalg.norm(skin[0] - centre, axis=1) < item.bounding_radius + 2.0 * FINEST
        bounds.append(stiffness * step * skin[1][near].sum() * 1.05)
    assert max(forces) > 0.0
    assert (np.abs(np.diff(forces)) <= bounds[1:]).all()


@pytest.mark.parametrize("spacing", [FINEST, 0.0085])
def test_no_sample_jumps_more_than_its_share_as_a_contact_slides(spacing: float) -> None:
    sampler = pc.Sampler(5000, spacing, perception=False)
    before: dict[int, float] = {}
    for i in range(400):
        slid = ball(at=(-0.02 + 1e-4 * i, 0.04, 0.175))
        samples = sampler.sample(pc.Scene((slid,), hands=(HAND,)), 0.001 * i)
        after = dict(zip(samples.keys.tolist(), samples.radiation_pressure.tolist(), strict=True))
        if before:
            for key in before.keys() | after.keys():
                change = abs(after.get(key, 0.0) - before.get(key, 0.0))
                # at most stiffness times step; twice that, because nodes have uneven shares of skin
                assert change <= 10.0 / FULL_PRESSURE_DEPTH * 1e-4 * 2.0
        before = after


@pytest.mark.parametrize("name", OBJECTS)
def test_with_a_ramp_no_sample_jumps_whatever_happens(name: str) -> None:
    ramp, tick, rng = 0.005, 0.001, np.random.default_rng(0)
    sampler = pc.Sampler(60, ramp=ramp, perception=True)
    sampler.prepare(pc.autd(), pc.Air())
    item, before, most = OBJECTS[name], dict[int, tuple[Any, float]](), OBJECTS[name].pressure
    for i in range(300):
        x, y = 0.02 * math.sin(0.02 * i), 0.04
        if i % 60 == 59:  # the object jumps, and the number of samples changes
            x += rng.uniform(-0.05, 0.05)
            sampler.allowed = int(rng.integers(5, 60))
        hands = () if 100 <= i < 110 else (HAND.transform(pc.Pose((x, y - 0.04, 0.0))),)
        if i in (100, 110):  # what was rendered whole does not fade out on skin, nor the reverse
            before = {}
        now = sampler.sample(pc.Scene((item,) if i % 90 < 80 else (), hands=hands), tick * i)
        after = {
            key: (at, P)
            for key, at, P in zip(
                now.keys.tolist(), now.positions, now.radiation_pressure.tolist(), strict=True
            )
        }
        assert len(after) == len(now)
        for key, (at, P) in after.items():
            was = before.get(key)
            fresh = was is None or np.linalg.norm(was[0] - at) > 0.02
            if fresh and key < 0:
                continue  # the old sample fades out under another key
            step = most * math.sin(math.pi / 2.0 * tick / ramp) + 1e-5
            if fresh:  # in a region, it continues from the pressure of its neighbours
                felt = [p for q, p in before.values() if np.linalg.norm(q - at) < APART]
                assert max(felt, default=0.0) + step >= P
            else:
                assert abs(P - was[1]) <= step
        for key in before.keys() - after.keys():
            where, P = before[key]
            assert most * math.sin(math.pi / 2.0 * tick / ramp) + 1e-5 >= P or any(
                np.linalg.norm(q - where) < APART if k >= 0 else (q == where).all()
                for k, (q, _) in after.items()
            )
        before = after


@given(seed=seeds)
@few
def test_what_was_sampled_before_does_not_matter(seed: int) -> None:
    """One sampler goes through many poses; the reference is a new sampler for each pose."""
    rng, t = np.random.default_rng(seed), 0.0
    sampler = pc.Sampler(20_000, FINEST, perception=False)
    items = [replace(OBJECTS[name], name=name) for name in ("ball", "grating", "soft", "path")]
    for name in ("mesh", "union"):
        shape = same_balls(0.03)[name]
        items.append(replace(OBJECTS["ball"], shape=shape, name=name))
        items.append(replace(items[-1], felt="interior", name=f"{name}, interior"))
    at, hand = np.zeros((len(items), 3)), HAND
    for _ in range(8):
        size = 10.0 ** rng.uniform(-5.0, -1.0)
        at += rng.normal(0.0, size, at.shape)
        if rng.random() < 0.5:
            hand = hand.transform(pc.Pose(tuple(rng.normal(0.0, size, 3))))
        objects = tuple(moved(i, pc.Pose(tuple(d))) for i, d in zip(items, at, strict=True))
        scene = pc.Scene(objects, hands=(hand,))
        for _ in range(2):  # twice, until the blend is over
            t += 0.02
            now = sampler.sample(scene, t)
        fresh = touched(*objects, hands=(hand,))
        assert np.array_equal(now.keys, fresh.keys)
        assert now.positions == pytest.approx(fresh.positions, abs=1e-12)
        assert now.radiation_pressure == pytest.approx(fresh.radiation_pressure, abs=1e-9)


@pytest.mark.parametrize("who", ["object", "hand"])
def test_between_updates_it_is_felt_as_if_there_were_none(who: str) -> None:
    """Uniform motion with 120 updates a second is felt like one with an update at each moment."""
    v, rate = 0.2, 1.0 / 120.0
    told = pc.Sampler(20_000, FINEST, perception=False)
    item = replace(ball(at=(-0.03, 0.04, 0.175)), name="ball")

    def scene(x: float, seen: float | None) -> pc.Scene:
        if who == "object":
            motion = None if seen is None else Motion((v, 0.0, 0.0), time=seen)
            pose = pc.Pose((-0.03 + x, 0.04, 0.175))
            return pc.Scene((replace(item, pose=pose, motion=motion),), hands=(HAND,))
        hand = HAND.transform(pc.Pose((-x, 0.0, 0.0)))
        if seen is not None:
            hand = Hand(hand.joints, velocities=(-v, 0.0, 0.0), time=seen)
        return pc.Scene((item,), hands=(hand,))

    for i in range(200):
        t = 0.001 * i
        seen = math.floor(t / rate) * rate
        exact = scene(v * t, None)
        truth = touched(*exact.objects, hands=exact.hands)
        now = told.sample(scene(v * seen, seen), t)
        assert now.force == pytest.approx(truth.force, rel=1e-6, abs=1e-9)


def test_a_lost_hand_is_felt_for_a_moment_and_then_fades() -> None:
    sampler, lost = pc.Sampler(perception=False), Hand(np.full((26, 3), np.nan))
    seen = sampler.sample(pc.Scene((ball(),), hands=(HAND,)), 1.0).force
    times = np.arange(1.0, 1.2, 0.001)
    forces = np.array(
        [sampler.sample(pc.Scene((ball(),), hands=(lost,)), t).force for t in times.tolist()]
    )
    assert forces[times < 1.0 + HOLD_TIME - 0.002] == pytest.approx(seen)
    assert (np.diff(forces) <= 1e-12).all()
    assert np.diff(forces).min() >= -1.01 * seen * 0.001 / LOST_HAND_FADE_TIME
    assert (forces[times > 1.002 + HOLD_TIME + LOST_HAND_FADE_TIME] == 0.0).all()


SECOND = 1.0  # when it begins [s]
CHANGES = {
    "a lost hand": (HAND, Hand(np.full((26, 3), np.nan))),
    "a late hand": (Hand(HAND.joints, time=SECOND),) * 2,
    "a hand that moves": (Hand(HAND.joints, velocities=(0.3, 0.0, 0.0), time=SECOND),) * 2,
    "a hand put elsewhere": (HAND, HAND.transform(pc.Pose((0.01, 0.0, 0.0)))),
    "a hand that stays": (HAND, HAND),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_scene_that_nobody_updates_goes_on_as_if_it_were_looked_at_anew(what: str) -> None:
    before, after = (pc.Scene((ball(),), hands=(hand,)) for hand in CHANGES[what])
    kept, anew = (pc.Sampler(perception=False) for _ in range(2))
    felt = []
    for i in range(16):
        t, scene = SECOND + 0.013 * i, after if i else before
        anew.invalidate()
        samples, expected = kept.sample(scene, t), anew.sample(scene, t)
        assert np.array_equal(samples.keys, expected.keys)
        assert np.array_equal(samples.positions, expected.positions)
        assert np.array_equal(samples.radiation_pressure, expected.radiation_pressure)
        felt.append(samples.force)
    assert felt[0] > 0.0
    assert (felt[-1] > 0.0) == (what in ("a hand put elsewhere", "a hand that stays"))


# ----------------------------------------------------------------------- facing and the other side


def test_the_box_around_a_hand_is_that_of_its_bones_and_its_centre_in_the_middle() -> None:
    for seed in range(5):
        hand = PosedSkin(bent(seed).transform(random_pose(seed)))
        centre, radius = hand.placed.bounds[:, :3], hand.placed.bounds[:, 3:]
        low, high = (centre - radius).min(axis=0), (centre + radius).max(axis=0)
        assert hand.box == pytest.approx(np.concatenate([low, high]), abs=1e-12)
        assert hand.centre == pytest.approx((low + high) / 2.0, abs=1e-12)
        assert (hand.points >= low - 1e-9).all()
        assert (hand.points <= high + 1e-9).all()


@given(seed=seeds, radius=st.floats(0.01, 10.0), corners=st.integers(0, 4))
@few
def test_skin_near_an_object_is_what_its_sphere_holds_and_what_faces_the_array(
    seed: int, radius: float, corners: int
) -> None:
    rng = np.random.default_rng(seed)
    hand = PosedSkin(bent(seed).transform(random_pose(seed, 1.0)))
    away = rng.normal(size=3)
    at = hand.points[rng.integers(len(hand.points))] + radius * away / np.linalg.norm(away)
    pose = pc.Pose(tuple(at.tolist()), random_pose(seed).rotation)
    ends = rng.uniform(-1.0, 1.0, (corners, 3))
    which, local = hand.find_near(pose, radius, ends)
    d = hand.points - at
    distance = np.linalg.norm(d, axis=1)
    along = np.einsum("kc,kvc->kv", hand.normals, ends - hand.points[:, None])
    faces = (along > 0.0).any(axis=1)
    expected = np.flatnonzero((distance <= radius) & (faces | (corners == 0)))
    level = (np.abs(along) < 1e-12).any(axis=1)
    unsure = np.flatnonzero((np.abs(distance - radius) < 1e-9) | level)  # rounding decides
    assert set(which.tolist()) ^ set(expected.tolist()) <= set(unsure.tolist())
    inverse = Rotation.from_quat(pose.rotation).inv()
    assert local == pytest.approx(inverse.apply(d[which]), abs=1e-9)


def share_seen(array: Any, points: Any, normals: Any) -> Any:
    """Return the share of pressure that skin gets: a smooth step from 2 % to 10 % of the power."""
    made = []
    for point, normal in zip(points, normals, strict=True):
        away = [(math.hypot(*d), float(d @ normal)) for d in array.positions - point]
        powers = [max(along / r, 0.0) ** 2 / r**2 for r, along in away]
        seen = sum(powers) / sum(1.0 / r**2 for r, _ in away)
        x = min(max((seen - 0.02) / 0.08, 0.0), 1.0)
        made.append(integrate.quad(lambda u: 6.0 * u * (1.0 - u), 0.0, x)[0])
    return np.array(made)


EIGHT_TRANSDUCERS = pc.Array(
    np.stack(
        [*map(np.ravel, np.meshgrid([-0.08, 0.0, 0.07, 0.1], [-0.06, 0.08])), np.zeros(8)], axis=1
    )
)


@pytest.mark.parametrize("kind", ["particles", "contact"])
def test_skin_is_pressed_by_how_well_the_array_sees_it(kind: str) -> None:
    """The far side gets no pressure, and skin at grazing incidence gets less. All eight transducers count."""
    resolving = ArrayResolution(EIGHT_TRANSDUCERS, pc.Air())
    hand = PosedSkin(bent(5))
    each = np.arange(0, len(hand.points), 7)
    points, normals = hand.points[each], hand.normals[each]
    expected = share_seen(EIGHT_TRANSDUCERS, points, normals)
    assert ((expected > 0.05) & (expected < 0.95)).sum() > 3
    if kind == "contact":
        everywhere, deep = np.empty((0, 3)), np.full(len(each), -1.0)
        found = []
        for some in (everywhere, resolving.viewpoints):
            force = np.zeros(len(each))
            inside, pressed = hand.find_pressed(each, deep, Material(1e9), 5.0, some)
            force[inside] = pressed
            found.append(force)
        bare, made = found
        free = bare > 0.0
        assert bare[free] == pytest.approx(5.0 * hand.area[each][free])
        assert made == pytest.approx(expected * bare, abs=1e-12)
    else:
        assert weigh_incidence(resolving.compute_incidence(points, normals)) == pytest.approx(
            expected, abs=1e-9
        )
        rain = Particles(positions=points.tolist(), radiation_pressure=5.0, radius=0.005)
        bare = touched(rain, hands=(hand.hand,))
        assert bare.radiation_pressure == pytest.approx(5.0)
        share = share_seen(EIGHT_TRANSDUCERS, bare.positions, bare.normals)
        sampler = pc.Sampler(20_000, FINEST, perception=False)
        sampler.prepare(EIGHT_TRANSDUCERS, pc.Air())
        felt = sampler.sample(pc.Scene((rain,), hands=(hand.hand,)))
        assert np.array_equal(felt.keys, bare.keys[share > 0.0])
        assert felt.radiation_pressure == pytest.approx(5.0 * share[share > 0.0], abs=1e-6)


@pytest.mark.parametrize(("units", "height"), [(1, 0.03), (3, 0.06), (4, 0.1)])
def test_skin_close_to_a_wide_array_is_pressed_fully(units: int, height: float) -> None:
    """Most transducers see it at grazing incidence, but those below it are much louder."""
    array = pc.autd(units, units)
    low, high = array.positions[:, :2].min(axis=0), array.positions[:, :2].max(axis=0)
    places = low + (high - low) * np.random.default_rng(5).random((300, 2))
    points = np.column_stack([places, np.full(300, height)])
    seen = ArrayResolution(array, pc.Air()).compute_incidence(points, np.array([0.0, 0.0, -1.0]))
    assert weigh_incidence(seen).min() == 1.0


def test_skin_that_faces_away_from_the_array_is_not_asked_for() -> None:
    below, above = ball(), ball(at=(0.0, 0.0, 0.23))
    for item, felt in ((below, True), (above, False)):
        sampler = pc.Sampler()
        sampler.prepare(pc.autd(), pc.Air())
        samples = sampler.sample(pc.Scene((item,), hands=(HAND,)))
        assert bool(len(samples)) == felt
    assert len(touched(above))  # without an array, all sides count


def test_samples_face_some_of_the_array() -> None:
    array = pc.autd()
    sampler = pc.Sampler(20_000, FINEST, perception=False)
    sampler.prepare(array, pc.Air())
    sea = pc.Volume(
        shape=pc.Sphere(0.3), pose=pc.Pose((0, 0, 0.2)), felt="interior", radiation_pressure=5.0
    )
    all_round = touched(sea)
    samples = sampler.sample(pc.Scene((sea,), hands=(HAND,)))
    assert 0 < len(samples) < len(all_round)
    d = array.positions - samples.positions[:, None]
    assert (np.einsum("mnk,mk->mn", d, samples.normals) > 0.0).any(axis=1).mean() > 0.9
    assert (samples.normals[:, 2] < 0.3).all()
    seen = all_round.normals[:, 2] < -0.9  # skin that faces straight down gets the full pressure
    index = {key: m for m, key in enumerate(samples.keys.tolist())}
    P = [
        samples.radiation_pressure[index[key]] if key in index else 0.0
        for key in all_round.keys[seen].tolist()
    ]
    assert np.array(P) == pytest.approx(all_round.radiation_pressure[seen], rel=0.3)


# ---------------------------------------------------------------- points, paths, particles, techniques


def test_a_point_is_felt_where_the_skin_is_nearest_within_the_hand_and_not_beside_it() -> None:
    point = OBJECTS["point"]
    samples = touched(point)
    assert len(samples) == 1
    q, _ = dense(HAND)
    at = np.array(point.position)
    assert np.linalg.norm(samples.positions[0] - at) <= np.linalg.norm(q - at, axis=1).min() + 1e-9
    assert samples.area[0] == point.area
    inside = replace(point, position=(0.0, 0.0, 0.2))
    assert touched(inside).radiation_pressure.tolist() == [10.0]
    assert len(touched(replace(point, position=(0.0, 0.0, 0.15)))) == 0


def test_each_particle_is_felt_by_itself() -> None:
    samples = touched(OBJECTS["particles"])
    assert len(samples) == 2  # the third particle is below the hand
    path = touched(OBJECTS["path"])
    assert np.linalg.norm(path.positions[:, :2], axis=1) == pytest.approx(0.02, abs=0.005)


def test_more_particles_than_the_budget_are_cut_to_it() -> None:
    rng = np.random.default_rng(0)
    rain = Particles(
        positions=rng.uniform([-0.03, -0.03, 0.18], [0.03, 0.06, 0.21], (5000, 3)),
        radiation_pressure=5.0,
    )
    assert len(touched(rain, budget=40)) == 40
    assert (
        len(touched(replace(rain, technique=STM(50.0)), budget=40)) > 40
    )  # only one sounds at a time


def test_objects_of_one_group_are_one_where_they_meet_and_keep_their_force() -> None:
    one, two = ball(at=(-0.001, 0.0, 0.175)), ball(at=(0.001, 0.0, 0.175))
    both = touched(one, two, spacing=0.0085)
    assert both.force == pytest.approx(
        touched(one, spacing=0.0085).force + touched(two, spacing=0.0085).force
    )
    d = np.linalg.norm(both.positions[:, None] - both.positions, axis=2)
    assert (d + np.eye(len(both))).min() > 0.004
    other = replace(two, envelope=pc.Sine(100.0))
    apart = touched(one, other, spacing=0.0085)
    assert len(apart) > len(both)
    assert len(set(apart.keys.tolist())) == len(apart)


def test_nothing_asked_for_gives_nothing() -> None:
    for silent in ((), (ball(radiation_pressure=0.0),), (ball(envelope=pc.Constant(0.0)),)):
        samples = touched(*silent)
        assert len(samples) == samples.force == 0
        assert samples.positions.shape == samples.normals.shape == (0, 3)


# ----------------------------------------------------------------------------------------- hands


def test_both_hands_feel() -> None:
    left = Hand.open("left", pc.Pose((-0.15, 0.0, 0.2)))
    right = Hand.open("right", pc.Pose((0.15, 0.0, 0.2)))
    wide = plate(0.195, 1.0)
    both = touched(wide, hands=(left, right))
    each = [touched(wide, hands=(hand,)) for hand in (left, right)]
    assert both.force == pytest.approx(sum(one.force for one in each))
    assert len(set(both.keys.tolist())) == len(both) == sum(map(len, each))
    assert each[0].force == pytest.approx(each[1].force)  # they mirror each other
    mirrored = np.sort(each[0].positions * [-1.0, 1.0, 1.0], axis=0)
    assert mirrored == pytest.approx(np.sort(each[1].positions, axis=0), abs=1e-9)


def test_one_point_between_two_hands_is_felt_by_both() -> None:
    upper = Hand.open("left", pc.Pose((0.0, 0.0, 0.213)))
    lower = Hand.open("right", pc.Pose((0.0, 0.0, 0.187)))
    drop = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=5.0)
    samples = touched(drop, hands=(upper, lower), spacing=1e-3)
    assert len(samples) == len(set(samples.keys.tolist())) == 2


def test_a_hand_given_as_a_mesh_feels_too() -> None:
    import igl

    slab = flat_hand((0.08, 0.16, 0.03), 0.2)
    path = replace(OBJECTS["path"], pose=pc.Pose((0.0, 0.0, 0.199)))
    for item in (ball(at=(0.0, 0.0, 0.18)), path, plate(0.201), OBJECTS["interior"]):
        samples = touched(item, hands=(slab,))
        assert len(samples)
        d = igl.point_mesh_squared_distance(samples.positions, slab.vertices, slab.faces)[0]
        assert np.sqrt(d).max() < 1e-9


def test_a_hand_far_away_feels_nothing() -> None:
    for z in (1.0, 50.0, 1e6):
        hand = HAND.transform(pc.Pose((0.0, 0.0, z)))
        assert len(touched(*OBJECTS.values(), hands=(hand,))) == 0


def test_a_lost_hand_feels_nothing_and_there_is_no_hand_less_scene_for_it() -> None:
    lost = Hand(np.full((26, 3), np.nan))
    samples = touched(*OBJECTS.values(), hands=(lost,))
    assert len(samples) == 0  # objects are not rendered as a whole in the air
    assert samples.capsules is not None
    both = touched(
        ball(), hands=(lost, HAND.transform(pc.Pose((0.0, 0.0, 0.0)))._with(name="other"))
    )
    assert both.force == pytest.approx(touched(ball()).force)


# -------------------------------------------------------------------------------- odd and bad input


def test_a_workspace_cuts_what_is_outside() -> None:
    room = pc.Workspace((0.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    scene = pc.Scene((plate(0.19),), room, (HAND,))
    samples = pc.Sampler(20_000, FINEST, perception=False).sample(scene)
    whole = touched(plate(0.19))
    assert samples.force == pytest.approx(whole.only(whole.positions[:, 0] >= 0.0).force)
    elsewhere = pc.Workspace((5.0, 5.0, 5.0), (6.0, 6.0, 6.0))
    assert len(pc.Sampler().sample(pc.Scene((plate(0.19),), elsewhere, (HAND,)))) == 0


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e-6])
def test_an_object_of_next_to_no_size_gives_next_to_nothing(size: float) -> None:
    point = tuple(dense(HAND)[0][1234])
    pose = pc.Pose(point)
    for shape in (pc.Sphere(size), pc.Box((size, size, size))):
        item = pc.Volume(shape=shape, pose=pose, radiation_pressure=5.0)
        assert touched(item).force < 1e-6
    for flat in (pc.Disc(size), pc.Rectangle(size, size)):
        assert touched(pc.Surface(shape=flat, pose=pose, radiation_pressure=5.0)).force < 1e-3


@pytest.mark.parametrize("far", [1e3, 1e300])
def test_an_object_at_infinity_is_not_felt(far: float) -> None:
    for item in (ball(at=(far, 0.0, 0.0)), pc.Point(position=(0, -far, 0), radiation_pressure=1.0)):
        assert len(touched(item)) == 0
        sampler = pc.Sampler()
        sampler.prepare(pc.autd(), pc.Air())
        assert len(sampler.sample(pc.Scene((item,)))) == 0
    with pytest.raises(pc.ArgumentError):
        ball(at=(math.inf, 0.0, 0.0))


def test_a_hand_of_no_extent_is_no_fault() -> None:
    point = Hand(np.full((26, 3), 0.2), np.full(26, 0.008))
    samples = touched(ball(0.05, (0.2, 0.2, 0.19), felt="interior"), hands=(point,))
    assert np.isfinite(samples.positions).all()
    assert np.isfinite(samples.force)


def test_perception_leaves_out_what_no_one_feels() -> None:
    faint, strong = ball(radiation_pressure=0.1), ball(radiation_pressure=20.0)
    assert len(touched(faint, perception=True)) == 0
    assert len(touched(faint)) > 0
    felt, whole = touched(strong, perception=True), touched(strong)
    assert 0.9 * whole.force < felt.force <= whole.force


def test_what_is_left_out_is_counted_each_time_it_is_looked_for() -> None:
    far, faint = ball(at=(1.0, 0.0, 0.2)), ball(at=(0.0, 0.04, 0.17), radiation_pressure=0.15)
    lost = Hand(np.full((26, 3), np.nan), name="lost")
    scene = pc.Scene((far, ball(), faint), hands=(HAND, lost))
    sampler = pc.Sampler(4, 0.0085)  # on skin that is sampled coarsely, 1.2 times that
    sampler.mode = SamplingMode(fine=False)
    samples = sampler.sample(scene)
    assert len(samples) == 5
    assert sampler.skipped["objects away from hands"] == 1
    assert sampler.skipped["hands lost"] == 1
    assert sampler.skipped["samples too faint to feel"] > 0
    once = sampler.skipped.copy()
    for t in (0.1, 0.2, 0.3):
        assert sampler.sample(scene, t) is samples
    assert sampler.skipped == once  # nothing was sampled again


def test_hands_that_come_and_go_share_no_key() -> None:
    first, second, third = (
        Hand.open("right", pc.Pose((x, 0.0, 0.2)), name=name)
        for x, name in ((-0.15, "a"), (0.0, "b"), (0.15, "c"))
    )
    sampler, plane = pc.Sampler(), plate(0.2, 0.6)
    for hands in ((first, second), (second,), (second, third), (third, second)):
        keys = sampler.sample(pc.Scene((plane,), hands=hands)).keys
        assert len(keys)
        assert len(set(keys.tolist())) == len(keys)


# ------------------------------------------------------------------------- finely sampled contacts


def sample_finely(*objects: Any, hand: Hand = HAND, fine: bool = True) -> Samples:
    sampler = pc.Sampler(perception=False)
    sampler.prepare(pc.autd(3, 3), pc.Air())
    sampler.mode = SamplingMode(fine=fine)
    return sampler.sample(pc.Scene(tuple(objects), hands=(hand,)))


@pytest.mark.parametrize("fine", [False, True])
@pytest.mark.parametrize("radius", [0.008, 0.012, 0.02, 0.03])
@pytest.mark.parametrize("hand", [HAND, bent(3), bent(4, "left")], ids=["open", "bent", "left"])
def test_a_small_contact_has_samples_each_at_the_pressure_of_its_place(
    radius: float, hand: Hand, fine: bool
) -> None:
    """The reference is independent: distances from the ball, and the force on a dense skin."""
    assert hand.joints is not None
    skin = dense(hand)
    middle = hand.joints[0]
    low = skin[0][np.linalg.norm(skin[0][:, :2] - middle[:2], axis=1) < 0.004][:, 2].min()
    centre = np.array([*middle[:2], low - radius + 0.003])
    samples = sample_finely(ball(radius, centre), hand=hand, fine=fine)
    assert (80 if fine else 50) < len(samples) <= (480 if fine else 256)
    depth = radius - np.linalg.norm(samples.positions - centre, axis=1)
    law = Material()
    np.testing.assert_allclose(samples.radiation_pressure, law.pressure(depth, 10.0), atol=1e-6)
    away = to_capsules(PosedSkin(hand).capsules, samples.positions)
    assert np.abs(away.min(axis=1)).max() < 5.1e-4
    assert len(set(samples.keys.tolist())) == len(samples)
    pressed = law.pressure(radius - np.linalg.norm(skin[0] - centre, axis=1), 10.0)
    assert samples.force == pytest.approx(float(pressed @ skin[1]), rel=0.06)


def test_samples_of_a_fine_contact_stay_on_the_skin_that_moves() -> None:
    item = ball(0.012, (0.0, 0.0, 0.1765))
    sampler = pc.Sampler(perception=False)
    sampler.prepare(pc.autd(3, 3), pc.Air())
    first = sampler.sample(pc.Scene((item,), hands=(HAND,)))
    off = np.array([4e-4, 2e-4, -1e-4])
    moved = HAND.transform(pc.Pose(tuple(off)))
    for tick in range(1, 21):  # an error of the prediction vanishes within 10 ms
        second = sampler.sample(pc.Scene((item,), hands=(moved,)), 1e-3 * tick)
    here = dict(zip(first.keys.tolist(), first.positions, strict=True))
    stayed = [key for key in second.keys.tolist() if key in here]
    assert len(stayed) > 0.9 * len(first)
    places = dict(zip(second.keys.tolist(), second.positions, strict=True))
    np.testing.assert_allclose(
        [places[k] - here[k] for k in stayed], np.tile(off, (len(stayed), 1)), atol=1e-12
    )


def test_several_contacts_share_the_samples_of_one() -> None:
    balls = [
        ball(0.012, (x, y, 0.1765), name=f"{x} {y}") for x in (-0.02, 0.015) for y in (-0.02, 0.02)
    ]
    for fine, most in ((False, 256), (True, 480)):
        counts = [len(sample_finely(*balls[:k], fine=fine)) for k in (1, 2, 4)]
        assert 0.2 * most < min(counts)
        assert max(counts) <= most
