"""The reference device: a model of the firmware's required behaviour, driven by a clock and without USB."""

from __future__ import annotations

import math
import struct
import time
from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian_plugins.backends.usb_autd.decoder import Decoder
from pacinian_plugins.backends.usb_autd.frames import is_newer
from pacinian_plugins.backends.usb_autd.protocol import FULL, Request, State, Verdict
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport, StatusReport

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Levels
    from pacinian_plugins.backends.usb_autd.frames import Frame

ROW_TOLERANCE = 1e-6  # tolerance for a time to count as on a row boundary [rows]
HOT = 850  # temperature at which it falls silent [0.1 °C]


class Stalled(Exception):
    """The control endpoint answered with STALL: it refuses the request."""


class Segment(NamedTuple):
    """A frame, and the row at which it begins."""

    start: int
    frame: Frame
    phase: Levels
    amplitude: Levels

    @property
    def end(self) -> int:
        """The row after its last."""
        return self.start + self.frame.steps


class Device:
    """An attached device, silent until it is armed.

    can: its capability and identity. now: its clock [s].
    """

    def __init__(
        self, can: CapabilityReport | None = None, now: Callable[[], float] = time.perf_counter
    ) -> None:
        self.can = can or CapabilityReport(serial="PUA-0001", firmware="model 1.0")
        self.temperature: int | None = None
        """Temperature [0.1 °C]; None if unknown."""
        self.history: list[Verdict] | None = None
        """Verdicts on all messages; set it to a list to record them."""
        self._now, self._begun = now, now()
        self._decoder = Decoder(self.can)
        self._status = StatusReport(watchdog=self.can.watchdog[2])
        self._segments: deque[Segment] = deque()
        self._fed = -math.inf  # time of the last accepted frame [s]

    def reset(self) -> None:
        """Disarm, as on attach, detach, bus reset, suspend or a change of configuration."""
        self._disarm()
        self._decoder.flush()

    def ask(self, request: int) -> bytes:
        """Answer a control request with a report. Raises Stalled."""
        if request == Request.CAPABILITY:
            return self.can.pack()
        if request == Request.STATUS:
            return self.status().pack()
        raise Stalled

    def tell(self, request: int, data: bytes = b"") -> None:
        """Handle a control request with data. Raises Stalled."""
        self._advance(self._now())
        if request == Request.ARM and len(data) == 8:
            self._arm(*struct.unpack("<IHH", data))
        elif request == Request.SILENCE and len(data) in (0, 4):
            self._segments.clear()
            self._decoder.flush()
            if data:
                until = int.from_bytes(data, "little")
                if is_newer(until, self._status.sequence):
                    self._status.sequence = until
        elif request == Request.DISARM and not data:
            self.reset()
        else:
            raise Stalled

    def write(self, data: bytes) -> None:
        """Receive bytes from the bulk endpoint."""
        now, status = self._now(), self._status
        self._advance(now)
        for found in self._decoder.feed(data):
            verdict = found if isinstance(found, Verdict) else self._take(found, now)
            if verdict == Verdict.CORRUPT:
                status.corrupt += 1
            elif verdict != Verdict.OK:
                status.refused += 1
            if verdict != Verdict.OK:
                status.refusal = verdict
            if self.history is not None:
                self.history.append(verdict)
        status.skipped = self._decoder.skipped

    def levels(self, t: float | None = None) -> tuple[Levels, Levels]:
        """Return the phase and amplitude levels emitted at `t` [s], not before the last message; (N,) each."""
        at = self._now() if t is None else t
        self._advance(at)
        can = self.can
        phase = np.zeros((can.units, can.transducers), np.uint16)
        amplitude = np.zeros_like(phase)
        if (playing := self._find_playing(self._row(at))) is not None:
            segment, k = playing
            row = min(k, len(segment.phase) - 1)
            there = [unit for unit in range(can.units) if segment.frame.units >> unit & 1]
            a = segment.amplitude[row].astype(np.uint32) * segment.frame.envelope[k]
            phase[there], amplitude[there] = segment.phase[row], (a + FULL // 2) // FULL
        return phase.reshape(-1), amplitude.reshape(-1)

    def status(self) -> StatusReport:
        """Return the current status."""
        now = self._now()
        self._advance(now)
        row, state = self._row(now), self._status.state
        if state != State.DISARMED:
            state = State.SILENT if self._find_playing(row) is None else State.SOUNDING
        waiting = max(0, self._segments[-1].end - row - 1) if self._segments else 0
        heat = -32768 if self.temperature is None else self.temperature
        uptime = int(1e3 * (now - self._begun))
        return replace(self._status, state=state, uptime=uptime, waiting=waiting, temperature=heat)

    def _arm(self, session: int, watchdog: int, zero: int) -> None:
        least, most, usual = self.can.watchdog
        watchdog = watchdog or usual
        if not session or not least <= watchdog <= most or zero or self._hot:
            raise Stalled
        self.reset()
        status = self._status
        status.state, status.session, status.watchdog = State.SILENT, session, watchdog
        status.sequence = 0

    def _disarm(self) -> None:
        self._segments.clear()
        self._status.state, self._status.session = State.DISARMED, 0

    def _take(self, frame: Frame, now: float) -> Verdict:
        """Accept a valid frame, for all units at once, or return why not."""
        status = self._status
        if status.state == State.DISARMED:
            return Verdict.DISARMED
        if frame.session != status.session:
            return Verdict.SESSION
        if not is_newer(frame.sequence, status.sequence):
            return Verdict.SEQUENCE
        status.lost += (frame.sequence - status.sequence & 0xFFFFFFFF) - 1
        status.sequence = frame.sequence
        status.accepted += 1
        self._fed = now
        self._play(frame, self._row(now) + 1)
        return Verdict.OK

    def _play(self, frame: Frame, first: int) -> None:
        """Queue a frame after the waiting ones; `first` is the row that begins next."""
        segments, status = self._segments, self._status
        start = segments[-1].end if segments else first + frame.lead
        if start < first:  # the tail is playing: the frame is late
            status.starved += 1
            start = first + frame.lead
        if start + frame.steps - first > self.can.queue:  # overrun: the newest wins
            status.overrun += 1
            start = first + frame.lead
            while segments and segments[-1].start >= first:
                segments.pop()
        segments.append(Segment(start, frame, *frame.levels()))

    def _find_playing(self, row: int) -> tuple[Segment, int] | None:
        """Return the frame that plays at a row, and the index of its sample; discard earlier frames."""
        segments = self._segments
        while len(segments) > 1 and segments[1].start <= row:
            segments.popleft()
        if not segments or not 0 <= (k := row - segments[0].start) < len(
            segments[0].frame.envelope
        ):
            return None
        return segments[0], k

    def _advance(self, now: float) -> None:
        """Apply the watchdog and the temperature limit."""
        if self._segments and now - self._fed >= 1e-3 * self._status.watchdog:
            self._segments.clear()
            self._status.tripped += 1
        if self._hot and self._status.state != State.DISARMED:
            self._disarm()

    def _row(self, t: float) -> int:
        return math.floor((t - self._begun) * self.can.rate + ROW_TOLERANCE)

    @property
    def _hot(self) -> bool:
        return self.temperature is not None and self.temperature >= HOT
