"""Quiet zones and quiet points hold in every row that is sent, at places that no solver was given."""

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

ARRAY, AIR = pc.autd(), pc.Air()
X, Y, _ = ARRAY.centre
ZONE = pc.Zone((X + 0.07, Y + 0.02, 0.2), pressure=5.0, radius=0.03)
GAP = 1.05  # excess from rounding to 65,536 levels


def look(scene: pc.Scene, **options: Any) -> Any:
    """Return the gains of all rows of 100 ticks, (K, N)."""
    clock, device = ManualClock(), Simulated(1 << 16, 1 << 16, keep=1000)
    with pc.Renderer(ARRAY, scene, backend=device, clock=clock, **options) as renderer:
        for _ in range(100):
            renderer.tick()
            clock.advance(renderer.period)
    size = device.capability.sizes
    return np.concatenate(
        [size[f.amplitude] * np.exp(2j * np.pi * f.phase / (1 << 16)) for f in device.frames]
    )


def ball_of(zone: pc.Zone) -> Any:
    rng = np.random.default_rng(7)
    d = rng.normal(size=(300, 3))
    d *= (rng.random((300, 1)) ** (1 / 3) / np.linalg.norm(d, axis=1, keepdims=True)) * zone.radius
    return np.array(zone.position) + d


@pytest.mark.parametrize("solver", ["auto", "gs-pat", "greedy"])
def test_zones_are_quiet_though_two_objects_have_different_envelopes(solver: str) -> None:
    """The sounds of the two alone need far more than full drive, and cancel in each other."""
    ball = pc.Volume(
        shape=pc.Sphere(0.02), pose=pc.Pose((X - 0.02, Y, 0.2)), radiation_pressure=20.0,
        envelope=pc.Sine(150.0),
    )  # fmt: skip
    disc = pc.Surface(
        shape=pc.Disc(0.015), pose=pc.Pose((X - 0.02, Y + 0.045, 0.2)), radiation_pressure=20.0,
        envelope=pc.Sine(37.0),
    )  # fmt: skip
    limits = pc.Limits(gain=1.0, zones=(ZONE,))
    g = look(pc.Scene((ball, disc)), solver=solver, limits=limits, adaptive=False)
    assert np.abs(g).max() <= 1.0 + 1e-6
    assert np.abs(g).max() > 0.1
    loud = np.abs(pc.matrix(ARRAY, ball_of(ZONE), AIR) @ g.T).max()
    assert loud <= GAP * ZONE.pressure


@pytest.mark.parametrize("solver", ["lagrange", "auto"])
@pytest.mark.parametrize("deadline", [1e-9, 7e-4, 3e-3, None])
def test_quiet_points_are_quiet_even_if_the_deadline_ends_the_solve(
    solver: str, deadline: float | None
) -> None:
    rng = np.random.default_rng(5)
    for count in (1, 3, 20):
        x, y = np.meshgrid(*2 * [np.arange(-0.015, 0.016, 0.003)])
        q = np.column_stack([x.ravel() + X, y.ravel() + Y, np.full(x.size, 0.2)])
        quiet = np.array([X, Y, 0.2]) + rng.uniform(-1, 1, (count, 3)) * [0.08, 0.08, 0.05]
        limits = pc.Limits(gain=1.0, quiet=(quiet, 1.0))
        solution = pc.Session(ARRAY, AIR, solver).solve(
            q, np.full(x.size, 1500.0), regions=np.zeros(x.size, int), limits=limits, deadline=deadline,
        )  # fmt: skip
        assert np.abs(solution.gains).max() <= 1.0
        # 1e-3 of full drive counts as kept
        full = np.linalg.norm(pc.matrix(ARRAY, quiet, AIR), axis=1).mean() * np.sqrt(len(ARRAY))
        loud = np.abs(pc.matrix(ARRAY, quiet, AIR) @ solution.gains)
        assert (loud <= 1.001 + 1e-3 * 0.01 * full).all()
        assert "quiet" not in solution.violations


@pytest.mark.parametrize("solid", [True, False])
def test_quiet_points_are_quiet_wherever_the_time_runs_out(solid: bool) -> None:
    """The clock jumps beyond the deadline at each of its readings in turn."""
    x, y = np.meshgrid(*2 * [np.arange(-0.01, 0.011, 0.004)])
    q = np.column_stack([x.ravel() + X, y.ravel() + Y, np.full(x.size, 0.2)])
    quiet = np.array([[X + 0.02, Y, 0.2]])
    regions = np.zeros(x.size, int) if solid else None
    late = 0
    for readings in range(1, 40):
        clock, count = ManualClock(), iter(range(1000))

        def now(clock: ManualClock = clock, count: Any = count, last: int = readings) -> float:
            return clock.now() + (10.0 if next(count) >= last else 0.0)

        session = pc.Session(ARRAY, AIR, "lagrange", clock=now)
        solution = session.solve(
            q, np.full(x.size, 800.0), regions=regions, limits=pc.Limits(gain=1.0, quiet=(quiet, 1.0)),
            deadline=1.0,
        )  # fmt: skip
        loud = np.abs(pc.matrix(ARRAY, quiet, AIR) @ solution.gains)
        assert (loud <= 1.1).all(), readings
        late += solution.late
    assert late > 2
