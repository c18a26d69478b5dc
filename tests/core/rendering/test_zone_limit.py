"""Quiet zones after rounding: no device with few levels makes them louder than their limit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.rendering.zone_limit import TOO_COARSE
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

AIR, ARRAY, TICK = pc.Air(), pc.autd(), 1e-3
X, Y = ARRAY.centre[:2].tolist()
ZONE = pc.Zone((X + 0.06, Y + 0.02, 0.25), pressure=5.0, radius=0.02)
LIMITS = pc.Limits(gain=1.0, zones=[ZONE])
LEVELS = [(256, 256), (16, 256), (256, 16), (64, 64), (16, 4), (16, 2)]
REASON = "limited in quiet zones"
UNSEEN = 1.25  # factor by which places and strengths that the loop has not looked at may be louder


def find_places(count: int = 400) -> Any:
    """Return random places in the zone, (count, 3) [m]; the code searches others."""
    chance = np.random.default_rng(5)
    away = chance.normal(size=(count, 3))
    away *= (ZONE.radius * np.cbrt(chance.uniform(size=count)) / np.linalg.norm(away, axis=1))[
        :, None
    ]
    return np.array(ZONE.position) + away


PLACES = find_places()


def press(*places: tuple[float, float, float], **how: Any) -> pc.Scene:
    return pc.Scene(
        tuple(pc.Point(position=place, radiation_pressure=4.0, **how) for place in places)
    )


def play(renderer: pc.Renderer, first: int, ticks: int) -> float:
    """Return the highest sound pressure at the places of the zone in so many ticks [Pa]."""
    loudest = 0.0
    for k in range(first, first + ticks):
        renderer.tick(k * TICK)
        for gains in renderer.last_frame.gains(renderer.backend.capability):
            loudest = max(loudest, float(np.abs(pc.field(ARRAY, gains, PLACES, AIR)).max()))
    return loudest


def render(scene: pc.Scene, device: Simulated, limits: pc.Limits = LIMITS) -> pc.Renderer:
    return pc.Renderer(
        ARRAY, scene, backend=device, limits=limits, clock=ManualClock(), adaptive=False
    )


@pytest.mark.parametrize("solver", ["lagrange", "gs-pat"])
@pytest.mark.parametrize(("phases", "amplitudes"), LEVELS)
def test_no_device_is_louder_in_a_zone_than_its_limit(
    phases: int, amplitudes: int, solver: str
) -> None:
    scene = press((X - 0.02, Y, 0.2), (X + 0.01, Y - 0.04, 0.18))
    renderer = render(scene, Simulated(rate=1000.0, phases=phases, amplitudes=amplitudes))
    renderer.session.solver = solver
    with renderer:
        assert play(renderer, 0, 40) <= UNSEEN * ZONE.pressure
        scaled = any(one.limited_in_zones for one in renderer.played.rows)
    told = {reason for reasons in renderer.report.deviations.totals.values() for reason in reasons}
    assert (REASON in told) is scaled
    if (phases, amplitudes) == (256, 256):
        assert not scaled
    if amplitudes < 64:
        assert scaled
    if scaled:
        assert renderer.solution is not None
        assert renderer.solution.note.startswith(TOO_COARSE)


def test_without_a_zone_a_coarse_device_presses() -> None:
    """And it is loud where the zone would be, so that the test above can fail."""
    scene = press((X - 0.02, Y, 0.2), (X + 0.01, Y - 0.04, 0.18))
    coarse = Simulated(rate=1000.0, phases=16, amplitudes=2)
    renderer = render(scene, coarse, pc.Limits(gain=1.0))
    with renderer:
        assert play(renderer, 0, 20) > 2.0 * ZONE.pressure
    assert REASON not in str(renderer.report.deviations.totals)


@pytest.mark.parametrize("adaptive", [False, True])
def test_a_coarse_device_that_takes_over_is_never_too_loud(adaptive: bool) -> None:
    scene = press((X - 0.02, Y, 0.2), (X + 0.01, Y - 0.04, 0.18))
    fine, coarse = Simulated(rate=1000.0), Simulated(rate=1000.0, phases=16, amplitudes=2)
    renderer = pc.Renderer(
        ARRAY, scene, backend=fine, limits=LIMITS, clock=ManualClock(), adaptive=adaptive
    )
    with renderer:
        assert 0.0 < play(renderer, 0, 60) <= UNSEEN * ZONE.pressure
        coarse.open(ARRAY)
        renderer.use(coarse).close()
        assert play(renderer, 60, 60) <= UNSEEN * ZONE.pressure
        coarse.close()


def test_a_strength_that_the_levels_allow_is_kept() -> None:
    """With 16 phases, rounding grows with the gains, so that weaker ones keep the limit."""
    scene = press((X - 0.02, Y, 0.2), (X + 0.01, Y - 0.04, 0.18))
    with render(scene, Simulated(rate=1000.0, phases=16)) as renderer:
        play(renderer, 0, 40)
        gains = renderer.emitted_gains
    P = pc.radiation_pressure(pc.field(ARRAY, gains, np.array([[X - 0.02, Y, 0.2]]), AIR), AIR)
    assert 0.0 < P[0] < 4.0


@pytest.mark.parametrize("amplitudes", [2, 4, 256])
@pytest.mark.parametrize("envelope", [pc.Constant(0.3), pc.Sine(60.0)])
def test_envelopes_are_rounded_as_quietly(amplitudes: int, envelope: pc.Envelope) -> None:
    """A focus at the limit of all transducers is on the top level, without an error, until an envelope weakens it."""
    scene = pc.Scene(
        (
            pc.Point(
                position=(X - 0.02, Y, 0.2), radiation_pressure=400.0, envelope=envelope, name="a"
            ),
        )
    )
    zone = pc.Zone((X + 0.06, Y + 0.03, 0.22), pressure=60.0, radius=0.015)
    places = np.array(zone.position) + (PLACES - np.array(ZONE.position)) * 0.75
    device = Simulated(rate=1000.0, amplitudes=amplitudes)
    with render(scene, device, pc.Limits(gain=1.0, zones=[zone])) as renderer:
        loudest = 0.0
        for k in range(50):
            renderer.tick(k * TICK)
            for gains in renderer.last_frame.gains(device.capability):
                loudest = max(loudest, float(np.abs(pc.field(ARRAY, gains, places, AIR)).max()))
    assert loudest <= UNSEEN * zone.pressure


def test_what_sounds_is_rounded_as_it_was_judged() -> None:
    """Each solution is turned to the one before, by whole levels of phase, so that its levels turn with it."""

    def scene(t: float) -> pc.Scene:
        angle = 40.0 * min(t, 0.03)
        x, y = 0.02 * np.cos(angle), 0.02 * np.sin(angle)
        return press((X + x, Y + y, 0.2), (X - y, Y + x, 0.19))

    device = Simulated(rate=1000.0, phases=16)
    with render(scene, device) as renderer:  # type: ignore[arg-type]
        assert play(renderer, 0, 60) <= UNSEEN * ZONE.pressure
        emitted = renderer.last_frame.gains(device.capability)[-1]
        judged = renderer.emitted_gains
    turn = np.vdot(judged, emitted)
    assert abs(turn) > 0.0
    assert np.abs(emitted - turn / abs(turn) * judged).max() < 1e-5
    assert (16.0 * np.angle(turn) / (2.0 * np.pi)) % 1.0 == pytest.approx(0.0, abs=1e-3) or (
        16.0 * np.angle(turn) / (2.0 * np.pi)
    ) % 1.0 == pytest.approx(1.0, abs=1e-3)
