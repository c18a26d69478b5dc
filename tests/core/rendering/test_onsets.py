"""What the whole loop emits while objects appear, vanish, hop or vibrate: no step is larger than the ramp's."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import pacinian as pc
from pacinian.plugins.backend import MAX_LEVELS, Capability
from pacinian.rendering.rerender import CaptureBackend
from pacinian.scene.modulation.envelope import STEADY
from pacinian.scene.sampling.ramps import RAMP_TIME
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.modulation.envelope import Envelope
    from pacinian.types import Gains

ARRAY = pc.autd()
EVENT = 0.012  # time at which the scene changes [s]
QUIET = 0.025  # silence between two owners [s]
HERE, THERE = (0.0, 0.0, 0.2), (0.03, 0.0, 0.2)  # [m]
FIVE_PLACES = tuple((0.02 * k - 0.04, 0.01 * (k % 2), 0.2) for k in range(5))
FOCUS = pc.matrix(ARRAY, [HERE, THERE], pc.Air())
STEEPEST = math.sin(math.pi / 10.0)  # of a raised cosine in 5 ticks: a quarter of a sine
SLACK = 0.02  # a solution of several points varies a little


def point(
    position: tuple[float, float, float] = HERE, pressure: float = 20.0, name: str = "one",
    envelope: Envelope = STEADY,
) -> pc.Point:  # fmt: skip
    return pc.Point(position=position, radiation_pressure=pressure, name=name, envelope=envelope)


STAYS = point(THERE, name="stays")
EMPTY, ONE, FAINT = pc.Scene(), pc.Scene((point(),)), pc.Scene((point(pressure=0.05),))
FIVE = pc.Scene(tuple(point(place, 4.0, str(k)) for k, place in enumerate(FIVE_PLACES)))
OTHER = pc.Scene((point(THERE, name="other"),))


def after(before: pc.Scene, then: pc.Scene) -> Callable[[float], pc.Scene]:
    """Return a scene that is `before` until the event, and `then` afterwards."""
    return lambda t: before if t < EVENT else then


EVENTS: dict[str, Callable[[float], pc.Scene]] = {
    "a point appears": after(EMPTY, ONE),
    "a point vanishes": after(ONE, EMPTY),
    "a weak point appears": after(EMPTY, FAINT),
    "a weak point vanishes": after(FAINT, EMPTY),
    "five points, armed": after(EMPTY, FIVE),
    "five points, disarmed": after(FIVE, EMPTY),
    "another owner": lambda t: ONE if t < EVENT else EMPTY if t < EVENT + QUIET else OTHER,
    "a point hops 30 mm": after(ONE, pc.Scene((point(THERE),))),
    "a point appears beside another": after(pc.Scene((STAYS,)), pc.Scene((STAYS, point()))),
    "a point drops to half its pressure": after(ONE, pc.Scene((point(pressure=10.0),))),
}


def collect_gains(scene: Callable[[float], pc.Scene] | pc.Scene, rows: int, ticks: int) -> Gains:
    """Return the rows of gains, (ticks * rows, N), of a device with so many levels that rounding does not matter."""
    device = CaptureBackend(Capability(MAX_LEVELS, MAX_LEVELS, rate=1000.0 * rows))
    made: list[Gains] = []
    with pc.Renderer(ARRAY, scene, backend=device, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(ticks):
            device.frame = None
            renderer.tick(k * renderer.period)
            if device.frame is None:  # the tick repeated the last frame
                made.append(np.repeat(made[-1][-1:], rows, axis=0))
            else:
                made.append(device.frame.gains(device.capability))
    assert not renderer.report.faults
    return np.concatenate(made)


@pytest.mark.parametrize("rows", [1, 2, 16])
@pytest.mark.parametrize("event", EVENTS)
def test_no_step_is_larger_than_that_of_the_ramp(event: str, rows: int) -> None:
    p = np.abs(collect_gains(EVENTS[event], rows, ticks=50) @ FOCUS.T)
    assert np.abs(np.diff(p, axis=0)).max() <= p.max() * (STEEPEST / rows + SLACK)


@pytest.mark.parametrize("rows", [1, 4])
@pytest.mark.parametrize("strength", ["a point", "a weak point"])
def test_strong_or_weak_it_is_there_and_silent_again_after_the_ramp(
    strength: str, rows: int
) -> None:
    first, last = round(1000 * EVENT) * rows, round(1000 * (EVENT + RAMP_TIME)) * rows - 1
    comes = collect_gains(EVENTS[f"{strength} appears"], rows, ticks=30)
    goes = collect_gains(EVENTS[f"{strength} vanishes"], rows, ticks=30)
    assert not comes[:first].any()
    assert comes[first].any()
    full = np.abs(comes[-1] @ FOCUS[0])
    shape = np.abs(comes @ FOCUS[0]) / full
    assert shape[last:] == pytest.approx(1.0, abs=1e-4)
    assert shape[first - 1 + rows : last + 1 : rows] == pytest.approx(
        np.sin(np.pi / 10.0 * np.arange(1, 6)), abs=1e-4
    )
    assert np.abs(goes[first - 1] @ FOCUS[0]) == pytest.approx(full, rel=1e-4)
    assert not goes[last:].any()


def test_what_stays_is_not_disturbed_by_what_comes_with_another_envelope() -> None:
    alone, both = pc.Scene((STAYS,)), pc.Scene((STAYS, point(envelope=pc.Sine(20.0))))
    for scene in (after(alone, both), after(both, alone)):
        made = collect_gains(scene, 4, ticks=30)[32:]  # after its own ramp
        p = np.abs(made @ FOCUS[1])
        assert p == pytest.approx(p[-1], rel=0.01)


def test_two_envelopes_come_and_go_together() -> None:
    both = pc.Scene((STAYS, point(envelope=pc.Sine(100.0))))
    for scene in (after(EMPTY, both), after(both, EMPTY)):
        p = np.abs(collect_gains(scene, 2, ticks=30) @ FOCUS.T)
        assert np.abs(np.diff(p, axis=0)).max() <= p.max() * (STEEPEST / 2.0 + 0.16)


@pytest.mark.parametrize("frequency", [100.0, 200.0])
def test_a_square_wave_has_no_step_of_more_than_half(frequency: float) -> None:
    scene = pc.Scene((point(envelope=pc.Square(frequency)),))
    p = np.abs(collect_gains(scene, 2, ticks=60)[40:] @ FOCUS[0])
    assert np.abs(np.diff(p)).max() <= 0.51 * p.max()
