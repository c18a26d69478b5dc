"""Run the built-in scenes: time per tick by stage, late ticks compared with a dummy loop's, error of the pressures."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import matrix
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.demo_scene import alternate
from pacinian.gallery import SCENES, TRACKED
from pacinian.plugins import registry
from pacinian.rendering.renderer import Renderer
from pacinian.scene.sampling.sampler import Sampler
from pacinian.solving.felt_figures import FeltRegion
from pacinian_lab.regions.skin import measure_felt

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.rendering.report import Report
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene
    from pacinian.solving.targets import Targets
    from pacinian.types import Gains

RATE = 1000.0  # [Hz] of the device, and of the ticks if the loop can hold it
SLOWER = (2, 3, 4, 5, 8, 10, 20)  # frames per tick, tried in turn
# the rate counts as held up to this share of late ticks above the dummy loop's
MAX_LATE_ABOVE_DUMMY = 0.005
SPARE = 2.0  # delay of the loop that the scenes made in advance allow [s]
EVALUATED_TICKS = 20  # ticks per run whose errors are evaluated
NO_BUDGET = 100_000  # samples; in effect, no budget


@dataclass(frozen=True)
class Row:
    """Results of a scene.

    p50_ms, p99_ms: of the ticks at 1 kHz. late: fraction of ticks that ended after the next tick was due; dummy_late:
    of a dummy loop in the same run. rate: highest rate held [Hz], 0 for none: p99 within a tick, and at most half a
    percentage point more late ticks than the dummy loop. solves: per second [1/s]. lag_ms: time of a tick minus the
    moment for which its solution was made, median [ms]; negative if that lies ahead. samples: median. stages: mean time
    per tick [ms]. error_at_samples: ||(|p| - t)|| / ||t|| of the sound pressures that press on the samples, median.
    felt: force, rms, holes and spill over all skin that regions touch, medians of the evaluated ticks with contact;
    None if there are none. left_out: fraction of the scene's force that was not requested from the array.
    """

    scene: str
    p50_ms: float
    p99_ms: float
    late: float
    dummy_late: float
    rate: float
    solves: float
    lag_ms: float
    samples: int
    stages: dict[str, float]
    error_at_samples: float
    felt: dict[str, float] | None
    left_out: float


@dataclass(frozen=True, eq=False)
class EvaluatedTick:
    """Input and output of a tick, at time t [s] of the scene.

    sounding: gains of the frames that the device plays in turn, (K, N); their mean counts. lag: t minus the moment for
    which they were solved [s].
    """

    t: float
    scene: Scene
    samples: Samples
    targets: Targets
    sounding: Gains
    lag: float

    @property
    def asked(self) -> float:
        """Force of all objects together on all skin that they touch, by their materials [N]."""
        return Sampler(NO_BUDGET, perception=False).sample(self.scene, self.t).force

    def compute_sounded(self, medium: Air) -> float:
        """Return the part of that force that was requested from the array [N]."""
        return float(radiation_pressure(self.targets.amplitudes, medium) @ self.samples.area)

    def error(self, array: Array, medium: Air) -> float:
        """Return the relative error of the emitted sound pressures at the samples, in double precision."""
        q = self.samples.positions
        B = matrix(array, q, medium)
        if self.samples.capsules is not None:
            facing = SkinFacing(self.samples.normals, self.samples.capsules)
            B = B * facing.weights(q, array.positions)
        p = B @ self.sounding.T
        return self.targets.relative_error(np.sqrt((np.abs(p) ** 2).mean(axis=1)))


class Run:
    """A scene on a renderer, which alternates with a dummy loop, for `seconds` [s].

    Scenes are computed before the run, so ticks do not pay for them (for delays of up to SPARE). rate: of the ticks
    [Hz]. After `execute`, `report` is the renderer's, and `dummy` that of the dummy loop.
    """

    def __init__(
        self, array: Array, scene: Callable[[float], Scene], seconds: float, rate: float = RATE
    ) -> None:
        self.evaluated: list[EvaluatedTick] = []
        self._seconds = seconds

        @functools.cache
        def at(update: int) -> Scene:
            return scene((update + 0.5) / TRACKED)

        self._scene = at
        for k in range(math.ceil((2.0 * seconds + SPARE) * TRACKED)):
            self._scene(k)
        self._now = 0.0, self._scene(0)
        device = registry.backend("simulated", rate=RATE)
        self.renderer = Renderer(array, self._at, backend=device, rate=rate)
        # ticks from one evaluated tick to the next
        self._gap = max(1, round(seconds * rate / EVALUATED_TICKS))

    def execute(self) -> None:
        """Run both loops, and keep the data of some ticks. Raises KeyboardInterrupt, and the error of a failed tick."""
        with self.renderer as renderer:
            self.dummy = alternate(renderer, self._seconds, self._keep_tick)
            self.report = renderer.report
        if self.report.interrupted:
            raise KeyboardInterrupt
        for fault in self.report.faults:
            raise fault.cause

    def _at(self, t: float) -> Scene:
        self._now = t, self._scene(int(t * TRACKED))
        return self._now[1]

    def _keep_tick(self, report: Report) -> None:
        """Keep the data of a tick for evaluation after the run."""
        samples, targets = self.renderer.samples, self.renderer.targets
        if (
            samples is None
            or targets is None
            or report.ticks < self._gap * (len(self.evaluated) + 1)
        ):
            return
        sounding, lag = self.renderer.cycle_gains, self.renderer.lag
        self.evaluated.append(EvaluatedTick(*self._now, samples, targets, sounding, lag))

    @property
    def held(self) -> bool:
        """Whether the loop held the rate."""
        in_time = self.report.tick_ms(99) < 1e3 * self.renderer.period
        return in_time and self.report.late_share <= self.dummy.late_share + MAX_LATE_ABOVE_DUMMY

    def row(self, name: str) -> Row:
        """Return the results."""
        report, session = self.report, self.renderer.session
        array, medium = session.array, session.medium
        asked = sum(tick.asked for tick in self.evaluated)
        sounded = sum(tick.compute_sounded(medium) for tick in self.evaluated)
        return Row(
            scene=name,
            p50_ms=report.tick_ms(50),
            p99_ms=report.tick_ms(99),
            late=report.late_share,
            dummy_late=self.dummy.late_share,
            rate=1.0 / self.renderer.period if self.held else 0.0,
            solves=report.solves / (report.ticks * self.renderer.period),
            lag_ms=1e3 * median(tick.lag for tick in self.evaluated),
            samples=round(median(len(tick.samples) for tick in self.evaluated)),
            stages={k: 1e3 * v / report.ticks for k, v in report.stages.items()},
            error_at_samples=median(tick.error(array, medium) for tick in self.evaluated),
            felt=self._measure_felt(array, medium),
            left_out=max(0.0, 1.0 - sounded / asked) if asked else 0.0,
        )

    def _measure_felt(self, array: Array, medium: Air) -> dict[str, float] | None:
        """Return the medians of what the skin felt, over the evaluated ticks with contact."""
        every = [
            measure_felt(array, medium, tick.scene, tick.t, tick.sounding)
            for tick in self.evaluated
        ]
        found = [felt for felt in every if felt is not None]
        if not found:
            return None
        return FeltRegion(*np.median(np.array(found), axis=0).tolist())._asdict()


def measure(array: Array, name: str, seconds: float) -> Row:
    """Run a built-in scene for `seconds` [s] at 1 kHz, then at lower rates until the loop holds one.

    Raises KeyboardInterrupt, and the error of a failed tick.
    """
    run = Run(array, SCENES[name], seconds)
    run.execute()
    row = run.row(name)
    for frames in SLOWER:
        if row.rate:
            break
        slower = Run(array, SCENES[name], seconds, RATE / frames)
        slower.execute()
        row = replace(row, rate=RATE / frames if slower.held else 0.0)
    return row
