"""The reference device: what is heard when."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest

from pacinian.testing import ManualClock
from pacinian_plugins.backends.usb_autd.model import Device, Stalled
from pacinian_plugins.backends.usb_autd.protocol import FULL, Request, State, Verdict
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport, StatusReport

from .cases import message

ROW = 0.5e-3  # [s]
CAN = CapabilityReport(units=2, transducers=4, queue=12, samples=64)


class Told:
    """A device, its clock, and who tells it."""

    def __init__(self, armed: bool = True, watchdog: int = 20) -> None:
        self.clock = ManualClock()
        self.device = Device(CAN, self.clock.now)
        self.sequence = 0
        if armed:
            self.arm(watchdog=watchdog)

    def arm(self, session: int = 7, watchdog: int = 20) -> None:
        self.device.tell(Request.ARM, struct.pack("<IHH", session, watchdog, 0))

    def send(self, level: int = 100, **given: Any) -> Verdict:
        """A frame whose last transducer has this amplitude in every row."""
        self.sequence = given.pop("sequence", self.sequence + 1)
        given = {"units": 3, "level": (10, level), "lead": 0, **given}
        self.device.history = []
        self.device.write(message(self.sequence, **given))
        return self.device.history[-1]

    def heard(self, rows: int) -> list[int]:
        """The last transducer's amplitude at the middle of each of the next rows."""
        found: list[int] = []
        for _ in range(rows):
            self.clock.advance(ROW)
            found.append(int(self.device.levels(self.clock.time - ROW / 2)[1][-1]))
        return found

    @property
    def status(self) -> StatusReport:
        return self.device.status()


def test_it_is_silent_until_it_is_armed_and_again_after_it_was_unplugged() -> None:
    told = Told(armed=False)
    assert told.send() == Verdict.DISARMED
    assert told.heard(5) == [0] * 5
    assert told.status.state == State.DISARMED
    told.arm()
    assert told.heard(2) == [0, 0]
    assert told.status.state == State.SILENT
    assert told.send(envelope=[FULL] * 9) == Verdict.OK
    assert told.heard(3) == [0, 100, 100]
    assert told.status.state == State.SOUNDING
    told.device.reset()
    assert told.heard(3) == [0, 0, 0]
    assert told.send() == Verdict.DISARMED
    assert told.status.session == 0


def test_frames_of_one_session_do_not_sound_in_another() -> None:
    told = Told()
    told.send(envelope=[FULL] * 30)
    assert told.heard(2) == [0, 100]
    told.arm(session=8)
    assert told.heard(2) == [0, 0]
    assert told.send() == Verdict.SESSION
    assert told.send(session=8, sequence=1) == Verdict.OK


def test_all_units_change_together_at_a_row() -> None:
    told = Told()
    seen: set[tuple[int, ...]] = set()
    wanted: set[tuple[int, ...]] = {(0,) * 8}
    for seed in range(20):
        told.send(seed=seed, envelope=[FULL] * 20)
        wanted.add(tuple(_amplitudes(told.sequence, seed)))
        for part in range(4):  # of a row
            told.clock.advance(ROW / 4)
            at = told.clock.time + ROW * (0.01 if part == 3 else 0.0)
            seen.add(tuple(told.device.levels(at)[1].tolist()))
    assert seen <= wanted
    assert len(seen) > 10


def _amplitudes(sequence: int, seed: int) -> list[int]:
    from pacinian_plugins.backends.usb_autd.frames import unpack

    frame: Any = unpack(message(sequence, units=3, lead=0, level=(10, 100), seed=seed), CAN)
    return [int(a) for a in frame.levels()[1].ravel()]


def test_a_unit_that_a_frame_leaves_out_is_silent() -> None:
    told = Told()
    told.send(units=0b01, envelope=[FULL] * 9)
    told.clock.advance(ROW)
    phase, amplitude = told.device.levels()
    assert amplitude[:4].any()
    assert not amplitude[4:].any()
    assert not phase[4:].any()


@pytest.mark.parametrize("watchdog", [5, 20, 100])
def test_the_watchdog_silences_it_when_frames_stop(watchdog: int) -> None:
    told = Told(watchdog=watchdog)
    for _ in range(3):
        told.send(envelope=[FULL] * 64)
        told.heard(2)
    rows = round(1e-3 * watchdog / ROW) - 2
    heard = told.heard(rows + 10)
    length = min(rows, 63)  # what is left of the envelope
    assert heard[:length] == [100] * length
    assert not any(heard[length:])
    assert told.status.state == State.SILENT
    assert told.status.tripped == 1
    assert told.send(envelope=[FULL] * 9) == Verdict.OK  # who is there again need not arm
    assert told.heard(2) == [0, 100]


def test_frames_that_are_refused_do_not_feed_the_watchdog() -> None:
    told = Told()
    told.send(envelope=[FULL] * 64)
    for _ in range(30):
        assert told.send(level=999) == Verdict.LEVEL
        told.clock.advance(1e-3)
    assert told.heard(1) == [0]
    assert told.status.tripped == 1


@pytest.mark.parametrize("data", [(0, 20, 0), (7, 4, 0), (7, 101, 0), (7, 0xFFFF, 0), (7, 20, 1)])
def test_the_watchdog_cannot_be_switched_off(data: tuple[int, int, int]) -> None:
    told = Told(armed=False)
    with pytest.raises(Stalled):
        told.device.tell(Request.ARM, struct.pack("<IHH", *data))
    assert told.status.state == State.DISARMED
    told.arm(watchdog=0)
    assert told.status.watchdog == 20


def test_the_envelope_goes_on_while_the_next_frame_is_late_and_dies() -> None:
    told = Told()
    wave = [FULL, FULL // 2, FULL // 4, 0, FULL // 4, FULL // 2]
    told.send(level=200, steps=2, envelope=wave)
    assert told.heard(9) == [0, 200, 100, 50, 0, 50, 100, 0, 0]
    assert told.status.state == State.SILENT


def test_the_tail_ends_where_the_next_frame_begins() -> None:
    told = Told()
    told.send(level=200, steps=2, envelope=[FULL, FULL, 8192, 8192, 8192, 8192])
    assert told.heard(4) == [0, 200, 200, 50]
    told.send(level=80, steps=1, envelope=[FULL, FULL], lead=2)
    assert told.heard(6) == [50, 50, 50, 80, 80, 0]
    assert told.status.starved == 1


def test_frames_wait_in_order_and_the_loop_may_be_late_by_the_lead() -> None:
    told = Told()
    told.send(level=1, rows=1, steps=2, envelope=[FULL] * 2, lead=4)
    heard: list[int] = []
    for level, rows in ((2, 2), (3, 5), (4, 1), (5, 0)):  # late, then early, and never a gap
        heard += told.heard(rows)
        told.send(level=level, steps=2, envelope=[FULL] * 2, lead=4)
    heard += told.heard(8)
    assert heard[5:15] == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5]
    assert (told.status.starved, told.status.overrun) == (0, 0)


def test_the_newest_counts_where_more_comes_than_can_wait() -> None:
    told = Told()
    for level in range(1, 8):
        told.send(level=level, steps=2, envelope=[FULL] * 2, lead=1)
    assert told.status.overrun == 1
    assert told.heard(6) == [0, 0, 6, 6, 7, 7]
    assert told.status.waiting == 0


def test_silence_is_at_once_and_for_what_is_under_way() -> None:
    told = Told()
    told.send(envelope=[FULL] * 30)
    assert told.heard(2) == [0, 100]
    late = message(2, units=3, lead=0, level=(1, 50))
    told.device.write(late[:30])
    told.device.tell(Request.SILENCE, struct.pack("<I", 2))
    assert told.heard(2) == [0, 0]
    told.device.write(late)
    assert told.status.refusal == Verdict.SEQUENCE
    assert told.status.state == State.SILENT
    assert told.send(sequence=3, envelope=[FULL] * 3) == Verdict.OK
    assert told.heard(2) == [0, 100]
    told.device.tell(Request.SILENCE)
    assert told.heard(1) == [0]


def test_a_device_that_is_too_hot_is_silent_and_disarmed() -> None:
    told = Told()
    told.device.temperature = 849
    told.send(envelope=[FULL] * 30)
    assert told.heard(2) == [0, 100]
    told.device.temperature = 850
    assert told.heard(1) == [0]
    assert (told.status.state, told.status.temperature) == (State.DISARMED, 850)
    with pytest.raises(Stalled):
        told.arm()
    told.device.temperature = 700
    assert told.heard(1) == [0]
    told.arm()


@pytest.mark.parametrize(
    ("request_", "data"), [(3, b"short"), (4, b"x"), (5, b"x"), (6, b""), (1, b"")]
)
def test_requests_that_it_does_not_know_are_refused(request_: int, data: bytes) -> None:
    told = Told()
    with pytest.raises(Stalled):
        told.device.tell(request_, data)
    with pytest.raises(Stalled):
        told.device.ask(9)


def test_its_levels_are_whole_and_below_the_limits() -> None:
    told = Told()
    for seed in range(10):
        told.send(level=319, seed=seed, envelope=[FULL, 32767, 16384, 1])
        for _ in range(5):
            told.clock.advance(ROW)
            phase, amplitude = told.device.levels()
            assert phase.dtype == amplitude.dtype == np.uint16
            assert phase.max() < 640
            assert amplitude.max() < 320
