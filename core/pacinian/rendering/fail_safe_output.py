"""The device behind the loop: whatever fails is reported, and silences it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.errors import describe_error
from pacinian.rendering.report import Fault

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Backend, Frame
    from pacinian.rendering.report import Stage, StageTimer


class FailSafeOutput:
    """Sends to a backend, and silences it.

    stages: say where a fault was, and have the report to count it in.
    """

    def __init__(self, backend: Backend, stages: StageTimer) -> None:
        self.backend = backend
        self.halted: Fault | None = None
        """The fault that holds it silent."""
        self.loud = False
        """Whether something was sent since the last silence."""
        self._stages = stages

    def send(self, frame: Frame) -> None:
        """Send a frame. Raises what the backend raises."""
        self.loud = True
        self.backend.send(frame)
        self._stages.report.frames_sent += 1

    def attempt(self, stage: Stage, action: Callable[[], None]) -> bool:
        """Do it; a failure is reported, halts, and silences the output."""
        self._stages.stage, report = stage, self._stages.report
        try:
            action()
        except Exception as error:
            fault = Fault(report.ticks, self._stages.stage, describe_error(error), error)
            if self.halted is None or fault.stage != "silence":
                report.fault(fault)
            self.halted = self.halted or fault
            if stage != "silence":
                self.silence()
            return False
        return True

    def silence(self) -> None:
        """Silence the device; once more if that is interrupted."""
        if not self.loud:
            return
        try:
            done = self.attempt("silence", self.backend.silence)
        except KeyboardInterrupt:
            self._stages.report.interrupted = True
            done = self.attempt("silence", self.backend.silence)
        self.loud = not done

    def close(self) -> None:
        """Silence, and give the device back."""
        self.loud = True
        try:
            self.silence()
        finally:
            self.attempt("silence", self.backend.close)
