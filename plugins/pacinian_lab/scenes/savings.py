"""What a tick saves by not doing again, or at all, what it need not: on against off, tick by tick in turn."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from pacinian.plugins import registry
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.slew_limiter import Smoothing
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.solving.blas import one_thread
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend

At = Callable[[float], Scene]
"""From time [s] to a scene."""

PERIOD = 0.001  # [s]
BEFORE = 20  # ticks that are not measured


def _nothing(renderer: Renderer) -> None:
    pass


@dataclass(frozen=True)
class Skip:
    """Something that a tick may skip.

    what: in words. on, off: the scene with it, and without it. before: what takes it away, ahead of each
    tick without it; not timed. sampler: without it. limit: of the ratio; None for no target.
    """

    what: str
    on: At
    off: At
    before: Callable[[Renderer], object] = _nothing
    sampler: Callable[[], Sampler] = Sampler
    limit: float | None = None


@dataclass(frozen=True)
class Saving:
    """Medians of the ticks' times with a skip and without [ms]."""

    what: str
    on_ms: float
    off_ms: float
    limit: float | None = None

    @property
    def ratio(self) -> float:
        """What is left of a tick."""
        return self.on_ms / self.off_ms


class Side:
    """A renderer whose ticks are timed; no ramps, no smoothing, so that both sides sound the same.

    Its own clock stands still, so that both are at the same times of the scene, and no one hurries.
    """

    def __init__(
        self,
        array: Array,
        scene: At,
        sampler: Sampler | None = None,
        before: Callable[[Renderer], object] = _nothing,
    ) -> None:
        self.clock, self.times, self.before = ManualClock(), list[float](), before
        self.device: Backend = registry.backend("simulated", rate=1.0 / PERIOD)
        self.renderer = Renderer(
            array,
            scene,
            backend=self.device,
            sampler=sampler or Sampler(),
            smoothing=Smoothing(rate=None),
            governed=False,
            cycle=1,
            clock=self.clock,
        )

    def tick(self, t: float) -> None:
        """A tick at time t [s] of the scene. Raises what went wrong in it."""
        self.clock.time = t
        self.before(self.renderer)
        begin = time.perf_counter()
        self.renderer.tick(t)
        self.times.append(time.perf_counter() - begin)
        for fault in self.renderer.report.faults:
            raise fault.error or RuntimeError(fault.message)

    @property
    def median_ms(self) -> float:
        """Of the measured ticks."""
        return 1e3 * median(self.times[BEFORE:])


def measure(array: Array, skip: Skip, ticks: int) -> Saving:
    """So many ticks with the skip and without it, in turn."""
    on = Side(array, skip.on)
    off = Side(array, skip.off, skip.sampler(), skip.before)
    take_turns([on, off], ticks)
    return Saving(skip.what, on.median_ms, off.median_ms, skip.limit)


def take_turns(sides: list[Side], ticks: int) -> None:
    """Let each have so many measured ticks, all at the same times, forwards and backwards in turn."""
    for side in sides:
        side.renderer.open()
    try:
        with one_thread():
            for k in range(BEFORE + ticks):
                for side in sides if k % 2 else sides[::-1]:
                    side.tick(k * PERIOD)
    finally:
        for side in sides:
            side.renderer.close()
