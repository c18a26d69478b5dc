"""From a scene to what a device emits."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.rendering.tick_pacing import pace
from pacinian.scene.modulation.technique import STM
from pacinian.scene.shapes.curves import Circle
from pacinian.testing import ManualClock, UsbBus
from pacinian_plugins.backends.simulated import Simulated
from pacinian_plugins.backends.usb_autd import UsbAutd
from pacinian_plugins.backends.usb_autd.protocol import State

from .units import Units

if TYPE_CHECKING:
    from pathlib import Path

LEVELS: dict[str, Any] = {"phases": 640, "amplitudes": 320, "rate": 2000.0}
STILL = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
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


SCENES = {
    "still": pc.Scene((STILL,)),
    "amplitude modulation": pc.Scene((STILL, TREMBLE)),
    "spatio-temporal modulation": pc.Scene((CIRCLE,)),
    "moving": moving,
    "nothing": pc.Scene(),
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
@pytest.mark.parametrize("lead", [0.0, 0.002])
def test_a_device_emits_what_the_simulated_array_does_row_by_row(scene: Any, lead: float) -> None:
    array, clock = pc.autd(2, 1), ManualClock()
    plugged = [Units(serial, now=clock.now) for serial in ("A", "B")]
    ours = UsbAutd(library=UsbBus(*plugged), lead=lead)
    other = Simulated(**LEVELS)
    one = pc.Renderer(array, scene, backend=ours, clock=clock)
    two = pc.Renderer(array, scene, backend=other, clock=clock)
    emitted: list[list[Any]] = []
    with one, two:
        for k in range(40):
            clock.time = k * 1e-3
            one.tick()
            two.tick()
            for part in (0.25e-3, 0.75e-3):
                clock.time = k * 1e-3 + part
                both = [p.model.levels() for p in plugged]
                emitted.append([np.concatenate(levels) for levels in zip(*both, strict=True)])
        first = 1 + round(lead * 2000)
        rows = [(p, a) for f in other.frames for p, a in zip(f.phase, f.amplitude, strict=True)]
        assert not any(amplitude.any() for _, amplitude in emitted[:first])
        for (phase, amplitude), (p, a) in zip(emitted[first:], rows, strict=False):
            np.testing.assert_array_equal(amplitude, a)
            np.testing.assert_array_equal(phase, p)
        status = plugged[0].model.status()
        assert status.accepted == 40
        assert status.starved == status.overrun == status.refused == status.lost == 0
    assert not one.report.faults
    assert all(p.model.status().state == State.DISARMED for p in plugged)


def test_what_stands_still_takes_half_the_bytes() -> None:
    clock = ManualClock()
    device = Units("A", now=clock.now)
    renderer = pc.Renderer(
        pc.autd(), pc.Scene((TREMBLE,)), backend=UsbAutd(library=UsbBus(device)), clock=clock
    )
    with renderer:
        for k in range(40):
            if k == 20:
                renderer.scene = pc.Scene((STILL,))
            renderer.tick(k * 1e-3)
    sizes = [size for size, _ in device.writes]
    assert sizes[-1] < 0.6 * sizes[19]


def test_another_device_takes_over_and_back_while_a_scene_plays() -> None:
    array, clock = pc.autd(), ManualClock()
    plugged = Units("A", now=clock.now)
    simulated, ours, again = Simulated(), UsbAutd(library=UsbBus(plugged)), Simulated(phases=64)
    renderer = pc.Renderer(array, moving, backend=simulated, clock=clock)
    coming = {20: ours, 40: again}
    leaving: pc.Backend | None = None
    states: list[int] = []
    with renderer:
        for k in range(60):
            if k in coming:
                coming[k].open(array)
                leaving = renderer.use(coming[k])
            clock.time = k * 1e-3
            renderer.tick()
            if k - 1 in coming and leaving is not None:
                leaving.close()
            states.append(plugged.model.status().state)
    assert simulated.received == again.received == 20
    assert plugged.model.status().accepted == 20
    assert states[:20] == [State.DISARMED] * 20
    assert states[24:40] == [State.SOUNDING] * 16
    assert states[41:] == [State.DISARMED] * 19
    assert simulated.silent
    assert again.silent
    assert not renderer.report.faults


def test_unplugged_while_a_scene_plays_it_is_a_fault_and_comes_back_when_told() -> None:
    array, clock = pc.autd(), ManualClock()
    plugged = Units("A", now=clock.now)
    bus = UsbBus(plugged)
    ours = UsbAutd(library=bus)
    renderer = pc.Renderer(array, pc.Scene((STILL,)), backend=ours, clock=clock)
    beats = pace(clock, 1e-3)
    with renderer:
        for _, (due, _) in zip(range(10), beats, strict=False):
            renderer.tick(due)
        plugged.unplug()
        for _, (due, _) in zip(range(10), beats, strict=False):
            renderer.tick(due)
        assert renderer.halted is not None
        assert "it is gone" in renderer.halted.message
        assert len(renderer.report.faults) == 1
        bus.plug(plugged)
        for _, (due, _) in zip(range(10), beats, strict=False):
            renderer.tick(due)
        assert plugged.model.status().state == State.DISARMED  # nothing comes back by itself
        ours.open(array)
        renderer.reset()
        for _, (due, _) in zip(range(10), beats, strict=False):
            renderer.tick(due)
        assert renderer.halted is None
        assert plugged.model.status().state == State.SOUNDING


def test_boards_of_a_description_in_their_own_order(tmp_path: Path) -> None:
    order = list(reversed(range(249)))
    file = tmp_path / "device.toml"
    file.write_text(
        'backend = "usb-autd"\n'
        '[[boards]]\nserial = "B"\n'
        f'[[boards]]\nserial = "A"\norder = {order}\ndead = [3]\npose = {{ position = [0.2, 0.0, 0.0] }}\n'
    )
    array = pc.DeviceDescription.load(file).array()
    assert len(array) == 497
    clock = ManualClock()
    plugged = {serial: Units(serial, now=clock.now) for serial in ("A", "B")}
    ours = UsbAutd(description=str(file), library=UsbBus(*plugged.values()), lead=0.0)
    ours.open(array)
    levels = np.arange(497, dtype=np.uint16)[None] % 320
    ours.send(pc.Frame(0, 0.0, levels, levels))
    clock.advance(0.6e-3)
    np.testing.assert_array_equal(plugged["B"].model.levels()[1], levels[0, :249])
    turned = plugged["A"].model.levels()[1]
    assert turned[3] == 0
    want = levels[0, 249:]
    np.testing.assert_array_equal(np.delete(turned[::-1], 248 - 3), want)
    ours.close()
    with pytest.raises(pc.BackendError, match="has 498 transducers"):
        ours.open(pc.autd(2, 1))


def test_pretended_devices_need_no_usb() -> None:
    ours = UsbAutd(pretend=True)
    for array in (pc.autd(), pc.autd(3, 3), pc.autd(17, 1)):
        ours.open(array)
        zeros = np.zeros((2, len(array)), np.uint16)
        for k in range(250):
            ours.send(pc.Frame(k, 0.0, zeros, zeros))
        assert ours.boards[0].status().accepted == 250
        ours.silence()
    ours.close()
