"""Decide when the loop measures what the device emits."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Collection

    from pacinian.rendering.field_steering import Motion
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.solving.felt_figures import FeltSums

TICKS_PER_MEASUREMENT = 64  # smallest number of ticks between measurements of the emitted field
# Largest random number of additional ticks, so that measurements fall at all moments between two solutions.
MAX_DELAY = 16
# Number of ticks from the end of silence and of the ramps that follow it to the first measurement. The first solves
# then have more time, and all frames of a cycle are solved for the full pressures.
TICKS_TO_FIRST_MEASUREMENT = 8
MAX_RAMP_TICKS = 64  # largest number of ticks for which ramps delay the first measurement
# Largest number of measurements of regions that rest, at other places each time.
MAX_MEASUREMENTS_AT_REST = 8


class Measurement(NamedTuple):
    """How the device emits a solution: the arguments of `Report.add_measurement`."""

    error_at_samples: float
    felt: dict[str, FeltSums]
    on_skin: Collection[str]


class MeasurementSchedule:
    """Counts ticks, and knows what was measured last.

    first: number of ticks until the first measurement.
    """

    def __init__(self, first: int = TICKS_TO_FIRST_MEASUREMENT) -> None:
        self._wait = first  # ticks until the next measurement
        self._ramp_ticks = MAX_RAMP_TICKS  # ticks for which ramps may still delay it
        self._rng = np.random.default_rng(0)
        self._measured: SolutionSequence | None = None
        self._measurements = 0  # of these solutions at rest

    def pass_ticks(self, played: SolutionSequence, count: int, *, rising: bool) -> None:
        """Count ticks that play this result, including those that the loop left out because it rested.

        rising: whether pressures are clearly below what is asked for, because their ramps have not ended.
        """
        if not len(played.samples):
            self._wait, self._ramp_ticks = TICKS_TO_FIRST_MEASUREMENT, MAX_RAMP_TICKS
        elif rising and self._ramp_ticks > 0:
            self._ramp_ticks -= count
        else:
            self._wait -= count

    def begin(self, solutions: SolutionSequence) -> bool:
        """Return whether to measure what is played now, and count it if so."""
        if self._wait > 0 or not solutions.complete:
            return False
        samples, targets = solutions.played_samples, solutions.targets
        if not samples or targets is None:
            return False
        last = self._measured
        same = last is not None and solutions.rows == last.rows
        if same and targets.regions is None:
            return False
        rests = same and last is not None and _rest_at_one_place(solutions.motion, last.motion)
        if rests and self._measurements >= MAX_MEASUREMENTS_AT_REST:
            return False
        self._measurements = self._measurements + 1 if rests else 1
        self._ramp_ticks = 0
        self._wait = TICKS_PER_MEASUREMENT + int(self._rng.integers(MAX_DELAY))
        self._measured = solutions
        return True


def _rest_at_one_place(motion: Motion | None, other: Motion | None) -> bool:
    """Return whether two motions have the same place, and rest there."""
    if motion is None or other is None:
        return motion is other
    return motion.rests_like(other)
