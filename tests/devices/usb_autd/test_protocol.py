"""Packing and unpacking: what comes in comes out."""

from __future__ import annotations

import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacinian_plugins.backends.usb_autd import frames, protocol
from pacinian_plugins.backends.usb_autd.decoder import Decoder
from pacinian_plugins.backends.usb_autd.frames import Frame, is_newer
from pacinian_plugins.backends.usb_autd.protocol import FULL, State, Verdict
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport, StatusReport

WORDS = st.integers(0, 0xFFFFFFFF)
CAN = CapabilityReport(units=16, transducers=5, queue=40, samples=80)


@given(
    session=WORDS,
    sequence=WORDS,
    units=st.integers(1, 0xFFFF),
    rows=st.integers(1, 4),
    lead=st.integers(0, 20),
    own=st.integers(0, 10),
    tail=st.integers(0, 30),
    seed=st.integers(0, 99),
    cuts=st.lists(st.integers(0, 1200), max_size=5),
)
def test_a_frame_comes_out_as_it_went_in(
    session: int, sequence: int, units: int, rows: int, lead: int, own: int, tail: int, seed: int, cuts: list[int]
) -> None:  # fmt: skip
    random = np.random.default_rng(seed)
    shape = rows, units.bit_count() * CAN.transducers
    phase = random.integers(0, protocol.PHASES, shape, np.uint16)
    amplitude = random.integers(0, protocol.AMPLITUDES, shape, np.uint16)
    steps = rows + own
    envelope = random.integers(0, FULL + 1, steps + tail, np.uint16)
    out = bytearray(frames.size(*shape, len(envelope)))
    frames.pack(
        (session, sequence, units, lead, steps), envelope, phase, amplitude, memoryview(out)
    )
    decoder = Decoder(CAN)
    found: list[Frame | Verdict] = []
    for begin, end in zip([0, *sorted(cuts)], [*sorted(cuts), None], strict=True):
        found += decoder.feed(bytes(out[begin:end]))
    (frame,) = found
    assert isinstance(frame, Frame)
    assert frame[:5] == (session, sequence, units, lead, steps)
    np.testing.assert_array_equal(frame.envelope, envelope)
    p, a = frame.levels()
    np.testing.assert_array_equal(p.reshape(shape), phase)
    np.testing.assert_array_equal(a.reshape(shape), amplitude)
    assert decoder.skipped == 0


def test_the_bytes_of_a_frame() -> None:
    """As the document has them."""
    phase, amplitude = np.array([[0x123, 0x27F]], np.uint16), np.array([[0x0BC, 0x13F]], np.uint16)
    out = bytearray(frames.size(1, 2, 2))
    envelope = np.array([FULL, 0x1234], np.uint16)
    frames.pack((0x11223344, 0x55667788, 1, 4, 1), envelope, phase, amplitude, memoryview(out))
    head = "a5554144 01 01 0000 2e000000 44332211 88776655"
    body = "0100 01 04 0100 0200  0080 3412  23c10b 7ff213"
    want = bytes.fromhex(head)
    want += zlib.crc32(want).to_bytes(4, "little") + bytes.fromhex(body)
    want += zlib.crc32(want[:20] + want[24:]).to_bytes(4, "little")
    assert out == want


@given(st.data())
def test_reports_come_out_as_they_went_in(data: st.DataObject) -> None:
    short, word = st.integers(0, 0xFFFF), st.integers(0, 255)
    name = st.text("ABCxyz0123-. ", max_size=16)
    three = st.tuples(short, short, short)
    can = CapabilityReport(
        data.draw(st.integers(1, 16)), data.draw(st.integers(1, 999)), *(data.draw(short) for _ in range(5)),
        data.draw(three), data.draw(WORDS),
        data.draw(WORDS), data.draw(name), data.draw(name), (data.draw(word), data.draw(word)),
    )  # fmt: skip
    report = can.pack()
    assert len(report) == 64
    assert CapabilityReport.unpack(report) == can
    status = StatusReport(State.SOUNDING, 3, *(data.draw(WORDS) for _ in range(11)), 20, 7, -5)
    report = status.pack()
    assert len(report) == 64
    assert StatusReport.unpack(report) == status


def test_what_a_newer_minor_version_adds_to_a_report_is_left_out() -> None:
    longer = bytes([80]) + CapabilityReport(version=(1, 3)).pack()[1:] + b"what is new 1.3!"
    assert CapabilityReport.unpack(longer) == CapabilityReport(version=(1, 3))
    assert StatusReport.unpack(bytes([70]) + StatusReport().pack()[1:] + bytes(6)) == StatusReport()
    for cut in (b"", StatusReport().pack()[:-1], b"\x20" + bytes(63)):
        with pytest.raises(ValueError, match="report"):
            StatusReport.unpack(cut)


@given(WORDS, st.integers(1, (1 << 31) - 1))
def test_sequence_numbers_begin_anew(than: int, ahead: int) -> None:
    later = (than + ahead) & 0xFFFFFFFF
    assert is_newer(later, than)
    assert not is_newer(than, later)
    assert not is_newer(than, than)


@given(st.binary(max_size=300))
def test_noise_is_skipped(noise: bytes) -> None:
    decoder = Decoder(CAN)
    assert not list(decoder.feed(noise))
    assert len(noise) - decoder.skipped < 24
