"""The present stage of a tick, and the total time of each stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.rendering.report import Report, Stage


class StageTimer:
    """Knows the present stage of a tick, and adds the duration of each stage to a report.

    now: returns the time [s]. report: may be replaced.
    """

    def __init__(self, now: Callable[[], float], report: Report) -> None:
        self.report = report
        self.stage: Stage = "open"
        self.now = now
        self._entered = 0.0  # [s]

    def begin(self, stage: Stage, report: Report, time: float) -> None:
        """Begin with this stage at `time` [s], and count in this report."""
        self.report, self.stage, self._entered = report, stage, time

    def enter(self, stage: Stage) -> None:
        """End the present stage and begin the next."""
        now = self.now()
        self.report.stages[self.stage] += now - self._entered
        self.stage, self._entered = stage, now
