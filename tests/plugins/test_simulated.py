"""The simulated array: keeps what it is sent, and fails on request."""

from typing import Any

import numpy as np
import pytest

import pacinian as pc
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
    np.testing.assert_allclose(
        device.field(q, pc.Air()), pc.matrix(ARRAY, q, pc.Air()) @ np.ones(249), rtol=1e-4
    )
    device.silence()
    assert not device.field(q, pc.Air()).any()


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


def test_silence_is_a_frame_of_its_own_at_the_end_of_the_last() -> None:
    device = opened(rate=2000.0)
    device.send(frame(7, rows=4, time=3.0))
    device.silence()
    device.silence()
    assert [f.sequence for f in device.frames] == [7, 7]
    assert not device.frames[-1].amplitude.any()
    assert device.frames[-1].time == pytest.approx(3.002)
    assert device.received == 1


def test_a_refused_silence_goes_on_sounding() -> None:
    device = opened()
    device.send(frame())
    device.refuse_silence(2)
    for _ in range(2):
        with pytest.raises(pc.BackendError, match="refuses"):
            device.silence()
        assert device.gains.any()
    device.silence()
    assert not device.gains.any()
