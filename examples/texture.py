"""A hand strokes a plate with ridges 16 mm apart: what it feels, and where."""

import math
import sys

import pacinian as pc
from pacinian import plot
from pacinian.testing import ManualClock

plate = pc.Surface(
    shape=pc.Rectangle(0.24, 0.16),
    texture=pc.grating(0.016),  # [m] between ridges
    pose=pc.Pose((0.0, 0.0, 0.204)),
    radiation_pressure=8.0,  # [Pa]
    envelope="trembling",
    name="plate",
)
array, clock = pc.autd(3, 3), ManualClock()
REST = pc.Hand.open("right", pc.Pose((0.0, -0.08, 0.226)).rotate("x", math.radians(-9.0)))


def stroke(t: float) -> pc.Scene:
    """Return the scene at time t [s]: the hand moves at 10 cm/s."""
    hand = REST.transform(pc.Pose((0.1 * t, 0.0, 0.0)))
    return pc.Scene((plate,), hands=(hand,))


with pc.Renderer(array, stroke, adaptive=False, clock=clock) as renderer:
    for tick in range(100):
        clock.time = tick * renderer.period
        renderer.tick(clock.time)
    scene, samples, gains = renderer.rendered_scene, renderer.samples, renderer.cycle_gains
assert samples is not None
P = samples.radiation_pressure
print(f"{len(P)} samples, {P.min():.1f} to {P.max():.1f} Pa by the ridge that each is on")
air = renderer.session.medium
title, top = "A textured plate", 2.0 * float(P.max())  # [Pa]: stronger places are not on the skin
page = plot.scene(array, scene, samples, gains, medium=air, t=clock.time, title=title, top=top)
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "texture.png", 256)
