"""The pressure on all touched skin of a hand on a ball, at contacts for which no setting was tuned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import pacinian as pc
from pacinian.scene.hands.skin_cache import get_skin
from pacinian.testing import ManualClock
from pacinian_lab.regions.skin import measure_felt

if TYPE_CHECKING:
    from pacinian.types import Floats

AIR, ARRAY, TICK = pc.Air(), pc.autd(3, 3), 1e-3  # [s]
PALM, TIPS = 0, (5, 10, 15, 20, 25)  # joints


def turned(rng: np.random.Generator) -> pc.Pose:
    """Draw a pose above the middle of the array, up to 25 degrees from level, with any direction of the fingers."""
    x, y, z = rng.uniform(-1.0, 1.0, 3) * (0.2, 0.2, 1.5)
    w = np.sqrt(max(0.0, 1.0 - x * x - y * y)) * np.cos(z)
    q = np.array([w, x, y, np.sin(z)])
    place = [*(ARRAY.centre[:2] + rng.uniform(-0.02, 0.02, 2)), rng.uniform(0.18, 0.25)]
    return pc.Pose(tuple(place), tuple(q / np.linalg.norm(q)))


def press(rng: np.random.Generator, joint: int, radius: float) -> pc.Scene:
    """Return a ball that is pressed 2.5 to 4 mm into the skin that faces down near a joint."""
    hand = pc.Hand.open("right", turned(rng))
    assert hand.joints is not None
    skin = get_skin(hand).place(hand)
    near = np.linalg.norm(skin.points - hand.joints[joint], axis=1) < (
        0.03 if joint == PALM else 0.01
    )
    down: Floats = np.where(near, skin.normals[:, 2], 1.0)
    at = int(down.argmin())
    place = skin.points[at] + skin.normals[at] * (radius - rng.uniform(0.0025, 0.004))
    ball = pc.Volume(shape=pc.Sphere(radius), pose=pc.Pose(tuple(place)), radiation_pressure=4.0)
    return pc.Scene((ball,), hands=(hand,))


@pytest.mark.parametrize("tip", [False, True], ids=["palm", "tip"])
@pytest.mark.parametrize("seed", [11, 12, 15])
def test_a_ball_is_felt_as_asked_all_over_the_touched_skin(seed: int, tip: bool) -> None:
    rng = np.random.default_rng(seed)
    joint = int(rng.choice(TIPS)) if tip else PALM
    scene = press(rng, joint, rng.uniform(0.012, 0.03))
    clock = ManualClock()
    with pc.Renderer(ARRAY, scene, medium=AIR, clock=clock, adaptive=False) as renderer:
        for k in range(12):
            renderer.tick(k * TICK)
            clock.time = (k + 1) * TICK
        felt = measure_felt(ARRAY, AIR, scene, 12 * TICK, renderer.cycle_gains)
    assert felt is not None
    assert felt.force == pytest.approx(1.0, abs=0.03)
    assert (
        felt.rms < 0.11
    )  # with samples 1.75 mm apart and the phases of a wave, it is 0.08 to 0.18
    assert felt.holes == 0.0
