"""Silent samples beside a contact: where they are, and their effect on the skin there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.gallery import SCENES
from pacinian.scene.sampling import silent_samples
from pacinian.scene.sampling.array_resolution import ArrayResolution
from pacinian.scene.sampling.sample_budget import FINE_ON_SKIN, ON_SKIN
from pacinian.scene.sampling.sampler import SamplingMode
from pacinian.scene.sampling.silent_samples import (
    FAST_SURROUND,
    FINE_SURROUND,
    MAX_SECOND_RING_SAMPLES,
    MIN_RING_DISTANCE,
    MIN_RING_LIMIT,
    SECOND_RING_RADIUS,
)
from pacinian.testing import ManualClock
from pacinian_lab.regions.skin import measure_felt

AIR, ARRAY = pc.Air(), pc.autd(3, 3)


def ball(radius: float, depth: float) -> pc.Scene:
    """Return a ball that is pressed into the palm of an open hand from below."""
    hand = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.21)))
    pose = pc.Pose((0.0, 0.0, 0.195 - radius + depth))
    item = pc.Volume(shape=pc.Sphere(radius), pose=pose, radiation_pressure=6.0)
    return pc.Scene((item,), hands=(hand,))


def sampled(
    scene: pc.Scene, budget: int = 256, surround: bool = True, fine: bool = False
) -> pc.Samples:
    """Return the samples of a scene. budget: most samples on skin. fine: whether solves may take long."""
    sampler = pc.Sampler(round(budget / (FINE_ON_SKIN.shares[-1] if fine else ON_SKIN.shares[0])))
    sampler.prepare(ARRAY, AIR)
    sampler.mode = SamplingMode(surround=surround, fine=fine)
    return sampler.sample(scene, 0.0)


@pytest.mark.parametrize("fine", [False, True])
@pytest.mark.parametrize("scene", [ball(0.01, 0.003), ball(0.03, 0.004), SCENES["crowd"](0.3)])
def test_silent_samples_lie_on_skin_beside_and_change_nothing_else(
    scene: pc.Scene, fine: bool
) -> None:
    budget = 480 if fine else 256
    plain, both = (sampled(scene, budget, surround=around, fine=fine) for around in (False, True))
    silent = both.radiation_pressure == 0.0
    assert 0.1 * len(plain) < silent.sum()
    around = FINE_SURROUND if fine else FAST_SURROUND
    first = max(MIN_RING_LIMIT, around.max_ratio * len(plain))
    assert silent.sum() <= first
    assert np.array_equal(both.positions[~silent], plain.positions)
    assert np.array_equal(both.radiation_pressure[~silent], plain.radiation_pressure)
    assert both.force == pytest.approx(plain.force)
    assert len(set(both.keys.tolist())) == len(both)
    resolved = ArrayResolution(ARRAY, AIR).compute_isolated_spacing((0.0, 0.0, 0.205))
    away, nearest = KDTree(plain.positions).query(both.positions[silent])
    assert away.min() >= MIN_RING_DISTANCE * resolved
    assert away.max() < around.outer * resolved
    assert (both.regions[silent] == -2).all()
    assert np.array_equal(both.objects[silent], plain.objects[nearest])
    towards = ((ARRAY.centre - both.positions[silent]) * both.normals[silent]).sum(axis=1)
    assert towards.min() > 0.0


def test_the_budget_is_kept_and_what_touches_comes_first() -> None:
    scene = ball(0.03, 0.004)
    plain = sampled(scene, surround=False)
    some = sampled(scene, len(plain) + 5)
    assert len(plain) < len(some) <= len(plain) + 5
    assert len(sampled(scene, len(plain))) == len(plain)
    assert len(sampled(scene, 480, fine=True)) > 180
    assert len(sampled(scene, 180, fine=True)) <= 180


def test_without_a_hand_or_a_region_there_is_none() -> None:
    plate = pc.Surface(shape=pc.Disc(0.01), pose=pc.Pose((0, 0, 0.2)), radiation_pressure=1.0)
    assert sampled(pc.Scene((plate,))).radiation_pressure.min() > 0.0
    hand = ball(0.01, 0.003).hands[0]
    point = pc.Point(position=(0.0, 0.0, 0.195), radiation_pressure=5.0)
    assert sampled(pc.Scene((point,), hands=(hand,))).radiation_pressure.min() > 0.0


class Plain(pc.Solver):
    """Like `lagrange`, but declares that silent samples have full weight."""

    name = "plain"
    keeps = frozenset({"quiet", "exact"})

    def solve(self, *problem: Any) -> Any:
        return pc.solver("lagrange").solve(*problem)


def played(scene: pc.Scene, **how: Any) -> pc.Renderer:
    clock = ManualClock()
    renderer = pc.Renderer(ARRAY, scene, clock=clock, adaptive=False, **how)
    with renderer:
        for k in range(12):
            renderer.tick(k * 1e-3)
            clock.time = (k + 1) * 1e-3
    return renderer


@pytest.mark.parametrize("radius", [0.01, 0.015, 0.03])
def test_sound_keeps_off_the_skin_beside_a_ball(radius: float) -> None:
    """The reference is a solver without silent samples. Both are judged on the benchmark's skin."""
    scene, felt = ball(radius, 0.004), []
    for solver in (Plain(), "auto"):
        renderer = played(scene, solver=solver)
        found = measure_felt(ARRAY, AIR, scene, 0.012, renderer.cycle_gains)
        assert found is not None
        felt.append(found)
    without, around = felt
    assert around.spill < 0.75 * without.spill
    assert around.spill < 1.6
    assert around.rms < without.rms + 0.04
    assert around.rms < 0.1
    assert around.force == pytest.approx(1.0, abs=0.03)


def test_other_limits_and_solvers_that_count_silence_in_full_get_no_surround() -> None:
    scene = ball(0.01, 0.003)
    assert (samples_of(played(scene)).radiation_pressure == 0.0).any()
    for how in ({"solver": Plain()}, {"limits": pc.Limits(power=1000.0)}):
        assert samples_of(played(scene, **how)).radiation_pressure.min() > 0.0


def samples_of(renderer: pc.Renderer) -> pc.Samples:
    assert renderer.samples is not None
    return renderer.samples


@pytest.mark.parametrize("fine", [False, True])
@pytest.mark.parametrize("units", [(2, 1), (1, 2), (1, 1), (2, 2), (3, 2)])
def test_the_second_ring_is_for_elongated_arrays_and_for_long_solves_on_small_ones(
    units: tuple[int, int], fine: bool
) -> None:
    sampler, array = pc.Sampler(), pc.autd(*units)
    sampler.prepare(array, AIR)
    sampler.mode = SamplingMode(surround=True, fine=fine)
    samples = sampler.sample(ball(0.015, 0.003), 0.0)
    silent = samples.regions == -2
    resolved = ArrayResolution(array, AIR).compute_isolated_spacing((0.0, 0.0, 0.205))
    away = np.asarray(KDTree(samples.positions[~silent]).query(samples.positions[silent])[0])
    second = (1 in units and 2 in units) or (fine and len(array) <= 1000)
    around = FINE_SURROUND if fine else FAST_SURROUND
    assert away.max() < (SECOND_RING_RADIUS if second else around.outer) * resolved
    far = int((away > around.outer * resolved).sum())
    assert (0.4 * MAX_SECOND_RING_SAMPLES < far <= MAX_SECOND_RING_SAMPLES) if second else far == 0
    assert len(set(samples.keys.tolist())) == len(samples)


def press(array: pc.Array, scene: pc.Scene) -> Any:
    with pc.Renderer(array, scene, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(12):
            renderer.tick(k * 1e-3)
        return renderer.cycle_gains


@pytest.mark.parametrize(
    ("units", "radius"), [((2, 1), 0.015), ((2, 2), 0.01)], ids=["two units", "four units"]
)
def test_a_second_ring_keeps_sound_off_the_skin_far_beside_a_ball(
    units: tuple[int, int], radius: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The reference has silent samples close to the contact only. Both are judged on the benchmark's skin."""
    array, scene, felt = pc.autd(*units), ball(radius, 0.003), []
    for second in (False, True):
        with monkeypatch.context() as patch:
            if not second:
                patch.setattr(silent_samples, "MIN_ELONGATION", np.inf)
                around = FINE_SURROUND._replace(max_transducers=0)
                patch.setattr("pacinian.scene.sampling.sampler.FINE_SURROUND", around)
            found = measure_felt(array, AIR, scene, 0.012, press(array, scene))
        assert found is not None
        felt.append(found)
    without, now = felt
    assert now.spill < 0.5 * without.spill
    assert now.rms < without.rms + 0.04  # both have as many samples as the budget allows
    assert now.force == pytest.approx(1.0, abs=0.05)
