"""A background whose solves end when the test says so."""

from concurrent.futures import Future
from typing import Any

import pacinian as pc
from pacinian.rendering.background_schedule import BackgroundSchedule
from pacinian.rendering.background_solve import BackgroundSolve


class ManualBackground(BackgroundSolve[Any]):
    """A background that runs a job when its result is taken. ready: whether the job counts as done."""

    def __init__(self) -> None:
        super().__init__()
        self.ready = True
        self.started = 0

    @property
    def done(self) -> bool:
        return self.ready

    def start(self, job: Any) -> None:
        self.started += 1
        self._job = job, Future()

    def take(self) -> Any:
        assert self._job is not None
        (job, _), self._job = self._job, None
        return job()

    def drop(self) -> None:
        self._job = None


class SolvesAlways(BackgroundSchedule):
    """A schedule that begins a solve as soon as the last one is done, and expects a constant duration."""

    def begin_solve(self, changed: bool, urgent: bool = False) -> bool:
        return True

    def note_solve(self, seconds: float, whole: bool = True) -> None:
        pass


def solve_beside(renderer: pc.Renderer, ticks: int = 1) -> ManualBackground:
    """Let solves of an open renderer run beside all its ticks from now on. ticks: the expected duration of each."""
    background = renderer._pipeline.background = ManualBackground()
    renderer._pipeline.schedule = SolvesAlways(renderer.period, True, ticks, ticks)
    return background
