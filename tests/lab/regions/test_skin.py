"""What is felt over the whole touched skin, against figures that are known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.regions.skin import measure_felt

AIR, ARRAY = pc.Air(), pc.autd()
MIDDLE = ARRAY.centre
HAND = pc.Hand.open("right", pc.Pose((MIDDLE[0], MIDDLE[1], 0.2)))


def ball(depth: float = 0.003, **how: Any) -> pc.Scene:
    pose = pc.Pose((MIDDLE[0], MIDDLE[1], 0.2 - 0.015 - 0.02 + depth))
    item = pc.Volume(shape=pc.Sphere(0.02), pose=pose, radiation_pressure=2.0, **how)
    return pc.Scene((item,), hands=(HAND,))


def solved(scene: pc.Scene) -> pc.Solution:
    sampler = pc.Sampler()
    sampler.prepare(ARRAY, AIR)
    samples = sampler.sample(scene)
    facing = pc.SkinFacing(samples.normals, samples.capsules)  # type: ignore[arg-type]
    amplitudes = pc.sound_pressure(samples.radiation_pressure, AIR)
    return pc.solve(ARRAY, samples.positions, amplitudes, regions=samples.regions, facing=facing)


def test_a_ball_in_the_palm_is_felt_as_asked_and_half_of_it_as_half() -> None:
    scene = ball()
    gains = solved(scene).gains
    whole = measure_felt(ARRAY, AIR, scene, 0.0, gains)
    half = measure_felt(ARRAY, AIR, scene, 0.0, gains * np.float32(np.sqrt(0.5)))
    assert whole is not None
    assert half is not None
    assert whole.force == pytest.approx(1.0, abs=0.05)
    assert whole.rms < 0.2
    assert half.force == pytest.approx(whole.force / 2.0, rel=1e-4)
    assert half.spill == pytest.approx(whole.spill / 2.0, rel=1e-4)


def test_silence_is_a_hole_and_what_no_hand_touches_is_nothing() -> None:
    silent = measure_felt(ARRAY, AIR, ball(), 0.0, np.zeros(len(ARRAY), np.complex64))
    assert silent == pc.FeltRegion(0.0, 1.0, 1.0, 0.0)
    gains = np.ones(len(ARRAY), np.complex64)
    assert measure_felt(ARRAY, AIR, ball(-0.01), 0.0, gains) is None
    point = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=2.0)
    assert measure_felt(ARRAY, AIR, pc.Scene((point,), hands=(HAND,)), 0.0, gains) is None
    assert measure_felt(ARRAY, AIR, pc.Scene(ball().objects), 0.0, gains) is None
