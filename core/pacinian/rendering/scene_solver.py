"""Sample a scene and solve for its samples: the job that runs in a tick, or in the background."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.frame_deviations import describe_solve
from pacinian.rendering.scene_warnings import is_too_fast
from pacinian.rendering.solution_sequence import SolutionSequence, SolveResult
from pacinian.rendering.weak_samples import WeakSamples, count_weak_samples, find_rising
from pacinian.scene.sampling.sample_counts import (
    FAR,
    ON_TRANSDUCER,
    SampleCounts,
    label_object,
    label_samples,
)
from pacinian.scene.sampling.sampler import SamplingMode

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.solver import Solver
    from pacinian.rendering.loop_settings import LoopSettings
    from pacinian.rendering.playback import Playback
    from pacinian.rendering.sample_solver import SampleSolver
    from pacinian.rendering.stage_timer import StageTimer
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.scene.scene import Scene
    from pacinian.solving.limits import Limits
    from pacinian.types import Floats


class SceneSolver:
    """Samples and solves for one scene after the other.

    sampler: samples scenes. sample_solver: solves for their samples. playback: rounds gains as the device does.
    settings: of the loop. now: the clock of solves in the background [s].
    """

    def __init__(
        self,
        sampler: Sampler,
        sample_solver: SampleSolver,
        playback: Playback,
        settings: LoopSettings,
        now: Callable[[], float],
    ) -> None:
        self._sampler, self._sample_solver, self._playback = sampler, sample_solver, playback
        self._settings, self._now = settings, now
        self._weak: tuple[tuple[object, ...], WeakSamples] = (), WeakSamples(Counter(), Counter())

    def prepare(self, limits: Limits, solver: Solver) -> None:
        """Set the mode of the sampler for the limits and the solver of the next solve."""
        settings, couples = self._settings, limits.couples_gains
        self._sampler.mode = SamplingMode(
            bands=1 if couples else self._sample_solver.cycle.max_bands,
            max_uniform_points=0.0 if couples else solver.max_uniform_points,
            peak=settings.peak,
            surround=solver.surrounds and not couples,
            strict=settings.strict,
            steers=not limits.forbids_steering,
            fine=not settings.adaptive,
        )

    def solve(
        self, scene: Scene, limits: Limits, solver: Solver, t: float, at: float, deadline: float, last: SolveResult,
        stages: StageTimer, *, in_background: bool,
    ) -> SolveResult:  # fmt: skip
        """Sample the scene of time t [s], and solve for its samples.

        at: time for which positions and gains hold [s]. deadline: of the solve, from its beginning [s]; may be
        infinite. last: the result that is played. stages: timer of the stages; the current one is "sample".
        in_background: whether this runs in the background.
        """
        begin = self._now() if in_background else math.nan
        sampler, sample_solver = self._sampler, self._sample_solver
        known = sampler.sample_counts
        samples = sampler.sample(scene, at, at - t)
        counts = sampler.sample_counts
        if counts is not known and len(counts.samples):
            self._note_unreachable(counts)
        stages.enter("solve")
        sample_solver.skins = sampler.pose_seen() if len(samples) else ()
        sample_solver.cycle.budget = sampler.frame_budget
        sample_solver.spares_solves = in_background and self._settings.adaptive
        solutions = sample_solver.solve(samples, t, limits, solver, deadline, at)
        fast, before = last.too_fast, last.solutions
        if (solutions.samples, solutions.frames) != (before.samples, before.frames):
            fast = self.find_too_fast(solutions)
        fresh, pressures, seconds = tuple(sample_solver.fresh), None, math.nan
        if in_background:
            # steering moves the field with its samples, so their pressures stay those of the solve
            same = (
                solutions.rows == last.solutions.rows and solutions.limits == last.solutions.limits
            )
            pressures = (
                last.sample_pressures if same else self._compute_pressures(solutions, limits)
            )
            seconds = self._now() - begin
            stages.enter("drive")  # ends "solve"
        rising = find_rising(solutions.samples, counts)
        deviations = describe_solve(counts, fast, self._count_weak_samples(solutions, rising))
        labels = frozenset((*counts.labels, *label_samples(solutions.samples)))
        hands = {skin.hand.name: skin.hand.carriers for skin in sample_solver.skins}
        return SolveResult(
            scene, counts, solutions, solver, fresh, pressures, at, seconds, fast, hands, labels,
            deviations,
        )  # fmt: skip

    def _count_weak_samples(self, solutions: SolutionSequence, rising: set[str]) -> WeakSamples:
        """Count the samples that press less than asked. Return the last result if nothing that matters has changed."""
        rows, missed, samples = solutions.rows, solutions.missed, solutions.solved_samples
        key = rows, missed, samples, rising
        if key != self._weak[0]:
            self._weak = key, count_weak_samples(solutions, rising)
        return self._weak[1]

    def _note_unreachable(self, counts: SampleCounts) -> None:
        """Note the samples that no sound can reach."""
        unreachable = self._sample_solver.reach.find_unreachable(counts.samples.positions)
        if unreachable is None:
            return
        far, on = unreachable
        for reason, found in (FAR, far), (ON_TRANSDUCER, on):
            if found.any():
                counts.drop(reason, found)

    def _compute_pressures(self, solutions: SolutionSequence, limits: Limits) -> Floats | None:
        """Return the pressures at the samples of new solutions.

        None if no propagator has these points any more.
        """
        solutions = replace(solutions, motion=None)
        samples = solutions.played_samples
        for frame in self._sample_solver.cycle.frames:
            propagator = frame.session.propagator
            whole = samples is not None and np.array_equal(propagator.points, samples.positions)
            if whole and propagator.quiet_subspace is None:
                gains = self._playback.quantise_frames(solutions, limits)
                p = [propagator.apply(g) for g in gains]
                return np.asarray(np.sqrt((np.abs(p) ** 2).mean(axis=0)))
        return None

    def find_too_fast(self, solutions: SolutionSequence) -> tuple[str, ...]:
        """Return the labels of the objects whose vibration the device cannot play.

        Each of several frames in turn has only its share of the device's rate.
        """
        items = solutions.samples.items
        rate = self._playback.capability.rate / solutions.frames
        used = np.unique(solutions.samples.objects).tolist()
        return tuple(label_object(items[i], i) for i in used if is_too_fast(items[i], rate))
