"""A background in which a solve is done when the test says so."""

from concurrent.futures import Future
from typing import Any

import pacinian as pc
from pacinian.rendering.background_solve import BackgroundSolve
from pacinian.rendering.solve_schedule import SolveSchedule


class ByHand(BackgroundSolve[Any]):
    """Runs a job when its result is taken. ready: whether it is done."""

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


class TakesTicks(SolveSchedule):
    """Expects that every solve takes the same number of ticks."""

    def note_solve(self, seconds: float, whole: bool = True) -> None:
        pass


def solve_beside(renderer: pc.Renderer, ticks: int | None = None) -> ByHand:
    """Let solves of an open renderer run beside its ticks from now on. ticks: that each is expected to take."""
    background = renderer._pipeline.background = ByHand()
    if ticks is not None:
        renderer._pipeline.schedule = TakesTicks(renderer.period, ticks=ticks)
    renderer.schedule.beside = True
    return background
