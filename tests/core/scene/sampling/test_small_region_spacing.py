"""Small regions: their number of samples, and the evenness that these achieve."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import pacinian as pc

AIR = pc.Air()
NINE = pc.autd(3, 3)


def disc(radius: float, x: float = 0.0) -> pc.Surface:
    return pc.Surface(
        shape=pc.Disc(radius), pose=pc.Pose((x, 0.0, 0.2)), radiation_pressure=1.0, name=f"at {x}"
    )


def sampled(*objects: Any, array: pc.Array = NINE, **how: Any) -> list[int]:
    """Return the number of samples of each object."""
    sampler = pc.Sampler(**how)
    sampler.prepare(array, AIR)
    samples = sampler.sample(pc.Scene(tuple(objects)))
    return np.bincount(samples.objects, minlength=len(objects)).tolist()


@pytest.mark.parametrize("radius", [0.005, 0.006, 0.008, 0.012])
@pytest.mark.parametrize("array", [pc.autd(), NINE], ids=["one unit", "nine"])
def test_a_small_region_is_even_between_its_samples(array: pc.Array, radius: float) -> None:
    """The target is half of the strongest even field; the test evaluates random points."""
    sampler = pc.Sampler()
    sampler.prepare(array, AIR)
    samples = sampler.sample(pc.Scene((disc(radius),)))
    t = pc.sound_pressure(samples.radiation_pressure, AIR)
    session = pc.Session(array, AIR)
    most = session.solve(samples.positions, t, regions=samples.regions, scale="max")
    t *= math.sqrt(0.5) * np.linalg.norm(most.sound_pressure) / np.linalg.norm(t)
    g = session.solve(samples.positions, t, regions=samples.regions).gains
    rng = np.random.default_rng(1)
    r, turn = radius * np.sqrt(rng.uniform(size=500)), rng.uniform(0.0, 2.0 * np.pi, 500)
    places = np.stack([r * np.cos(turn), r * np.sin(turn), np.full(500, 0.2)], axis=-1)
    P = np.abs(pc.field(array, g, places, medium=AIR, precision="double")) ** 2 / t[0] ** 2
    assert np.mean(P) == pytest.approx(1.0, abs=0.02)
    assert np.sqrt(np.mean((P - 1.0) ** 2)) < 0.045


def test_a_small_region_has_as_many_samples_as_make_it_even_and_a_large_one_no_more() -> None:
    usual = {radius: sampled(disc(radius), budget=60)[0] for radius in (0.006, 0.02)}
    assert usual[0.006] < 30
    assert 60 <= sampled(disc(0.006))[0] <= 128
    assert sampled(disc(0.02)) == sampled(disc(0.02), budget=200)
    assert sampled(disc(0.001))[0] < 30  # samples closer together would add no information


def test_small_regions_share_what_makes_them_finer() -> None:
    two = sampled(disc(0.006, -0.03), disc(0.006, 0.03))
    assert two[0] == two[1]
    assert 20 < two[0] < sampled(disc(0.006))[0]
    many = [disc(0.006, 0.02 * k) for k in range(8)]
    assert sampled(*many, budget=2000) == 8 * sampled(disc(0.006), budget=60)


def test_where_the_budget_has_no_room_no_region_gets_finer() -> None:
    large = pc.Surface(
        shape=pc.Rectangle(0.04, 0.04), pose=pc.Pose((0.0, 0.06, 0.2)), radiation_pressure=1.0
    )
    beside = sampled(disc(0.006), large, budget=256)
    assert beside == [sampled(disc(0.006), budget=60)[0], sampled(large)[0]]


def test_a_spacing_that_is_given_is_kept() -> None:
    assert sampled(disc(0.006), spacing=0.003) == sampled(disc(0.006), budget=60)


def test_the_inside_of_a_small_ball_is_filled_more_finely() -> None:
    ball = pc.Volume(
        shape=pc.Sphere(0.004), felt="interior", radiation_pressure=1.0, pose=pc.Pose((0, 0, 0.2))
    )
    assert sampled(ball)[0] > 2 * sampled(ball, budget=25)[0]


@pytest.mark.parametrize("shape", [pc.Sphere(0.0075), pc.Box((0.009, 0.009, 0.02))], ids=str)
def test_the_inside_of_a_small_solid_is_even_up_to_its_surface(shape: Any) -> None:
    """A grid alone ended up to a spacing below the surface: the rms was 0.11, and the session measured half of it."""
    solid = pc.Volume(
        shape=shape, felt="interior", radiation_pressure=1.0, pose=pc.Pose((0.0, 0.0, 0.2))
    )
    sampler = pc.Sampler()
    sampler.prepare(NINE, AIR)
    samples = sampler.sample(pc.Scene((solid,)))
    t = pc.sound_pressure(samples.radiation_pressure, AIR)
    session = pc.Session(NINE, AIR)
    most = session.solve(samples.positions, t, regions=samples.regions, scale="max")
    t *= math.sqrt(0.5) * np.linalg.norm(most.sound_pressure) / np.linalg.norm(t)
    solution = session.measure_felt(session.solve(samples.positions, t, regions=samples.regions))
    places = np.random.default_rng(1).uniform(-1.0, 1.0, (3000, 3)) * shape.extent
    places = places[shape.distance(places) < 0.0] + [0.0, 0.0, 0.2]
    P = np.abs(pc.field(NINE, solution.gains, places, AIR, precision="double")) ** 2 / t[0] ** 2
    rms = np.sqrt(np.mean((P - 1.0) ** 2))
    assert np.mean(P) == pytest.approx(1.0, abs=0.03)
    assert rms < 0.05
    assert solution.felt[0].rms == pytest.approx(rms, abs=0.02)
