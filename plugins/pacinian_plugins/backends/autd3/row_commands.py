"""Converts rows of levels to commands for the units, and sends nothing while they play a cycle by themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pacinian_plugins.backends.autd3.packages import import_package
from pacinian_plugins.backends.autd3.repeat_detector import RepeatDetector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Rows = NDArray[np.uint8]

CARRIER = 40_000  # [Hz]
TimedFrames = tuple[Any, int]
"""Frames of the packages, and the row of the tick at which they are due."""


class RowCommands:
    """Generates the commands for the units of a geometry. rate: rows per second [Hz].

    A row is a pattern in bank B0 that plays until the next one; a row that is already playing is not sent again.
    Periodic rows are written to bank B1, one row per tick, and then played from there.
    """

    def __init__(self, geometry: Any, rate: int) -> None:
        self._geometry, self._rate = geometry, rate
        self._commands, self._value = (
            import_package("autd3.commands"),
            import_package("autd3.value"),
        )
        self._buffers = import_package("autd3_pattern")
        self._encode = import_package("autd3").Frames.encode
        self._bank = self._value.PatternBank.B1
        self._cycles = RepeatDetector()
        self._held: int | None = None  # digest of the row that is playing

    def forget(self) -> None:
        """Forget the state of the units, because it is unknown."""
        self._cycles.stop()
        self._held = None

    def tell(self, first: int, phases: Rows, intensities: Rows, time: float) -> list[TimedFrames]:
        """Return the frames to send for the rows of a tick, (rows, units, 249).

        first: due time of the first row, counted in rows. time: the same on the units' clock [s].
        """
        cycles, K = self._cycles, len(phases)
        digests = [hash((phases[k].tobytes(), intensities[k].tobytes())) for k in range(K)]
        for k, digest in enumerate(digests):
            cycles.see(first + k, digest)
        if cycles.period:
            fits = all(cycles.fits(first + k, digest) for k, digest in enumerate(digests))
            if fits and cycles.playing:
                return []
            if not fits:
                cycles.stop()
        commands: list[list[Any]] = [[] for _ in range(K)]
        for k, digest in enumerate(digests):
            if digest != self._held:
                commands[k].append(self._commands.Pattern(*self._row(phases[k], intensities[k])))
                self._held = digest
        if (spare := self._spare(first, K, time)) is not None:
            place = cycles.wrote(first + spare, digests[spare])
            row = self._row(phases[spare], intensities[spare])
            commands[spare].append(self._commands.WritePatternBuffer(self._bank, place, *row))
            if cycles.complete:
                commands[-1] += self._make_play_commands(cycles.period)
                cycles.playing, self._held = True, None
        return [
            (self._encode(self._geometry, these), k) for k, these in enumerate(commands) if these
        ]

    def _spare(self, first: int, K: int, time: float) -> int | None:
        """Return which of these rows to write to the spare bank."""
        cycles = self._cycles
        if not cycles.period:
            if not (period := cycles.found()):
                return None
            turn = round(time * self._rate)  # the bank follows the units' clock
            cycles.begin(period, turn - first)
        index = cycles.wants(range(first, first + K))
        return None if index is None else index - first

    def _make_play_commands(self, period: int) -> list[Any]:
        """Return the commands that play the spare bank."""
        every = self._value.SamplingConfig(CARRIER // self._rate)
        forever, now = self._value.LoopBehavior.Infinite, self._value.TransitionMode.Immediate
        return [
            self._commands.ConfigPattern(self._bank, every, period, forever),
            self._commands.ActivatePatternBank(self._bank, now),
        ]

    def _row(self, phase: Rows, intensity: Rows) -> tuple[Any, Any]:
        return (
            self._buffers.PhaseBuffer.from_array(phase),
            self._buffers.IntensityBuffer.from_array(intensity),
        )
