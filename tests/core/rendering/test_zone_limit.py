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
        assert play(renderer, 0, 40) <= ZONE.pressure
        scaled = any(one.limited_in_zones for one in renderer.played.rows)
    told = {reason for reasons in renderer.report.deviations.totals.values() for reason in reasons}
    assert (REASON in told) is scaled
    assert scaled is (min(phases, amplitudes) < 256)
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
        assert 0.0 < play(renderer, 0, 60) <= ZONE.pressure
        coarse.open(ARRAY)
        renderer.use(coarse).close()
        assert play(renderer, 60, 60) <= ZONE.pressure
        coarse.close()


def test_a_strength_that_the_levels_allow_is_kept() -> None:
    """With 16 phases, rounding grows with the gains, so that weaker ones keep the limit."""
    scene = press((X - 0.02, Y, 0.2), (X + 0.01, Y - 0.04, 0.18))
    with render(scene, Simulated(rate=1000.0, phases=16)) as renderer:
        play(renderer, 0, 40)
        gains = renderer.emitted_gains
    P = pc.radiation_pressure(pc.field(ARRAY, gains, np.array([[X - 0.02, Y, 0.2]]), AIR), AIR)
    assert 0.0 < P[0] < 4.0
