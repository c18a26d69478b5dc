"""Measure what a tick saves by skipping work: with and without the skip, tick by tick in turn."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from pacinian.plugins import registry
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.solving.blas import limit_blas_threads
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array

At = Callable[[float], Scene]
"""A function from time [s] to a scene."""

PERIOD = 0.001  # [s]
BEFORE = 20  # warm-up ticks, which are not measured


def _do_nothing(renderer: Renderer) -> None:
    pass


@dataclass(frozen=True)
class Skip:
    """Work that a tick may skip.

    what: description. on, off: the scene with and without the skip. before: disables the skip before each tick
    without it; not timed. sampler: without the skip. limit: of the ratio; None for no target.
    """

    what: str
    on: At
    off: At
    before: Callable[[Renderer], object] = _do_nothing
    sampler: Callable[[], Sampler] = Sampler
    limit: float | None = None


@dataclass(frozen=True)
class Saving:
    """Median tick times with and without a skip [ms]."""

    what: str
    on_ms: float
    off_ms: float
    limit: float | None = None

    @property
    def ratio(self) -> float:
        """Fraction of a tick's time that remains."""
        return self.on_ms / self.off_ms


class Side:
    """A renderer whose ticks are timed, without ramps or smoothing, so that both sides emit the same.

    The renderer's clock is set by hand, so that both sides are at the same times of the scene and the budget stays
    the same.
    """

    def __init__(
        self,
        array: Array,
        scene: At,
        sampler: Sampler | None = None,
        before: Callable[[Renderer], object] = _do_nothing,
    ) -> None:
        self.clock, self.times, self.before = ManualClock(), list[float](), before
        self.renderer = Renderer(
            array,
            scene,
            backend=registry.backend("simulated", rate=1.0 / PERIOD),
            sampler=sampler or Sampler(),
            smoothing=Smoothing(rate=None),
            adaptive=False,
            max_cycle_frames=1,
            clock=self.clock,
        )

    def tick(self, t: float) -> None:
        """Run a tick at time t [s] of the scene. Raises its error if it fails."""
        self.clock.time = t
        self.before(self.renderer)
        begin = time.perf_counter()
        self.renderer.tick(t)
        self.times.append(time.perf_counter() - begin)
        for fault in self.renderer.report.faults:
            raise fault.cause

    @property
    def median_ms(self) -> float:
        """Median time of the measured ticks [ms]."""
        return 1e3 * median(self.times[BEFORE:])


def measure(array: Array, skip: Skip, ticks: int) -> Saving:
    """Measure `ticks` ticks with and without the skip, in turn."""
    on = Side(array, skip.on)
    off = Side(array, skip.off, skip.sampler(), skip.before)
    take_turns([on, off], ticks)
    return Saving(skip.what, on.median_ms, off.median_ms, skip.limit)


def take_turns(sides: list[Side], ticks: int) -> None:
    """Let each side run `ticks` measured ticks at the same times, in alternating order."""
    for side in sides:
        side.renderer.open()
    try:
        with limit_blas_threads():
            for k in range(BEFORE + ticks):
                for side in sides if k % 2 else sides[::-1]:
                    side.tick(k * PERIOD)
    finally:
        for side in sides:
            side.renderer.close()
