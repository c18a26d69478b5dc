"""The simulated array: keeps, records, replays and fails on request."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.rendering.replay import replay
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

ARRAY = pc.autd()


def frame(sequence: int = 0, level: int = 255, rows: int = 1, time: float = 0.0) -> pc.Frame:
    shape = (rows, len(ARRAY))
    return pc.Frame(sequence, time, np.zeros(shape, np.uint16), np.full(shape, level, np.uint16))


def opened(**options: Any) -> Simulated:
    device = Simulated(**options)
    device.open(ARRAY)
    return device


def test_it_keeps_the_last_frames_as_copies() -> None:
    device = opened(keep=3)
    sent = frame()
    for sequence in range(5):
        sent.phase[:] = sequence
        device.send(pc.Frame(sequence, 0.0, sent.phase, sent.amplitude))
    assert [f.sequence for f in device.frames] == [2, 3, 4]
    assert [int(f.phase[0, 0]) for f in device.frames] == [2, 3, 4]


def test_its_field_is_that_of_the_frame() -> None:
    device = opened()
    device.send(frame())
    q = [[0.0, 0.0, 0.2], [0.01, 0.0, 0.3]]
    np.testing.assert_allclose(device.field(q), pc.matrix(ARRAY, q) @ np.ones(249), rtol=1e-4)
    device.silence()
    assert not device.field(q).any()


def test_dropped_frames_are_lost_without_a_word() -> None:
    device = opened()
    device.drop(2)
    for sequence in range(3):
        device.send(frame(sequence))
    assert [f.sequence for f in device.frames] == [2]
    assert (device.dropped, device.received) == (2, 1)


def test_a_delay_takes_the_injected_time() -> None:
    waited: list[float] = []
    device = opened(wait=waited.append)
    device.delay(0.25, 2)
    for sequence in range(3):
        device.send(frame(sequence))
    assert waited == [0.25, 0.25]


def test_stalled_and_disconnected_it_refuses_with_advice() -> None:
    device = opened()
    device.stall()
    with pytest.raises(pc.BackendError, match="resume"):
        device.send(frame())
    device.resume()
    device.send(frame())
    device.disconnect()
    with pytest.raises(pc.BackendError, match="reconnect"):
        device.send(frame())
    assert not device.gains.any()
    device.reconnect()
    device.send(frame())
    assert device.gains.any()


def test_silence_and_close_may_be_called_at_any_time() -> None:
    device = Simulated()
    device.silence()
    device.close()
    device.open(ARRAY)
    device.silence()
    device.send(frame())
    device.close()
    device.close()
    assert device.silent


@pytest.mark.parametrize(
    "options", [{"phases": 1}, {"amplitudes": 0}, {"keep": 0}, {"rate": 0.0}, {"phases": 100_000}]
)
def test_bad_settings_are_named(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        Simulated(**options)


def record(path: Path, ticks: int = 20) -> list[pc.Frame]:
    device = Simulated(record=str(path), keep=1000)
    scene = pc.Scene((pc.Point(position=(0, 0, 0.15), radiation_pressure=5.0),))
    pc.Renderer(ARRAY, scene, backend=device, clock=ManualClock()).run(ticks / 1000)
    return list(device.frames)


def test_a_recording_replays_the_same_frames_at_the_same_times(tmp_path: Path) -> None:
    sent = record(tmp_path / "run.pac")
    recording = pc.Recording(tmp_path / "run.pac")
    np.testing.assert_array_equal(recording.positions, ARRAY.positions)
    again, clock = Simulated(keep=1000), ManualClock(5.0)
    assert replay(recording, again, ARRAY, clock) == len(sent) == 21  # and silence at the end
    for before, after in zip(sent, again.frames, strict=False):
        np.testing.assert_array_equal(before.phase, after.phase)
        np.testing.assert_array_equal(before.amplitude, after.amplitude)
        assert before.time == after.time
    np.testing.assert_allclose(np.diff(clock.waits)[:19], 0.001)
    assert again.silent


def test_a_recording_that_was_cut_off_is_whole_up_to_there(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    record(path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - 700])
    assert len(list(pc.Recording(path))) == 20


@pytest.mark.parametrize(
    "junk", [b"", b"hello", b"\x81\xa1a\x01", b"\xc1", b"\xdf\xff\xff\xff\xff"]
)
def test_what_is_no_recording_is_refused(tmp_path: Path, junk: bytes) -> None:
    (tmp_path / "junk").write_bytes(junk)
    with pytest.raises(pc.RecordingError, match="junk"):
        pc.Recording(tmp_path / "junk")


def test_a_recording_that_is_missing_or_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(pc.RecordingError, match="gone"):
        pc.Recording(tmp_path / "gone")
    with pytest.raises(pc.RecordingError, match="nowhere"):
        opened(record=str(tmp_path / "nowhere" / "run.pac"))


def test_a_recording_of_another_array_or_other_levels_is_refused(tmp_path: Path) -> None:
    record(tmp_path / "run.pac")
    recording = pc.Recording(tmp_path / "run.pac")
    with pytest.raises(pc.RecordingError, match="249 transducers"):
        replay(recording, Simulated(), pc.lattice(0.1, 0.1), ManualClock())
    with pytest.raises(pc.RecordingError, match="amplitudes=320"):
        replay(recording, Simulated(amplitudes=320), ARRAY, ManualClock())


@pytest.mark.parametrize("damage", [{"amplitude": 256}, {"phase": 60000}, {"time": float("inf")}])
def test_a_recording_of_what_no_device_can_do_is_refused(
    tmp_path: Path, damage: dict[str, Any]
) -> None:
    recorder = pc.Recorder(tmp_path / "run.pac", ARRAY, pc.Capability())
    whole = frame(time=damage.get("time", 0.0))
    for name in ("phase", "amplitude"):
        getattr(whole, name)[0, 7] = damage.get(name, 1)
    recorder.write(whole)
    recorder.close()
    device = Simulated()
    with pytest.raises(pc.RecordingError, match="damaged frame"):
        replay(pc.Recording(tmp_path / "run.pac"), device, ARRAY, ManualClock())
    assert device.silent
    assert not device.received


def test_it_sounds_only_while_it_is_open() -> None:
    device = Simulated()
    with pytest.raises(pc.BackendError, match="not open"):
        device.send(frame())
    device.open(ARRAY)
    device.send(frame())
    device.close()
    with pytest.raises(pc.BackendError, match="not open"):
        device.send(frame())
    assert device.silent
