"""Regions that split, merge and slide over one another, 0.4 mm a tick, without jumps or holes that can be felt.

An independent field is evaluated between samples, in each frame that a session solves or the loop sends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.propagation import field
from pacinian.scene.config_sections import MIN_SAMPLE_SPACING
from pacinian.testing import ManualClock
from pacinian_lab.regions.skin import _fine as fine_skin

if TYPE_CHECKING:
    from collections.abc import Callable

AIR, TICK, STEP = pc.Air(speed_of_sound=340.0, density=1.2), 1e-3, 4e-4  # [s], [m]
RADIUS, HEIGHT = 0.008, 0.2  # radius and height of discs [m]
ARRAYS = {"one": (pc.autd(), 0.3), "nine": (pc.autd(3, 3), 1.5)}  # and a pressure within reach [Pa]
each = pytest.mark.parametrize(("array", "P"), ARRAYS.values(), ids=ARRAYS)


def disc(radius: float, spacing: float, aside: float = 0.0) -> Any:
    """Return points of a disc on a grid."""
    x = np.arange(-radius, radius + 1e-9, spacing)
    X, Y = np.meshgrid(x, x)
    inside = np.hypot(X, Y) <= radius + 1e-9
    return np.c_[X[inside] + aside, Y[inside], np.zeros(int(inside.sum()))]


def at(array: pc.Array, places: Any) -> Any:
    return places + np.array([*array.centre[:2], HEIGHT])


class Felt(NamedTuple):
    """Of the two discs: the smaller mean pressure and the lowest pressure, relative to the target."""

    force: float
    lowest: float


def felt(array: pc.Array, gains: Any, half: float, P: float) -> Felt:
    """Evaluate two discs. half: half of the distance between their centres [m]."""
    made = []
    for x in (-half, half):
        places = at(array, disc(0.9 * RADIUS, 0.0011, x) + np.array([0.0003, 0.0002, 0.0]))
        made.append(pc.radiation_pressure(field(array, gains, places, AIR), AIR) / P)
    return Felt(*(min(figure(one) for one in made) for figure in (np.mean, np.min)))


def split(half: float) -> tuple[Any, Any]:
    """Return samples of two discs and their regions: one region until the discs are a spacing apart."""
    spacing = 0.0025
    left, right = disc(RADIUS, spacing, -half), disc(RADIUS, spacing, half)
    away = np.linalg.norm(right[:, None] - left, axis=2).min(axis=1)
    q = np.concatenate([left, right[away > spacing / 2.0]])
    whole = 2.0 * (half - RADIUS) < spacing
    return q, np.zeros(len(q), int) if whole else (q[:, 0] > 0.0).astype(int)


@each
@pytest.mark.parametrize("merges", [False, True])
def test_a_region_that_splits_or_merges_is_felt_all_the_while(
    array: pc.Array, P: float, merges: bool
) -> None:
    """Gains jump, because each half gets its own wave, but there is no hole between old and new gains either."""
    session = pc.Session(array, AIR)
    ways = [0.0075 + 0.5 * STEP * i for i in range(15)]
    before: Any = None
    forces, counts = [], set[int]()
    for half in reversed(ways) if merges else ways:
        q, regions = split(half)
        counts.add(len(np.unique(regions)))
        t = pc.sound_pressure(np.full(len(q), P), AIR)
        solution = session.solve(at(array, q), t, regions=regions)
        assert session.measure_felt(solution).status is pc.Status.ok
        now = felt(array, solution.gains, half, P)
        assert now.force == pytest.approx(1.0, abs=0.03)
        assert now.lowest > 0.75
        forces.append(now.force)
        if before is not None:
            turn = np.vdot(solution.gains, before)
            # as in the loop, because the global phase is free
            after = turn / abs(turn) * solution.gains
            for share in np.linspace(0.1, 0.9, 9):
                way = felt(array, (1.0 - share) * before + share * after, half, P)
                assert way.force > 0.87
                assert way.lowest > 0.5
        before = solution.gains.copy()
    assert counts == {1, 2}
    assert np.abs(np.diff(forces)).max() < 0.02


# ---------------------------------------------------------------------- in the loop


def frames(
    array: pc.Array, scene: Callable[[float], pc.Scene], ticks: int
) -> list[tuple[float, Any]]:
    """Yield the time of each row that is sent, and its gains, (N,)."""
    sent: list[tuple[float, Any]] = []
    clock = ManualClock()
    with pc.Renderer(array, scene, clock=clock, medium=AIR) as renderer:
        for k in range(ticks):
            renderer.tick(k * TICK)
            clock.time = (k + 1) * TICK
            rows = renderer.last_frame.gains(renderer.backend.capability)
            sent += [(k * TICK, row.copy()) for row in rows]
        assert renderer.halted is None
    return sent


@each
def test_two_surfaces_that_slide_over_one_another(array: pc.Array, P: float) -> None:
    """Two regions move from 14 mm apart to nearly one place, each with its own wave, with the loop's ramps."""

    def half(t: float) -> float:
        return 0.015 - 0.5 * STEP * t / TICK

    def scene(t: float) -> pc.Scene:
        items = []
        for name, x in (("left", -half(t)), ("right", half(t))):
            place = at(array, np.array([x, 0.0, 0.0])).tolist()
            items.append(
                pc.Surface(
                    shape=pc.Disc(RADIUS),
                    pose=pc.Pose(tuple(place)),
                    radiation_pressure=P,
                    name=name,
                )
            )
        return pc.Scene(tuple(items))

    made = [felt(array, gains, half(t), P) for t, gains in frames(array, scene, 60)[20:]]
    forces = np.array([one.force for one in made])
    assert forces.min() > 0.95
    assert np.abs(np.diff(forces)).max() < 0.03
    assert min(one.lowest for one in made) > 0.6


HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, HEIGHT)))
PALM = np.array([0.0, 0.0, 0.175])  # below the hand [m]


def balls(P: float) -> Callable[[float], pc.Scene]:
    """Return a scene: a hand slides over two balls of 12 mm, 20 mm apart; contacts merge, split, come and go."""
    items = tuple(
        pc.Volume(
            shape=pc.Sphere(0.012), pose=pc.Pose((x, *PALM[1:].tolist())), radiation_pressure=P,
            name=f"at {x}",
        )
        for x in (-0.01, 0.01)
    )  # fmt: skip
    return lambda t: pc.Scene(
        items, hands=(HAND.transform(pc.Pose((-0.014 + STEP * t / TICK, 0.0, -0.002))),)
    )


def twins(P: float) -> Callable[[float], pc.Scene]:
    """Return a scene: a hand rises from and sinks onto an object with two tops; contacts split and merge."""
    parts = tuple(pc.Placed(pc.Sphere(0.02), pc.Pose((x, 0.0, 0.0))) for x in (-0.015, 0.015))
    item = pc.Volume(
        shape=pc.Union(parts), pose=pc.Pose(tuple(PALM.tolist())), radiation_pressure=P
    )
    return lambda t: pc.Scene(
        (item,), hands=(HAND.transform(pc.Pose((0.0, 0.0, STEP / TICK * abs(t - 0.035) - 0.008))),)
    )


class Skin(NamedTuple):
    """Values on touched skin: target and achieved force [N], and the share with less than half of the target."""

    asked: float
    made: float
    holes: float


def on_skin(array: pc.Array, scene: Callable[[float], pc.Scene], ticks: int) -> list[Skin]:
    """Yield these values for each row that is sent, at skin points that no sampler uses."""
    sampler = pc.Sampler(1_000_000, MIN_SAMPLE_SPACING, perception=False)
    sampler.skin = fine_skin()
    sampler.prepare(array, AIR)
    propagator, found = pc.Propagator(array, AIR), []
    for t, gains in frames(array, scene, ticks):
        samples = sampler.sample(scene(t), t)
        samples = samples.only(samples.regions >= 0)
        area, asked = samples.area, samples.radiation_pressure
        assert samples.capsules is not None
        propagator.set_points(samples.positions, pc.SkinFacing(samples.normals, samples.capsules))
        made = pc.radiation_pressure(propagator.apply(gains), AIR)
        holes = float(area[made < 0.5 * asked].sum() / area.sum())
        found.append(Skin(float(asked @ area), float(made @ area), holes))
    return found


@pytest.mark.parametrize("make", [balls, twins])
def test_a_hand_on_which_contacts_split_and_merge(make: Any) -> None:
    """With nine units and 3 Pa, the force follows the target, and changes little more than it from row to row."""
    rows = on_skin(ARRAYS["nine"][0], make(3.0), 60)[12:]
    asked, made = np.array([row.asked for row in rows]), np.array([row.made for row in rows])
    most = asked.max()
    assert np.abs(made - asked).max() < 0.08 * most
    assert (np.abs(np.diff(made)) <= np.abs(np.diff(asked)) + 0.05 * most).all()
    assert max(row.holes for row in rows) < 0.1
