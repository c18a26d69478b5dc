"""The renderer's status."""

import dataclasses
from typing import Any

import msgspec
import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.propagation import matrix
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.serving.render.renderer_status import make_status
from pacinian.testing import ManualClock
from pacinian.wire.state import State
from pacinian_plugins.backends.simulated import Simulated

from ...rendering.manual_background import solve_beside

ARRAY = pc.autd()
A = pc.Point(position=(0.03, 0.0, 0.15), radiation_pressure=4.0, name="a")
B = pc.Point(position=(-0.03, 0.0, 0.15), radiation_pressure=2.0, name="b")
FAR = pc.Point(position=(0.0, 0.0, 20.0), radiation_pressure=2.0, name="far")
OTHERS = {
    "sequence": 1, "time": 0.0, "output": "sounding", "armed": True, "owner": "", "scene": "",
    "backend": "", "technique": "", "intensity": 1.0,
}  # fmt: skip


def floats(data: bytes, columns: int = 1) -> np.ndarray[Any, Any]:
    return np.frombuffer(data, "<f4").reshape(-1, columns)


def ticked(scene: Any, ticks: int = 3, **options: Any) -> pc.Renderer:
    options = {"sampler": pc.Sampler(), "clock": ManualClock(), "backend": Simulated(), **options}
    renderer = pc.Renderer(ARRAY, scene, **options)
    renderer.open()
    for k in range(ticks):
        renderer.tick(k / 1000.0)
    return renderer


def test_it_is_a_state_and_says_what_is_emitted() -> None:
    renderer = ticked(pc.Scene((FAR, A, B)), 10)
    found = make_status(renderer, 0.01)
    told = msgspec.convert({"type": "state", **OTHERS, **found}, State)
    np.testing.assert_allclose(floats(told.points, 3), [A.position, B.position])
    np.testing.assert_allclose(floats(told.asked)[:, 0], [4.0, 2.0])
    assert [told.objects[i] for i in np.frombuffer(told.index, "<i4")] == ["a", "b"]
    device = renderer.backend
    assert isinstance(device, Simulated)
    p = device.field(
        floats(told.points, 3), pc.Air()
    )  # the device's own levels, in double precision
    achieved = floats(told.achieved)[:, 0]
    np.testing.assert_allclose(achieved, pc.radiation_pressure(p, pc.Air()), rtol=1e-3)
    np.testing.assert_allclose(achieved, [4.0, 2.0], rtol=0.05)
    assert 0.0 < told.error < 0.05
    assert told.status in ("ok", "approximate")
    assert (told.ticks, told.frames, told.solver) == (10, 10, "auto")
    assert told.skipped["solve, nothing moved"] > 0
    renderer.close()


def test_on_skin_only_what_presses_counts() -> None:
    ball = pc.Volume(shape=pc.Sphere(0.03), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=3.0)
    hand = pc.Hand.open(pose=pc.Pose((0.0, 0.0, 0.16)))
    renderer = ticked(pc.Scene((ball,), hands=(hand,)))
    told, samples = make_status(renderer, 0.003), renderer.samples
    assert samples is not None
    assert samples.capsules is not None
    assert len(samples)
    facing = SkinFacing.of(samples.normals, samples.capsules)
    weights = facing.weights(samples.positions, ARRAY.positions)
    every = (matrix(ARRAY, samples.positions, pc.Air()) * weights) @ renderer.cycle_gains.T
    p = np.sqrt((np.abs(every) ** 2).mean(axis=1))
    shown = samples.regions != -2  # silent samples beside the contact are not published
    assert 0 < (~shown).sum() < shown.sum()
    achieved = floats(told["achieved"])[:, 0]
    np.testing.assert_allclose(achieved, pc.radiation_pressure(p[shown], pc.Air()), rtol=1e-3)
    np.testing.assert_allclose(floats(told["hands"], 3), hand.joints, atol=1e-6)
    renderer.close()


def test_hands_are_carried_on_and_lost_ones_left_out() -> None:
    hand = pc.Hand.open(pose=pc.Pose((0, 0, 0.2)), velocities=(1.0, 0.0, 0.0), time=0.0)
    lost = pc.Hand(np.full((26, 3), np.nan), side="left")
    renderer = ticked(pc.Scene(hands=(lost, hand)))
    joints = floats(make_status(renderer, 0.02)["hands"], 3)
    assert hand.joints is not None
    np.testing.assert_allclose(joints, hand.joints + np.array([0.02, 0.0, 0.0]), atol=1e-6)
    renderer.close()


def test_a_touch_goes_on_while_a_slow_solve_is_for_hands_of_long_ago() -> None:
    def at(t: float) -> pc.Scene:
        ball = pc.Volume(
            name="ball",
            shape=pc.Sphere(0.03),
            pose=pc.Pose((0.0, 0.0, 0.15)),
            radiation_pressure=3.0,
        )
        return pc.Scene((ball,), hands=(pc.Hand.open(pose=pc.Pose((0.0, 0.0, 0.16)), time=t),))

    renderer = ticked(at, adaptive=True)
    background = solve_beside(renderer)
    for k in range(3, 6):
        renderer.tick(k / 1000.0)
    background.ready = False
    renderer.tick(1.0)
    told = make_status(renderer, 1.0)
    assert renderer.rendered_scene.hands[0].time == pytest.approx(0.005, abs=0.003)
    assert floats(told["hands"], 3).shape == (26, 3)
    assert [touch["object"] for touch in told["touches"]] == ["ball"]
    renderer.close()


def test_silence_has_no_points_and_a_fault_is_told() -> None:
    renderer = ticked(pc.Scene())
    told = make_status(renderer, 0.003)
    assert "points" not in told
    assert told["fault_count"] == 0
    renderer.scene = pc.Scene((A,))
    renderer.tick(0.003)
    device = renderer.backend
    assert isinstance(device, Simulated)
    device.disconnect()
    renderer.tick(0.004)
    told = make_status(renderer, 0.005)
    assert "points" not in told
    assert told["fault_count"] == 1
    assert "disconnected" in told["faults"][0]
    device.reconnect()
    renderer.close()


def test_times_of_ticks_are_of_the_last_second() -> None:
    clock = ManualClock()
    device = Simulated(wait=clock.advance)
    renderer = ticked(pc.Scene((A,)), 0, clock=clock, backend=device)
    assert make_status(renderer, 0.0)["tick_ms"] == (0.0, 0.0, 0.0)
    device.delay(0.5)
    for _ in range(10):
        renderer.tick()
    assert make_status(renderer, 0.0)["tick_ms"] == pytest.approx((0.0, 500.0, 500.0))
    for _ in range(1000):
        renderer.tick()
    assert make_status(renderer, 0.0)["tick_ms"][2] < 1.0
    assert make_status(renderer, 0.0)["late"] == 1
    renderer.close()


def test_times_of_ticks_are_counted_by_their_size() -> None:
    renderer = ticked(pc.Scene((A,)), 0)
    times = [1e-6, 1.1e-5, 0.9e-3, 1.1e-3, 1.1e-3, 0.0999, 5.0]
    for seconds in times:
        renderer.report.count_tick(seconds, late=False)
    counts = np.frombuffer(make_status(renderer, 0.0)["tick_counts"], "<u4")
    assert (len(counts), counts.sum()) == (64, len(times))
    wanted = np.clip(np.floor(16 * (np.log10(times) + 5)), 0, 63).astype(int)
    assert np.array_equal(counts, np.bincount(wanted, minlength=64))
    renderer.close()


def test_before_the_first_tick_none_is_counted() -> None:
    renderer = ticked(pc.Scene((A,)), 0)
    assert make_status(renderer, 0.0)["tick_counts"] == bytes(256)
    renderer.close()


def test_zones_that_are_too_loud_are_reported_and_rounding_is_blamed_only_for_what_it_makes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    zone = pc.Zone((0.08, 0.0, 0.2), pressure=0.5, radius=0.02)
    limits = pc.Limits(zones=(zone,))
    pc.solve(ARRAY, [A.position], [500.0], limits=limits)  # prepares the zone
    renderer = ticked(pc.Scene((A,)), 10, limits=limits)
    solution = renderer.solution
    assert solution is not None
    focus = pc.solve(ARRAY, [[0.08, 0.0, 0.178]], [500.0]).gains
    noise = np.exp(1j * np.arange(len(ARRAY)) ** 2)
    rows = matrix(ARRAY, zone.spread(0, 6000), pc.Air())
    for solved, emitted, reason in (
        (solution.gains, solution.gains + 0.01 * noise, "rounded"),
        (focus, focus, "limit"),
    ):
        played = dataclasses.replace(solution, gains=solved)
        monkeypatch.setattr(type(renderer), "solution", played)
        monkeypatch.setattr(type(renderer), "cycle_gains", np.array([emitted], np.complex64))
        status = make_status(renderer, 0.01)["status"]
        loudest = np.abs(rows @ emitted).max() / zone.pressure
        assert loudest > 1.0
        assert status.endswith(reason)
        assert float(status.split()[2]) == pytest.approx(20.0 * np.log10(loudest), abs=2.0)
    renderer.close()


def test_a_device_that_is_too_coarse_for_a_zone_is_named_as_the_cause_of_silence() -> None:
    zone = pc.Zone((0.08, 0.0, 0.2), pressure=5.0, radius=0.02)
    limits = pc.Limits(zones=(zone,))
    pc.solve(ARRAY, [A.position], [500.0], limits=limits)  # prepares the zone
    for amplitudes, silent in ((256, False), (2, True)):
        device = Simulated(rate=1000.0, amplitudes=amplitudes)
        renderer = ticked(pc.Scene((A,)), 10, limits=limits, backend=device)
        status = make_status(renderer, 0.01)["status"]
        assert status.startswith("silent: the device's levels are too coarse") is silent
        renderer.close()
