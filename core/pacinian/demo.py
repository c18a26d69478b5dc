"""The built-in scene: a ball that circles above the array, around a button."""

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

HEIGHT = 0.2  # [m] above the array
ORBIT = 0.04  # [m]
TURN = 2.0  # [s]
TREMBLE = Sine(frequency=150.0)

BALL = Volume(shape=Sphere(0.010), radiation_pressure=8.0, envelope=TREMBLE, name="ball")
BUTTON = Surface(
    shape=Disc(0.0085), pose=Pose((0.0, 0.0, HEIGHT)), force=0.004, envelope=TREMBLE, name="button"
)


def circling(t: float) -> Scene:
    """The scene at time t [s], both trembling."""
    phi = 2.0 * math.pi * t / TURN
    at = Pose((ORBIT * math.cos(phi), ORBIT * math.sin(phi), HEIGHT))
    return Scene((replace(BALL, pose=at), BUTTON))


def alternate(
    renderer: Renderer, seconds: float, on_tick: Callable[[Report], object] | None = None
) -> Report:
    """Run `renderer` for `seconds` [s], second by second in turn with a loop that only burns time.

    The dummy loop has the same clock, rate and progress bar, and each of its ticks is as long as the
    renderer's median tick: what it is late by is the machine's doing. Returns its report.
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
            burnt.tick(end - begin, end > due)
            if on_tick is not None:
                on_tick(renderer.report)
        left -= part
    return burnt
