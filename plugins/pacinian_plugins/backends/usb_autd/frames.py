"""Frames of the wire protocol usb-autd 1.0; see docs/usb-autd.md. All values are little-endian."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, NamedTuple, TypeAlias
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from pacinian_plugins.backends.usb_autd.protocol import FULL, MAJOR, Verdict

if TYPE_CHECKING:
    from pacinian.types import Levels
    from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport

Bytes: TypeAlias = NDArray[np.uint8]

MAGIC = b"\xa5UAD"
FRAME = 1  # the one kind of message
HEADER = struct.Struct(
    "<4sBBHIII"
)  # magic, major, kind, 0, length, session, sequence; then its CRC
BODY = struct.Struct("<HBBHH")  # units, rows, lead, steps, samples
CRC = struct.Struct("<I")
HEAD = HEADER.size + CRC.size
MIN_FRAME_BYTES = HEAD + BODY.size + CRC.size  # [bytes] of a frame
TRANSDUCER = 3  # [bytes]: 12 bits of phase, 12 of amplitude


class Frame(NamedTuple):
    """Content of a message.

    units: one bit for each. lead: rows to wait if nothing is playing. steps: samples of the envelope that are this
    frame's own; the rest plays only while the next frame is late. envelope: (samples,), 0..FULL. data: phase and
    amplitude, (rows, units, transducers * 3) bytes. If there are more samples than rows, the last row continues.
    """

    session: int
    sequence: int
    units: int
    lead: int
    steps: int
    envelope: Levels
    data: Bytes

    def levels(self) -> tuple[Levels, Levels]:
        """Return the phase and amplitude levels, each (rows, units, transducers)."""
        three = self.data.reshape(*self.data.shape[:2], -1, TRANSDUCER).astype(np.uint16)
        low, mid, high = three[..., 0], three[..., 1], three[..., 2]
        phase, amplitude = low | (mid & 15) << 8, mid >> 4 | high << 4
        return phase.astype(np.uint16), amplitude.astype(np.uint16)


def size(rows: int, transducers: int, samples: int) -> int:
    """Return the length of a frame [bytes]."""
    return MIN_FRAME_BYTES + 2 * samples + rows * transducers * TRANSDUCER


def pack(
    frame: tuple[int, int, int, int, int], envelope: Levels, phase: Levels, amplitude: Levels, out: memoryview
) -> None:  # fmt: skip
    """Write a message.

    frame: session, sequence, units, lead, steps. envelope: (samples,). phase, amplitude: (rows, N), below 4096, N
    that of the transducers of all `units`. out: `size(rows, N, samples)` bytes.
    """
    session, sequence, units, lead, steps = frame
    HEADER.pack_into(out, 0, MAGIC, MAJOR, FRAME, 0, len(out), session, sequence)
    check = crc32(out[: HEADER.size])
    CRC.pack_into(out, HEADER.size, check)
    BODY.pack_into(out, HEAD, units, len(phase), lead, steps, len(envelope))
    begin, end = HEAD + BODY.size, len(out) - CRC.size
    split = begin + 2 * len(envelope)
    view = np.frombuffer(out, np.uint8)
    view[begin:split] = envelope.astype("<u2", copy=False).view(np.uint8)
    three = view[split:end].reshape(*phase.shape, TRANSDUCER)
    three[..., 0] = phase
    three[..., 1] = phase >> 8 | amplitude << 4
    three[..., 2] = amplitude >> 4
    CRC.pack_into(out, end, crc32(out[HEAD:end], check))


def unpack(message: bytes, can: CapabilityReport) -> Frame | Verdict:
    """Decode a message with valid CRCs for a device of capability `can`; return the verdict if it is refused."""
    _, _, kind, _, length, session, sequence = HEADER.unpack_from(message)
    if kind != FRAME:
        return Verdict.KIND
    if length < MIN_FRAME_BYTES:
        return Verdict.LENGTH
    units, rows, lead, steps, samples = BODY.unpack_from(message, HEAD)
    if not units or units >> can.units:
        return Verdict.UNITS
    if not (1 <= rows <= steps and steps + lead <= can.queue):
        return Verdict.ROWS
    if not steps <= samples <= can.samples:
        return Verdict.ENVELOPE
    count, split = units.bit_count(), HEAD + BODY.size + 2 * samples
    if length != size(rows, count * can.transducers, samples):
        return Verdict.LENGTH
    envelope: Levels = np.frombuffer(message, "<u2", samples, HEAD + BODY.size)
    if int(envelope.max()) > FULL:
        return Verdict.ENVELOPE
    data = np.frombuffer(message, np.uint8, length - CRC.size - split, split)
    frame = Frame(session, sequence, units, lead, steps, envelope, data.reshape(rows, count, -1))
    phase, amplitude = frame.levels()
    if int(phase.max()) >= can.phases or int(amplitude.max()) >= can.amplitudes:
        return Verdict.LEVEL
    return frame


def is_newer(sequence: int, than: int) -> bool:
    """Return whether one sequence number comes after another, modulo 2^32."""
    return 0 < (sequence - than & 0xFFFFFFFF) < 1 << 31
