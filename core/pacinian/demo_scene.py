"""The demo's scene: a ball that circles a button above the array."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from pacinian.acoustics.pose import Pose
from pacinian.rendering.report import Report
from pacinian.scene.modulation.envelope import Sine
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.scene import Scene
from pacinian.scene.shapes import Disc, Sphere

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.rendering.renderer import Renderer

HEIGHT = 0.2  # height above the array [m]
ORBIT = 0.04  # radius of the ball's orbit [m]
TURN = 2.0  # period of the orbit [s]
HUM = Sine(frequency=150.0)

BALL = Volume(shape=Sphere(0.010), radiation_pressure=8.0, envelope=HUM, name="ball")
BUTTON = Surface(
    shape=Disc(0.0085), pose=Pose((0.0, 0.0, HEIGHT)), force=0.004, envelope=HUM, name="button"
)


def make_circling_scene(t: float) -> Scene:
    """Return the scene at time t [s]; both objects vibrate."""
    phi = 2.0 * math.pi * t / TURN
    at = Pose((ORBIT * math.cos(phi), ORBIT * math.sin(phi), HEIGHT))
    return Scene((replace(BALL, pose=at), BUTTON))


def alternate(
    renderer: Renderer, seconds: float, on_tick: Callable[[Report], object] | None = None
) -> Report:
    """Run `renderer` for `seconds` [s], alternating every second with a dummy loop that only burns time.

    The dummy loop has the same clock, rate and progress bar, and each of its ticks is as long as the renderer's median
    tick. Therefore its late ticks are due to the machine. Returns the report of the dummy loop.
    """
    clock, burnt = renderer.clock, Report()
    left = seconds
    while left > 0.0 and not renderer.report.interrupted:
        part = min(1.0, left)
        renderer.run(part, on_tick)
        length = renderer.report.tick_ms(50) * 1e-3  # [s]
        due = clock.now()
        for _ in range(round(part / renderer.period)):
            clock.wait_until(due)
            begin = clock.now()
            while clock.now() < begin + length:
                pass
            end = clock.now()
            due += renderer.period
            burnt.count_tick(end - begin, end > due)
            if on_tick is not None:
                on_tick(renderer.report)
        left -= part
    return burnt
