"""From a scene to what boards emit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.serving.guard.output_gate import OutputGate
from pacinian.serving.ipc.messages import FrameHead, Permit
from pacinian_plugins.backends.openmpd.protocol import PULSE_PRESSURES
from pacinian_plugins.backends.simulated import Simulated

from .chips import Setup

STILL = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
TREMBLE = pc.Point(
    position=(0.02, 0.0, 0.15), radiation_pressure=3.0, envelope=pc.Sine(frequency=200.0)
)


def moving(t: float) -> pc.Scene:
    x = 0.02 * math.sin(t)
    return pc.Scene((pc.Point(position=(x, 0.0, 0.15), radiation_pressure=5.0), TREMBLE))


@pytest.mark.parametrize("scene", [moving, pc.Scene()], ids=["moving", "nothing"])
@pytest.mark.parametrize("rate", [1000.0, 2000.0])
def test_boards_emit_what_the_simulated_array_does_row_by_row(scene: Any, rate: float) -> None:
    it = Setup("FT1", "FT2", rate=rate)
    other = Simulated(phases=128, amplitudes=PULSE_PRESSURES, rate=rate)  # type: ignore[arg-type]
    one = pc.Renderer(it.array, scene, backend=it.backend, clock=it.clock)
    two = pc.Renderer(it.array, scene, backend=other, clock=it.clock)
    rows = round(rate / 1000.0)
    with one, two:
        start = it.clock.now()
        for k in range(30):
            it.clock.time = start + k * 1e-3
            one.tick()
            two.tick()
            sent = other.frames[-1]
            for row in range(rows):
                it.clock.time = start + (k + (row + 0.5) / rows) * 1e-3
                heard = np.concatenate([chip.model.gains() for chip in it.chips])
                want = sent.gains(other.capability)[row]
                np.testing.assert_allclose(np.abs(heard), np.abs(want), atol=1e-6)
                odd = sent.amplitude[row] % 2 == 1
                want = np.where(odd, want * np.exp(2j * np.pi / 256), want)
                np.testing.assert_allclose(heard, want, atol=1e-6)
    assert not one.report.faults
    assert not it.sounding(0.005)


def test_all_pulses_arrive_at_a_focus_together() -> None:
    """In time, as it is on air: whichever way round phases are counted."""
    it = Setup()
    renderer = pc.Renderer(it.array, pc.Scene((STILL,)), backend=it.backend, clock=it.clock)
    with renderer:
        play(it, renderer, 20)
        pulses = it.fpga.pulses()
    assert (pulses.sum(axis=1) > 0).all()
    late = np.angle(pulses @ np.exp(2j * np.pi * np.arange(128) / 128))  # the middle of each
    r = np.linalg.norm(it.array.positions - STILL.position, axis=1)
    k = renderer.session.medium.wavenumber(it.array.transducer.frequency)
    arrival = late + k * r
    assert abs(np.exp(1j * arrival).mean()) > 0.999


def play(it: Setup, renderer: pc.Renderer, ticks: int = 5) -> None:
    for _ in range(ticks):
        renderer.tick()
        it.clock.advance(1e-3)


def test_unplugged_while_a_scene_plays_it_is_a_fault_and_comes_back_when_told() -> None:
    it = Setup()
    renderer = pc.Renderer(it.array, pc.Scene((STILL,)), backend=it.backend, clock=it.clock)
    with renderer:
        play(it, renderer)
        it.chip.unplug()
        play(it, renderer)
        assert renderer.halted is not None
        assert "it is gone" in renderer.halted.message
        assert len(renderer.report.faults) == 1
        it.bus.plug(it.chip)
        it.backend.open(it.array)
        assert not it.sounding()
        renderer.reset()
        play(it, renderer)
        assert renderer.halted is None
        assert it.sounding()


def test_after_a_cut_frame_the_loop_asks_for_silence_and_may_go_on_later() -> None:
    it = Setup()
    renderer = pc.Renderer(it.array, pc.Scene((STILL,)), backend=it.backend, clock=it.clock)
    with renderer:
        play(it, renderer)
        it.chip.fault = 300
        renderer.tick()
        assert not it.sounding(0.005)
        renderer.reset()
        renderer.tick()  # too soon
        assert renderer.halted is not None
        assert "a frame was cut" in renderer.halted.message
        assert not it.sounding(1.4)
        renderer.reset()
        play(it, renderer)
        assert it.sounding()


def test_the_servers_guard_asks_for_silence_until_it_succeeds_and_never_waits() -> None:
    it = Setup().open()
    guard = OutputGate(256, gain=1.0, frame_timeout=0.02, clock=it.clock.now)
    guard.adopt_device(it.backend, it.backend.capability)
    sequence = 0

    def turn() -> None:
        nonlocal sequence
        sequence += 1
        head = FrameHead(sequence, 0.0, 1, guard.generation, 1, 256)
        levels = np.full(256, 40, "<u2").tobytes()
        guard.step(Permit(armed=1, until=1e9, epoch=1), head.pack() + bytes(512) + levels)
        it.clock.advance(1e-3)

    turn()
    assert it.sounding()
    it.chip.fault = "timeout"
    begun = it.clock.now()
    for _ in range(5):
        turn()
        assert guard.loud
    assert it.clock.now() - begun < 0.1
    assert "does not answer in time" in guard.fault
    it.chip.fault = None
    turn()
    assert not guard.loud
    assert not it.sounding(0.005)
    it.backend.close()
