"""Changing the device while the loop runs."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.rendering.recording import Recorder
from pacinian.rendering.tick_pacing import pace
from pacinian.scene.modulation.technique import STM
from pacinian.scene.shapes.curves import Circle
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

from .manual_background import solve_beside

ARRAY = pc.autd()
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
TREMBLE = pc.Point(
    position=(0.02, 0.0, 0.15), radiation_pressure=3.0, envelope=pc.Sine(frequency=200.0)
)
CIRCLE = pc.Path(
    shape=Circle(0.02),
    pose=pc.Pose((0.0, 0.0, 0.15)),
    technique=STM(frequency=100.0),
    radiation_pressure=5.0,
)


def moving(t: float) -> pc.Scene:
    return pc.Scene((pc.Point(position=(0.02 * math.sin(t), 0.0, 0.15), radiation_pressure=5.0),))


SCENES = pc.Scene((POINT,)), pc.Scene((POINT, TREMBLE)), pc.Scene((CIRCLE,)), moving


def opened(**given: Any) -> Simulated:
    device = Simulated(**given)
    device.open(ARRAY)
    return device


@pytest.mark.parametrize("scene", SCENES)
def test_no_tick_is_missing_and_the_same_sounds(scene: Any) -> None:
    clock = ManualClock()
    first, second = Simulated(rate=2000.0), opened(rate=5000.0, phases=1024, amplitudes=512)
    alone = Simulated(rate=5000.0, phases=1024, amplitudes=512)
    renderer = pc.Renderer(ARRAY, scene, backend=first, clock=clock)
    other = pc.Renderer(ARRAY, scene, backend=alone, clock=clock)
    with renderer, other:
        for k in range(40):
            if k == 20:
                assert renderer.use(second) is first
                assert not first.silent  # the caller closes it
            if k == 21:
                first.close()
            clock.wait_until(k * 0.001)
            renderer.tick()
            other.tick()
        assert [len(frame.phase) for frame in first.frames] == [*[2] * 20, 2]
        assert [len(frame.phase) for frame in second.frames] == [5] * 20
        sequences = [frame.sequence for frame in [*list(first.frames)[:20], *second.frames]]
        assert sequences == list(range(40))
        a, b = second.field([POINT.position], pc.Air()), alone.field([POINT.position], pc.Air())
        np.testing.assert_allclose(np.abs(a), np.abs(b), rtol=0.05, atol=0.02 * np.abs(b).max())
    assert first.silent
    assert second.silent
    assert not renderer.report.faults


def test_what_stands_still_is_not_solved_again() -> None:
    renderer = pc.Renderer(
        ARRAY,
        pc.Scene((POINT,)),
        backend=Simulated(),
        clock=ManualClock(),
        sampler=pc.Sampler(),
    )
    device = opened(phases=32, amplitudes=17)
    with renderer:
        for k in range(10):
            renderer.tick(k * 0.001)
        solves = renderer.report.solves
        before = renderer.emitted_gains
        renderer.use(device)
        renderer.tick(0.010)
        assert renderer.report.solves == solves
        np.testing.assert_allclose(device.gains, renderer.emitted_gains, atol=1e-6)
        np.testing.assert_allclose(device.gains, before, atol=0.15)
        assert device.frames[0].phase.max() < 32


def test_a_device_slower_than_the_loop_is_refused_and_the_old_one_goes_on() -> None:
    first = Simulated()
    renderer = pc.Renderer(ARRAY, pc.Scene((POINT,)), backend=first, clock=ManualClock())
    with renderer:
        renderer.tick()
        with pytest.raises(pc.ArgumentError, match="rate"):
            renderer.use(opened(rate=500.0))
        assert renderer.backend is first
        renderer.tick()
        assert first.received == 2


def test_a_recording_is_of_one_capability(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "r.pac")
    renderer = pc.Renderer(
        ARRAY, pc.Scene((POINT,)), backend=Simulated(), clock=ManualClock(), recorder=recorder
    )
    with renderer:
        renderer.tick()
        with pytest.raises(pc.ArgumentError, match="recorded"):
            renderer.use(opened(phases=64))
        renderer.use(opened())
        renderer.tick()
    assert not renderer.report.faults


def test_the_scene_that_is_shown_is_the_one_that_was_solved_for() -> None:
    scenes: list[pc.Scene] = []

    def scene(t: float) -> pc.Scene:
        scenes.append(moving(t))
        return scenes[-1]

    renderer = pc.Renderer(ARRAY, scene, backend=Simulated(), clock=ManualClock())
    with renderer:
        assert not renderer.rendered_scene.objects
        scenes.clear()
        for k in range(6):  # one of these ticks measures
            renderer.tick(k * 0.001)
            assert renderer.rendered_scene is scenes[-1]
        background = solve_beside(renderer)
        for k in range(6, 14):  # a solve begins in the ticks 6, 8, 10, 12
            background.ready = k % 2 == 0
            renderer.tick(k * 0.001)
            assert renderer.rendered_scene is scenes[5 if k < 8 else (k - 8) // 2 * 2 + 6]
        renderer.schedule.in_background = False
        for k in range(14, 17):
            renderer.tick(k * 0.001)
            assert renderer.rendered_scene is scenes[-1]


def test_a_loop_that_lags_far_gives_up_catching_up() -> None:
    clock = ManualClock()
    beats = pace(clock, 0.01, 0.5)
    assert next(beats) == (0.0, 0)
    clock.advance(0.05)
    assert next(beats) == (0.01, 0)
    clock.advance(0.2)
    due, lost = next(beats)
    assert lost == 23
    assert due == pytest.approx(0.25)
    assert len(list(beats)) == 24


@pytest.mark.parametrize("duration", [0.0, 0.004, 0.006, 0.05, 0.5, 1e-12])
@pytest.mark.parametrize("stall", [0.0, 0.05, 0.12, 0.2, 1e9])
def test_every_tick_is_done_or_counted_also_where_a_loop_ends_late(
    duration: float, stall: float
) -> None:
    for at in range(6):
        clock, done, missed, last = ManualClock(), 0, 0, 0.0
        for due, lost in pace(clock, 0.01, duration):
            clock.advance(stall * (done == at))
            done, missed, last = done + 1, missed + lost, due
        assert done + missed == round(duration / 0.01)
        assert done == 0 or last == pytest.approx(duration - 0.01, abs=0.005)
