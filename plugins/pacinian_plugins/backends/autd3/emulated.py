"""The AUTD3 project's emulator in place of units: computes what they would emit, and the field."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.argument_checks import check_number
from pacinian_plugins.backends.autd3.commands import make_silent, make_unramped
from pacinian_plugins.backends.autd3.levels import PERIOD, PHASES
from pacinian_plugins.backends.autd3.packages import import_package

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian.types import Gains
    from pacinian_plugins.backends.autd3.transport_interface import Due

CYCLE = 25_000  # period of the ultrasound [ns]
MAX_MESSAGES = 4096  # messages kept; at most two cycles determine the current sound


class EmulatedTransport:
    """Units that exist in the emulator only.

    geometry: of the units. clock: [s]; the units' own clock starts at 0.
    """

    def __init__(self, geometry: Any, clock: Callable[[], float]) -> None:
        self.failures, self.waits, self.messages = 0, False, 0
        self._geometry, self._clock, self._start = geometry, clock, clock()
        api = import_package("autd3")
        self._emulator, self._duration = import_package("autd3_emulator"), api.Duration.from_nanos
        self._silent = api.Frames.encode(geometry, make_silent(len(geometry)))
        self._begin = api.Frames.encode(geometry, [make_unramped(), make_silent(len(geometry))])
        self._log: deque[tuple[float, Any]] = deque(maxlen=MAX_MESSAGES)

    @property
    def time(self) -> float:
        """The units' clock [s]."""
        return self._clock() - self._start

    def post(self, updates: Sequence[Due]) -> None:
        """Record these frames; they never wait."""
        now = self.time
        for frames, due in updates:
            self._log.append((now if due is None else due, frames))
            self.messages += len(frames)

    def check(self) -> None:
        """Do nothing: the emulator never fails."""

    def silence(self) -> None:
        """Stop all sound."""
        now = self.time
        while self._log and self._log[-1][0] > now:
            self._log.pop()
        self.post([(self._silent, None)])

    def close(self) -> None:
        """Silence the units; their record stays available."""
        self.silence()

    def record(self, seconds: float = 1e-9 * CYCLE) -> Any:
        """Return the emission of the last `seconds` [s] as the emulator's `Record`: `record.sound_field(...)`.

        Default: one period. This is slow and needs 150 kB for each millisecond and unit.
        """
        span = max(1, round(1e9 * check_number("seconds", seconds, low=0.0) / CYCLE))
        end = round(1e9 * self.time) // CYCLE + 1  # in periods, after the current one
        recorder = self._emulator.Recorder(self._geometry, CYCLE * max(0, end - span))
        at = max(0, end - span)
        for frame in self._begin:
            recorder.send_frame(frame)
        for due, frames in self._log:
            when = round(1e9 * due) // CYCLE
            if when >= end:
                break
            if when > at:
                recorder.tick(self._duration(CYCLE * (when - at)))
                at = when
            for frame in frames:
                recorder.send_frame(frame)
        recorder.tick(self._duration(CYCLE * (end - at)))
        return recorder.into_record()

    def gains(self) -> Gains:
        """Return the gains emitted now by all transducers, (249 * units,)."""
        record = self.record()
        phase, width = (table.to_numpy()[:, -1] for table in (record.phase(), record.pulse_width()))
        size = np.sin(np.pi * width / PERIOD)
        return np.asarray(size * np.exp(-2j * np.pi * phase / PHASES), np.complex64)
