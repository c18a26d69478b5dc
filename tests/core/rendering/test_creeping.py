"""Samples that creep: in the background, a solve waits until they have moved a little.

The field of one object is steered instead (test_field_steering.py), so there are two here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.rendering.field_steering import MAX_MISPLACEMENT
from pacinian.rendering.sample_solver import MAX_CREEP_TIME
from pacinian.testing import ManualClock

ARRAY, NEAR = pc.autd(), MAX_MISPLACEMENT
BALL = pc.Volume(
    name="ball", shape=pc.Sphere(0.01), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=0.5
)


STILL = replace(BALL, name="still", pose=pc.Pose((0.05, 0.05, 0.15)))


class Solving:
    """Samples and solves for a ball in free air that moves beside one that does not."""

    def __init__(self) -> None:
        self.renderer = pc.Renderer(ARRAY, pc.Scene(), clock=ManualClock())
        self.renderer.sample_solver.spares_solves = True
        self.sampler = pc.Sampler()
        self.sampler.prepare(ARRAY, pc.Air())

    def at(self, x: float, t: float, **changed: Any) -> Any:
        ball = replace(BALL, pose=pc.Pose((x, 0.0, 0.15)), **changed)
        samples = self.sampler.sample(pc.Scene((ball, STILL)), t)
        solver = self.renderer.session.solver
        limits = self.renderer.limits
        return self.renderer.sample_solver.solve(samples, t, limits, solver, np.inf)


def test_a_small_movement_needs_no_solve_until_it_adds_up() -> None:
    solving = Solving()
    first = solving.at(0.0, 0.0)
    assert solving.at(2e-4, 0.01) is first
    second = solving.at(4.5e-4, 0.02)
    assert second is not first
    assert solving.at(6e-4, 0.03) is second
    assert solving.renderer.sample_solver.skipped["solve, nothing moved"] == 2


def test_movement_counts_in_all_directions_together() -> None:
    samples = pc.Sampler().sample(pc.Scene((BALL,)))
    assert samples.is_near(samples.changed(positions=samples.positions + 2e-4), NEAR)
    assert not samples.is_near(samples.changed(positions=samples.positions + 3e-4), NEAR)


def test_other_limits_are_solved_where_the_samples_are() -> None:
    solving = Solving()
    first = solving.at(0.0, 0.0)
    solving.renderer.limits = pc.Limits(gain=0.5)
    moved = solving.at(1e-4, 0.001).samples.positions - first.samples.positions
    assert moved[:, 0].max() == pytest.approx(1e-4)


def test_however_little_it_moves_the_next_solve_comes() -> None:
    solving = Solving()
    first = solving.at(0.0, 0.0)
    assert solving.at(1e-5, 0.9 * MAX_CREEP_TIME) is first
    assert solving.at(1e-5, 1.1 * MAX_CREEP_TIME) is not first


@pytest.mark.parametrize(
    "changed",
    [{"radiation_pressure": 0.6}, {"envelope": pc.Sine(100.0)}, {"shape": pc.Sphere(0.0101)}],
)
def test_another_change_needs_a_solve_at_once(changed: dict[str, Any]) -> None:
    solving = Solving()
    first = solving.at(0.0, 0.0)
    assert solving.at(1e-4, 0.001, **changed) is not first


def test_samples_are_near_only_with_the_hands_near_them() -> None:
    hand = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.16)))
    sampler = pc.Sampler()
    samples = sampler.sample(pc.Scene((BALL,), hands=(hand,)))
    assert samples.capsules is not None
    assert samples.is_near(samples, 0.0)
    moved = samples.capsules + np.where(np.arange(8) == 0, 1e-3, 0.0)
    assert not samples.is_near(samples.changed(capsules=moved), NEAR)
    assert not samples.is_near(samples.changed(capsules=samples.capsules[1:]), NEAR)
    assert not samples.is_near(samples.changed(capsules=None), NEAR)
    assert not samples.is_near(samples.only(np.arange(len(samples) - 1)), NEAR)
    assert not samples.is_near(samples.changed(regions=samples.regions + 1), NEAR)
