"""The force of a point acts on the area of the array's focus there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.scene.modulation.technique import STM
from pacinian.scene.objects import SPOT, Particles
from pacinian.scene.sampling.sampler import SamplingMode
from pacinian.testing import ManualClock

AIR, FORCE = pc.Air(), 2e-3  # [N]
PLACE, OTHER = (0.02, 0.0, 0.2), (-0.03, 0.02, 0.2)  # [m]


def sampled(array: pc.Array, *items: Any, hands: Any = (), **mode: Any) -> pc.Samples:
    sampler = pc.Sampler(perception=False)
    sampler.prepare(array, AIR)
    sampler.mode = SamplingMode(**mode)
    scene = pc.Scene(items, hands=hands)
    sampler.sample(scene)
    return sampler.sample(scene, 1.0)  # after the ramp of the hand


@pytest.mark.parametrize("units", [1, 3])
def test_a_point_presses_with_its_force_over_the_focus_of_the_array(units: int) -> None:
    array = pc.autd(units, units)
    for even in (0.0, 1.0):
        found = sampled(array, pc.Point(position=PLACE, force=FORCE), max_uniform_points=even)
        area = pc.focal_area(array, [PLACE], medium=AIR, uniform=even > 0.0)
        assert found.radiation_pressure == pytest.approx(FORCE / area)
        assert found.most == pytest.approx(FORCE / area)
        assert found.force == pytest.approx(FORCE)


def test_a_larger_disc_is_felt_from_farther_and_not_more_weakly() -> None:
    small, large = (pc.Point(position=PLACE, force=FORCE, area=k * SPOT) for k in (1.0, 4.0))
    P = [sampled(pc.autd(), point).radiation_pressure[0] for point in (small, large)]
    assert P[0] == pytest.approx(P[1])


def test_how_many_sound_at_a_time_decides_how_wide_a_focus_is() -> None:
    points = [pc.Point(position=place, force=FORCE) for place in (PLACE, OTHER)]
    crowd = Particles(positions=(PLACE, OTHER), force=FORCE)
    for items in (points, [crowd]):
        found = sampled(pc.autd(), *items)
        wide = pc.focal_area(pc.autd(), found.positions, medium=AIR)
        np.testing.assert_allclose(found.radiation_pressure, FORCE / wide, rtol=1e-6)
    turns = Particles(positions=(PLACE, OTHER), force=FORCE, technique=STM(100.0))
    found = sampled(pc.autd(), turns)
    narrow = pc.focal_area(pc.autd(), found.positions, medium=AIR, uniform=True)
    np.testing.assert_allclose(found.radiation_pressure, FORCE / narrow, rtol=1e-6)


def test_on_a_hand_the_area_is_that_on_its_skin() -> None:
    palm = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.2)))
    found = sampled(pc.autd(), pc.Point(position=(0.0, 0.0, 0.19), force=FORCE), hands=(palm,))
    assert len(found) == 1
    (area,) = pc.focal_area(pc.autd(), found.positions, AIR, found.normals, uniform=True)
    assert found.area[0] == pytest.approx(area)
    assert found.force == pytest.approx(FORCE)


def test_pressures_that_are_given_stay_and_forces_are_held_to_the_most() -> None:
    given = pc.Point(position=PLACE, radiation_pressure=7.0)
    assert sampled(pc.autd(), given, peak=5.0).radiation_pressure[0] == 7.0
    forced = pc.Point(position=PLACE, force=FORCE)
    assert sampled(pc.autd(), forced, peak=5.0).radiation_pressure[0] == 5.0


def test_where_no_focus_can_be_the_objects_own_disc_counts() -> None:
    array = pc.autd()
    forced = pc.Point(position=PLACE, force=FORCE)
    on = pc.Point(position=tuple(array.positions[5].tolist()), force=FORCE)
    (one,) = sampled(pc.Array([[0.0, 0.0, 0.0]]), forced).radiation_pressure
    assert one == pytest.approx(FORCE / SPOT)
    usual, own = sampled(array, forced, on).radiation_pressure
    assert usual == pytest.approx(FORCE / pc.focal_area(array, [PLACE], medium=AIR)[0])
    assert own == pytest.approx(FORCE / SPOT)
    assert pc.Sampler().sample(pc.Scene((forced,))).radiation_pressure == pytest.approx(
        FORCE / SPOT
    )


@pytest.mark.parametrize("solver", ["auto", "lagrange"])
def test_the_loop_asks_for_the_pressure_of_the_focus_that_its_solver_makes(solver: str) -> None:
    scene, clock = pc.Scene((pc.Point(position=PLACE, force=FORCE),)), ManualClock()
    with pc.Renderer(pc.autd(), scene, solver=solver, clock=clock) as loop:
        for _ in range(100):
            loop.tick()
            clock.advance(loop.period)
        P = pc.radiation_pressure(loop.compute_pressures(np.array([PLACE])), AIR)
    (area,) = pc.focal_area(pc.autd(), [PLACE], pc.Air(), uniform=solver == "auto")
    assert P.max() * area == pytest.approx(FORCE, rel=0.02)
