"""Frames from the renderer to the guard."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from msgspec.msgpack import Decoder

import pacinian as pc
from pacinian.serving.guard.output_gate import OutputGate
from pacinian.serving.ipc import messages
from pacinian.serving.ipc.messages import DeviceStatus, FrameHead, Permit
from pacinian.serving.ipc.shared_memory import RegisterReader, SharedRegister
from pacinian.serving.render.frame_output import Input, OutputSwitcher, SharedFrameBackend
from pacinian.testing import ManualClock

ARRAY = pc.autd()
N = len(ARRAY)
GOOD = DeviceStatus(3, 0, "fake", 16, 32, 2000.0, 0.1, 0.0, False)
SCENE = pc.Scene((pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0),))


class Wired:
    """The files of an output."""

    def __init__(self, folder: Path) -> None:
        self.files = {
            "frame": SharedRegister.create(folder / "frame", messages.compute_frame_capacity(N)),
            "device": SharedRegister.create(folder / "device", messages.CAPACITIES["device"]),
            "permit": SharedRegister.create(folder / "permit", messages.CAPACITIES["permit"]),
        }
        self.device = RegisterReader(self.files["device"], Decoder(DeviceStatus).decode, GOOD)
        self.permit = RegisterReader(self.files["permit"], Permit.unpack, Permit())
        self.input = Input()
        self.outputs = OutputSwitcher(
            self.files["frame"], self.device, self.permit, 1000.0, lambda: self.input
        )

    def set(self, device: DeviceStatus) -> None:
        self.files["device"].write(messages.pack(device))
        self.device.look()

    def read(self) -> tuple[FrameHead, bytes]:
        found = self.files["frame"].read()
        assert found is not None
        return FrameHead.unpack(found[1]), found[1][messages.compute_frame_capacity(0) :]


@pytest.fixture
def wired(tmp_path: Path) -> Iterator[Wired]:
    made = Wired(tmp_path)
    yield made
    for file in made.files.values():
        file.close()


def frame(sequence: int = 7, rows: int = 2) -> pc.Frame:
    levels = np.arange(rows * N, dtype=np.uint16).reshape(rows, N)
    return pc.Frame(sequence, 1.5, levels % 16, levels % 32)


def test_a_frame_arrives_with_all_that_the_guard_looks_at(wired: Wired) -> None:
    output = wired.outputs.make_first()
    assert output.capability == pc.Capability(16, 32, 2000.0, 0.1)
    output.open(ARRAY)
    wired.files["permit"].write(Permit(1, 9.0, 42).pack())
    wired.permit.look()
    wired.input = Input(5, 0.25, 0.5)
    sent = frame()
    output.send(sent)
    head, levels = wired.read()
    assert head == FrameHead(7, 1.5, 42, 3, 2, N, 5, 0.25, 0.5)
    phase, amplitude = np.frombuffer(levels, "<u2").reshape(2, 2, N)
    np.testing.assert_array_equal(phase, sent.phase)
    np.testing.assert_array_equal(amplitude, sent.amplitude)


@pytest.mark.parametrize("count", [2, 65, 1 << 16])
def test_amplitudes_that_are_not_even_arrive_with_the_device(wired: Wired, count: int) -> None:
    can = pc.Capability(16, tuple((np.linspace(0.0, 1.0, count) ** 0.8).tolist()), 2000.0, 0.1)
    guard = OutputGate(N, gain=1.0, frame_timeout=0.1)
    guard.adopt_device(pc.backend("simulated"), can)
    wired.set(guard.make_status({}, ()))
    assert wired.device.value.amplitudes == count
    assert wired.outputs.make_first().capability == can


def test_a_fault_of_the_device_is_raised_and_silence_has_no_rows(wired: Wired) -> None:
    output = wired.outputs.make_first()
    output.open(ARRAY)
    wired.set(msgspec.structs.replace(GOOD, fault="it burns"))
    with pytest.raises(pc.BackendError, match="it burns"):
        output.send(frame())
    output.silence()
    head, levels = wired.read()
    assert (head.rows, head.device, levels) == (0, 3, b"")
    output.close()


def renderer(wired: Wired, output: SharedFrameBackend) -> pc.Renderer:
    return pc.Renderer(ARRAY, SCENE, backend=output, rate=1000.0, clock=ManualClock())


def test_the_loop_makes_frames_for_the_next_device_and_goes_back(wired: Wired) -> None:
    with renderer(wired, wired.outputs.make_first()) as loop:
        loop.tick()
        for device, generation, rows in (
            (msgspec.structs.replace(GOOD, next_generation=4, rate=4000.0, phases=256), 4, 4),
            (msgspec.structs.replace(GOOD, generation=4, rate=4000.0, phases=256), 4, 4),
            (GOOD, 3, 2),
        ):
            wired.set(device)
            assert wired.outputs.follow(loop) == {}
            before = wired.files["frame"].number
            loop.tick()
            head, _ = wired.read()
            assert (head.device, head.rows) == (generation, rows)
            assert wired.files["frame"].number == before + 1
        assert not loop.report.faults


@pytest.mark.parametrize("rate", [500.0, 65_000.0])
def test_a_device_that_does_not_fit_the_loop_is_refused_and_the_old_one_goes_on(
    wired: Wired, rate: float
) -> None:
    with renderer(wired, wired.outputs.make_first()) as loop:
        wired.set(msgspec.structs.replace(GOOD, next_generation=4, rate=rate))
        results = wired.outputs.follow(loop)
        assert "rows a tick" in results["device 4"]
        assert wired.outputs.follow(loop) == {}
        loop.tick()
        assert wired.read()[0].device == 3


def test_without_a_device_the_loop_waits_for_one(wired: Wired) -> None:
    none: Any = msgspec.structs.replace(GOOD, generation=0, fault="not plugged in")
    wired.set(none)
    with renderer(wired, wired.outputs.make_first()) as loop:
        loop.tick()
        assert loop.halted is not None
        assert "not plugged in" in loop.halted.message
        wired.set(GOOD)
        assert wired.outputs.follow(loop) == {}
        loop.reset()
        loop.tick()
        assert wired.read()[0].device == 3


def test_a_halted_loop_writes_empty_frames_until_the_next_device_has_taken_over(
    wired: Wired,
) -> None:
    with renderer(wired, wired.outputs.make_first()) as loop:
        loop.tick()
        wired.set(msgspec.structs.replace(GOOD, fault="gone"))
        loop.tick()
        assert loop.halted is not None
        before = wired.files["frame"].number
        assert wired.outputs.follow(loop) == {}
        assert wired.files["frame"].number == before
        for count in (1, 2):
            wired.set(msgspec.structs.replace(GOOD, fault="gone", next_generation=4))
            assert wired.outputs.follow(loop) == {}
            assert wired.files["frame"].number == before + count
            head, levels = wired.read()
            assert (head.device, head.rows, levels) == (4, 0, b"")
        wired.set(msgspec.structs.replace(GOOD, fault="gone", generation=4))
        assert wired.outputs.follow(loop) == {}
        assert wired.files["frame"].number == before + 2
        wired.set(msgspec.structs.replace(GOOD, generation=4))
        loop.reset()
        loop.tick()
        assert wired.read()[0].device == 4
        assert wired.read()[0].rows


def test_a_halted_loop_writes_no_frame_for_a_device_that_does_not_fit(wired: Wired) -> None:
    with renderer(wired, wired.outputs.make_first()) as loop:
        wired.set(msgspec.structs.replace(GOOD, fault="gone"))
        loop.tick()
        before = wired.files["frame"].number
        wired.set(msgspec.structs.replace(GOOD, next_generation=4, rate=500.0))
        assert "rows a tick" in wired.outputs.follow(loop)["device 4"]
        assert wired.files["frame"].number == before
