"""A fail-safe wrapper of the backend: every failure is reported and silences the output."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.errors import describe_error
from pacinian.rendering.report import Fault

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Backend, Frame
    from pacinian.rendering.report import Stage
    from pacinian.rendering.stage_timer import StageTimer


class FailSafeOutput:
    """Sends frames to a backend, and silences it after a fault.

    stages: the stage timer, which knows the stage of a fault and holds the report that counts it.
    """

    def __init__(self, backend: Backend, stages: StageTimer) -> None:
        self.backend = backend
        self.halted: Fault | None = None
        """The fault that keeps the output silent, if any."""
        self.loud = False
        """Whether a frame was sent since the output was last silenced."""
        self._stages = stages

    def send(self, frame: Frame) -> None:
        """Send a frame. Raises any exception of the backend."""
        self.loud = True
        self.backend.send(frame)
        self._stages.report.frames_sent += 1

    def attempt(self, stage: Stage, action: Callable[[], None]) -> bool:
        """Run `action`, and return whether it succeeded. A failure is reported, and halts and silences the output."""
        self._stages.stage, report = stage, self._stages.report
        try:
            action()
        except Exception as error:
            fault = Fault(report.ticks, self._stages.stage, describe_error(error), error)
            if self.halted is None or fault.stage != "silence":
                report.count_fault(fault)
            self.halted = self.halted or fault
            if stage != "silence":
                self.silence()
            return False
        return True

    def silence(self) -> None:
        """Silence the device; try again if Ctrl-C interrupts this."""
        if not self.loud:
            return
        try:
            done = self.attempt("silence", self.backend.silence)
        except KeyboardInterrupt:
            self._stages.report.interrupted = True
            done = self.attempt("silence", self.backend.silence)
        self.loud = not done

    def close(self) -> None:
        """Silence and close the device."""
        self.loud = True
        try:
            self.silence()
        finally:
            self.attempt("silence", self.backend.close)
