"""Decide when the loop measures what the device emits."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.solving.felt_regions import FeltSums

TICKS_PER_LOOK = 64  # number of ticks between measurements of the emitted field
# Number of ticks from silence to the first measurement, so that the first solves have more time.
FIRST_LOOK = 4


class Measurement(NamedTuple):
    """How the device emits a solution: the arguments of `Report.add_measurement`."""

    error: float
    felt: dict[str, FeltSums]


class MeasurementSchedule:
    """Counts ticks, and knows what was measured last."""

    def __init__(self) -> None:
        self._passed = TICKS_PER_LOOK - FIRST_LOOK  # ticks since the last measurement
        self._measured: tuple[CachedSolution, ...] = ()

    def pass_ticks(self, played: SolutionSequence, count: int) -> None:
        """Count ticks that play this result, including those that the loop left out because it rested."""
        if len(played.samples):
            self._passed += count
        else:
            self._passed = TICKS_PER_LOOK - FIRST_LOOK

    def begin(self, solutions: SolutionSequence) -> bool:
        """Return whether to measure this now, and count it if so.

        Regions are measured again and again, at other places each time; points only if they have a new solution.
        """
        if self._passed < TICKS_PER_LOOK or not solutions.complete:
            return False
        samples, targets = solutions.played_samples, solutions.targets
        if not samples or targets is None:
            return False
        if targets.regions is None and solutions.rows == self._measured:
            return False
        self._passed, self._measured = 0, solutions.rows
        return True
