"""Measure the audible noise of moving scenes, with and without smooth output."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian import gallery
from pacinian.acoustics.audibility import compute_envelope, measure_audible
from pacinian.plugins.registry import backend
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.objects import Point
from pacinian.scene.sampling.ramps import RAMP_TIME
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.types import Floats, Gains

TICKS, WARM = 600, 100  # ticks at 1 kHz; the first WARM are not evaluated
ROWS = 2  # frames per tick
FOCUS = np.array([[0.0, 0.0, gallery.HEIGHT]])  # [m]
AROUND = np.arange(12) * math.tau / 12
EARS = np.stack([0.36 * np.cos(AROUND), 0.36 * np.sin(AROUND), np.full(12, 0.35)], axis=1)
"""A ring of positions, half a metre away [m], (12, 3): at a single position, sound may cancel."""
STILL = Point(position=(0.0, 0.0, gallery.HEIGHT), radiation_pressure=20.0, name="still")


@dataclass(frozen=True)
class Sound:
    """Audible energy over mean square of |p|^2 [dB(A)], at a focus that stays and at ears all round.

    Each is given without smooth output, with only the phase aligned, and with full smoothing, which adds limits and
    ramps.
    """

    what: str
    focus: tuple[float, float, float]
    ear: tuple[float, float, float]


def circle_focus(t: float) -> Scene:
    """A focus that stays, and one that circles 2 cm away at 0.2 m/s."""
    turn = 10.0 * t  # [rad]
    at = 0.02 * math.cos(turn) + 0.03, 0.02 * math.sin(turn), gallery.HEIGHT
    return Scene((STILL, Point(position=at, radiation_pressure=20.0, name="moves")))


def blink_focus(t: float) -> Scene:
    """A focus that stays, and one that blinks ten times per second."""
    other = Point(position=(0.03, 0.0, gallery.HEIGHT), radiation_pressure=20.0, name="blinks")
    return Scene((STILL, other) if t * 10.0 % 1.0 < 0.5 else (STILL,))


def hop_focus(t: float) -> Scene:
    """A focus that stays, and one that hops among five places twenty times per second."""
    x = (-0.04, 0.03, -0.02, 0.04, 0.02)[int(t * 20.0) % 5]
    other = Point(position=(x, 0.02, gallery.HEIGHT), radiation_pressure=20.0, name="hops")
    return Scene((STILL, other))


CASES = {
    "one focus stays, one circles": circle_focus,
    "one focus stays, one blinks": blink_focus,
    "one focus stays, one hops": hop_focus,
}
WAYS = (
    (0.0, Smoothing(rate=None, align=False)),
    (0.0, Smoothing(rate=None)),
    (RAMP_TIME, Smoothing()),
)


def measure(array: Array) -> list[Sound]:
    """Measure all cases."""
    made: list[Sound] = []
    for what, scene in CASES.items():
        found = np.array([_heard(array, scene, ramp, smoothing) for ramp, smoothing in WAYS])
        ear = 10.0 * np.log10((10.0 ** (found[:, 1:] / 10.0)).mean(axis=1))
        (a, b, c), (d, e, f) = found[:, 0].round(1).tolist(), ear.round(1).tolist()
        made.append(Sound(what, (a, b, c), (d, e, f)))
    return made


def _heard(
    array: Array, scene: Callable[[float], Scene], ramp: float, smoothing: Smoothing
) -> Floats:
    device = backend("simulated", rate=1000.0 * ROWS, keep=TICKS)
    clock, sampler = ManualClock(), Sampler(ramp=ramp)
    renderer = Renderer(
        array, scene, backend=device, sampler=sampler, smoothing=smoothing, clock=clock
    )
    frames: list[Gains] = []
    with renderer:
        for k in range(TICKS):
            renderer.tick(k * renderer.period)
            if k >= WARM:
                frames.append(renderer.last_frame.gains(device.capability))
    e, rate = compute_envelope(
        np.concatenate(frames),
        1000.0 * ROWS,
        array,
        np.concatenate([FOCUS, EARS]),
        renderer.session.medium,
    )
    return measure_audible(e, rate)
