"""Make a frame from a scene: sample, solve, modulate and quantise, as far as time allows.

Sampling and solving are one job. It runs in the tick, or in a thread of its own if ticks would be late. Only its
result (`SolveResult`) passes to the rest of the tick.
"""

from __future__ import annotations

import math
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from pacinian.rendering.background_schedule import (
    GOOD_SOLVE_TIME,
    MAX_LEAD,
    BackgroundSchedule,
)
from pacinian.rendering.background_solve import BackgroundSolve, start_daemon
from pacinian.rendering.emitted_measurement import Probe
from pacinian.rendering.felt_monitor import FeltMonitor
from pacinian.rendering.frame_cycle import Cycle, split_frames
from pacinian.rendering.frame_deviations import FrameDeviations
from pacinian.rendering.measurement_schedule import Measurement
from pacinian.rendering.new_hand_check import NewHandCheck
from pacinian.rendering.playback import Playback
from pacinian.rendering.row_times import compute_row_times
from pacinian.rendering.sample_budget_controller import SHRINK_LOAD, SampleBudgetController
from pacinian.rendering.sample_solver import SampleSolver
from pacinian.rendering.scene_solver import SceneSolver
from pacinian.rendering.scene_warnings import add_warnings, find_warnings
from pacinian.rendering.solution_sequence import SolutionSequence, SolveResult
from pacinian.rendering.solve_deadline import SolveDeadline
from pacinian.rendering.stage_timer import StageTimer
from pacinian.rendering.steered_solver import STEERED_TIME_FACTOR
from pacinian.rendering.warmup import load_envelopes, try_out
from pacinian.scene.sampling.sample_counts import SampleCounts
from pacinian.scene.sampling.samples import no_samples
from pacinian.scene.scene import Scene
from pacinian.skip_reasons import MEASUREMENTS_FAILED, NOT_DUE, NOTHING_CHANGED, UNDER_WAY
from pacinian.solving.limits import Limits

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Capability, Frame
    from pacinian.plugins.solver import Solver
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.loop_settings import LoopSettings
    from pacinian.rendering.recording_clock import RecordingClocks
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.session import Session

# The loop waits for a background solve that has run for this long [s], or for `max_ticks` ticks if that is longer.
WAIT_FOR_SOLVE_AFTER = 0.02


class Pipeline:
    """Makes the frames of one render loop.

    session: solves. sampler: samples the scene. settings: of the loop. capability: of the device. stages: stage timer,
    which also holds the report. clocks: of the ticks, and of sampling and solving; `session` uses the latter, too.
    start_thread: starts the thread that solves in the background. Raises ArgumentError.
    """

    def __init__(
        self,
        session: Session,
        sampler: Sampler,
        settings: LoopSettings,
        capability: Capability,
        stages: StageTimer,
        clocks: RecordingClocks,
        start_thread: Callable[[Callable[[], object], str], None] = start_daemon,
    ) -> None:
        period, most = settings.period, settings.max_cycle_frames
        self.session, self.sampler, self.period = session, sampler, period
        self.stages, self._settings, self._clocks = stages, settings, clocks
        sampler.prepare(session.array, session.medium)
        self.playback = Playback(
            session.array, session.medium, settings.smoothing, capability, period
        )
        cycle = Cycle(session, split_frames(most, capability.rate), sampler.budget, settings.peak)
        cycle.coarsens = not settings.strict
        self.solver = SampleSolver(
            session, self.playback.times, cycle, round_gains=self.playback.quantise_gains
        )
        self._skipped = sampler.skipped = self.solver.skipped  # of a job, until it is taken
        peak = settings.peak if settings.adaptive else math.inf
        self._new_hands = NewHandCheck(peak, self.playback, self.solver.skin_limit)
        self._scene_solver = SceneSolver(
            sampler, self.solver, self.playback, settings, clocks.job.now
        )
        self.deadline = SolveDeadline(period, adaptive=settings.adaptive)
        session.is_cancelled = self._is_cancelled
        self.budget_controller = (
            SampleBudgetController(period, sampler.budget) if settings.adaptive else None
        )
        self._allowed = sampler.budget  # number of samples that the next job may use
        self.background = BackgroundSolve[SolveResult | Measurement | None](start_thread)
        self._job_stages = StageTimer(stages.now, stages.report)
        self.limits = Limits()  # of this tick
        self.probe, self._monitor = Probe(session), FeltMonitor(session, sampler, self.playback)
        self.schedule, self._in_background = BackgroundSchedule(period), False
        self._begin()

    def _begin(self) -> None:
        empty = SolveResult(
            Scene(),
            SampleCounts(),
            SolutionSequence(no_samples(), self.limits),
            self.session.solver,
        )
        self.played = self._before = empty
        """The result that the last frame plays."""
        self._silenced = False  # whether the last frame is silent because of a new hand
        self._taken: SolveResult | None = None  # of this tick
        self.lag = 0.0
        """Age of the last frame's scene [s]: the last tick's time minus the scene time that the frame was solved for.

        Negative if the frame was solved for a later time.
        """
        self._play_time = -math.inf  # scene time for which the last job solved [s]
        self._valid_at = 0.0  # last scene time for which what is played is known to be right [s]
        self._rested = 0  # ticks since the last one that solved
        # clock reading when the job that runs in the background began, or became outdated [s]
        self._started = 0.0
        self.deadline.reset()
        self._measures = False  # whether the job in the background only measures
        self._solved_now = False  # whether the last tick solved
        self._seen: Scene | None = None
        self._changed = True  # whether the scene has changed since the last job began
        # whether the result of the job in the background, which has no deadline, is no longer needed
        self._outdated = False
        self._deviations = FrameDeviations()
        # Time of the last tick [s]; whether its frame was the one before.
        self._time, self._repeated = math.nan, False
        self.job_readings: list[float] = []
        """Clock readings of the jobs whose results this tick has taken [s]."""

    def warm_up(self, scene: Callable[[float], Scene], limits: Limits) -> Scene | None:
        """Sample the scene at time 0, and solve and quantise for a few points, without output.

        Returns the scene; None after an exception, which the first tick will raise and report again. If `strict`, the
        exception is raised at once.
        """
        # a replay begins in this state, too
        self.schedule, self._in_background = BackgroundSchedule(self.period), False
        try:
            self.playback.quantise_gains(try_out(self.session).gains, limits)
            first, self.limits = scene(0.0), limits
            self._scene_solver.prepare(limits, self.session.solver)
            self.sampler.sample(first)
            load_envelopes(first, self.playback.times)
        except Exception:
            if self._settings.strict:
                raise
            return None
        return first

    def warn(self, first: Scene, limits: Limits) -> None:
        """Log warnings about the scene that `warm_up` has returned, and keep them in the report."""
        capability, period = self.playback.capability, self.period
        found = find_warnings(first, self.sampler, self.session, limits, capability, period)
        add_warnings(self.stages.report, found)

    def use(self, capability: Capability) -> None:
        """Make frames for a device with this capability from now on. Raises ArgumentError."""
        if capability == self.playback.capability:
            return
        times, gap = compute_row_times(capability, self.period)
        self._discard_job()
        self.playback.use(capability, times, gap)
        fast = self._scene_solver.find_too_fast(self.played.solutions)
        self.played = self.played._replace(sample_pressures=None, too_fast=fast)
        self.solver.times = times
        if self.limits.zones:
            self.reset()  # because the solutions keep the zones quiet only as the last device rounds
        self.solver.cycle.most = split_frames(self._settings.max_cycle_frames, capability.rate)

    def reset(self) -> None:
        """Discard all state and start from silence. Solves run where they ran at the last frame that was sent."""
        self._outdated = True
        self.background.drop()
        self._skipped.clear()
        self.sampler.reset()
        self.solver.reset()
        self.playback.reset()
        self.session.forget()
        self._monitor.reset()
        self._clocks.job.take()
        # a recording does not contain what a tick without a frame has counted
        self.schedule = BackgroundSchedule(self.period, in_background=self._in_background)
        self._begin()
        if self.budget_controller is not None:
            self.budget_controller = SampleBudgetController(self.period, self.sampler.budget)
            self.sampler.allowed = self._allowed = self.sampler.budget

    def finish_measuring(self) -> None:
        """Wait for the measurement that runs in the background, if one does."""
        if self._measures and self.background.running:
            self._take_job()

    def close(self) -> None:
        """Let the thread that solves in the background end."""
        self._outdated = True
        self.background.close()

    @property
    def repeats(self) -> bool:
        """Whether the last tick repeated the frame before it, and the next ones will, if nothing changes.

        False while a job runs in the background, and while a changed scene waits for one.
        """
        return self._repeated and not (self._changed or self.background.running)

    def make_frame(
        self, scene: Scene, limits: Limits, t: float, due: float, sequence: int
    ) -> Frame:
        """Return the frame for a scene at time t [s], due at `due` [s]; reuses the last one if nothing changed."""
        self.limits, self._taken, self.job_readings = limits, None, []
        self._changed, self._seen = self._changed or scene is not self._seen, scene
        if self._changed and self.deadline.unhurried and not self._outdated:
            self._outdated, self._started = True, self.stages.now()
        solver = self.session.solver  # other threads may set another one at any time
        ticks, kept = self._count_ticks(t), self._is_kept(limits, solver)
        waits = kept and self.schedule.in_background
        silenced = self._new_hands.may_exceed_limit(scene, self.played, t)
        if waits:
            self._solve_in_background(scene, limits, solver, t, ticks)
        elif not (silenced and self.playback.sounds):
            self._solve_in_tick(scene, limits, solver, t, ticks, kept=kept)
        self._silenced = silenced and self._new_hands.may_exceed_limit(scene, self.played, t)
        self.lag = t - self._valid_at
        play = self.played.solutions
        inputs = play.samples, limits, solver, self._silenced
        spread = self.schedule.find_spread(ends=not len(play.samples)) if waits else 1
        if self._silenced:
            play, spread = play.muted, 1
        same = self.playback.follow(play, inputs, t, spread)
        self._repeated = same and not self._fresh
        if self._repeated:
            self.stages.report.skipped[NOTHING_CHANGED] += 1
            frame = self.playback.repeat(sequence, due)
        else:
            self.stages.enter("drive")
            frame = self.playback.make_frame(play, limits, inputs, t, spread, sequence, due)
        if not self._silenced:
            self._monitor.watch(scene, self.played, limits, t, ticks)
        return frame

    def _count_ticks(self, t: float) -> int:
        """Return the number of ticks from the last one to that at time t [s]: 1, unless the loop has rested."""
        last, self._time = self._time, t
        return max(1, round((t - last) / self.period)) if self._repeated and t > last else 1

    def _is_kept(self, limits: Limits, solver: Solver) -> bool:
        """Return whether the last result may still be played if the scene has not changed."""
        last = self.played
        same = last.solutions.limits == limits and last.solver is solver
        return same and not last.solutions.one_tick_only

    def _solve_in_tick(
        self, scene: Scene, limits: Limits, solver: Solver, t: float, ticks: int, *, kept: bool
    ) -> None:
        """Sample and solve in this tick, unless the scene is at rest. Then measure, in the background if adaptive.

        ticks: number of ticks since the last one. kept: whether the last result may be played.
        """
        if not self._measures:
            self._discard_job()
        elif self.background.done or self._clocks.tick.replays:
            self._take_job()  # the time of this is not recorded; `_solve_in_background` forgets it
        self._rested += ticks
        if kept and not self._changed and self.schedule.may_rest(self._rested * self.period):
            self.stages.report.skipped[NOT_DUE] += 1
            self._valid_at = t
        else:
            self._solve_now(scene, limits, solver, t)
        # the last measurement may still be under way, with the propagator that the next one needs
        if self.background.running or (measure := self._monitor.take_job()) is None:
            return
        if self._settings.adaptive and not self._clocks.tick.replays:
            self._start_job(measure, measures=True)
        else:
            self._count_measurement(measure())

    def _solve_now(self, scene: Scene, limits: Limits, solver: Solver, t: float) -> None:
        """Sample and solve in this tick."""
        if self._rested > 1:
            self.sampler.rest_until(t - self.period)
        self._rested, self._solved_now = 0, True
        self.stages.enter("sample")
        self._play(self._make_job(scene, limits, solver, t, self.stages, in_background=False)())

    def _solve_in_background(
        self, scene: Scene, limits: Limits, solver: Solver, t: float, ticks: int
    ) -> None:
        """Take the result of the job in the background if it is done, and start the next if it is time to.

        ticks: number of ticks since the last one.
        """
        if self._solved_now:
            self.finish_measuring()
            self._monitor.forget()  # because measurements in the background delay solves
            self._solved_now = False
        self.schedule.pass_ticks(ticks)
        if self.background.running:
            if not self._is_done():
                self.stages.report.skipped[UNDER_WAY] += 1
                return
            result = self._take_job()
            if result is not None and result.solutions.one_tick_only:
                self._solve_now(scene, limits, solver, t)
                return
        # measure in the pause between two solves, so that no solution waits for the measurement
        if (measure := self._monitor.take_job()) is not None:
            self._start_job(measure, measures=True)
        elif self.schedule.begin_solve(self._changed, not scene.objects):
            job = self._make_job(scene, limits, solver, t, self._job_stages, in_background=True)
            self._start_job(job, measures=False)
        else:
            self.stages.report.skipped[NOT_DUE] += 1

    def _start_job(
        self, job: Callable[[], SolveResult | Measurement | None], *, measures: bool
    ) -> None:
        """Start a job in the background. measures: whether it only measures, so that it may run beside a solve."""
        # a thread must not enter the tick's stages
        self._job_stages.begin("sample", self.stages.report, self.stages.now())
        self._started, self._measures = self.stages.now(), measures
        self.background.deferred = self._clocks.tick.replays
        self.background.start(job)

    def _take_job(self) -> SolveResult | None:
        """Wait for the job in the background, and use its result. Return the result of a solve, or None."""
        self._measures = False
        try:
            result = self.background.take()
        except BaseException:
            self.stages.stage = self._job_stages.stage
            raise
        if isinstance(result, SolveResult):
            self._play(result)
            return result
        self._count_measurement(result)
        return None

    def _count_measurement(self, measured: Measurement | None) -> None:
        """Add a measurement to the report; None if it has failed."""
        if measured is None:
            self.stages.report.skipped[MEASUREMENTS_FAILED] += 1
        else:
            self.stages.report.add_measurement(*measured)

    def _is_done(self) -> bool:
        """Return whether to take the result of the job now; recorded, because the job's duration decides it."""
        limit = max(WAIT_FOR_SOLVE_AFTER, self.schedule.max_ticks * self.period)
        if self.played.solutions.motion is not None and not (self._seen and self._seen.hands):
            limit *= STEERED_TIME_FACTOR
        if self._seen and self._seen.objects:  # without objects, the sound must end soon
            limit *= 1.0 if self._outdated else self.deadline.factor
        overdue = self.stages.now() - self._started >= limit
        return bool(
            self._clocks.tick.record_decision(lambda: float(overdue or self.background.done))
        )

    def _discard_job(self) -> None:
        """Wait for the job in the background, if one runs, and drop its result."""
        if self.background.running:
            self._outdated = True
            with suppress(Exception):  # the next job will raise it again
                self.background.take()
            self._changed = self._changed or not self._measures
            self._measures = False
            self.job_readings += self._clocks.job.take()

    def _make_job(
        self, scene: Scene, limits: Limits, solver: Solver, t: float, stages: StageTimer, *, in_background: bool
    ) -> Callable[[], SolveResult]:  # fmt: skip
        """Return a function that samples and solves. in_background: whether it runs in the background."""
        at_rest = self.schedule.rests and not self._changed
        if self._changed:  # even if it has changed back since
            self.sampler.invalidate()
        self._changed = self._outdated = False
        if self.budget_controller is not None:
            self.sampler.allowed = self._allowed
        self._scene_solver.prepare(limits, solver)
        rows = self.played.solutions.rows
        if in_background:
            unhurried = at_rest and bool(rows) and rows[0].awaits_rest
            deadline = self.deadline.choose_background_deadline(
                self.schedule.max_ticks, unhurried=unhurried
            )
        else:
            deadline = self.deadline.choose_tick_deadline()
        at = self._find_play_time(t, in_background)
        return partial(
            self._scene_solver.solve,
            scene, limits, solver, t, at, deadline, self.played, stages, in_background=in_background,
        )  # fmt: skip

    def _is_cancelled(self) -> bool:
        """Return whether the solve in the background is to end at once: it has no deadline, and the scene has changed.

        Recorded, because it depends on how long the solve takes.
        """
        if not self.deadline.unhurried:
            return False
        return bool(self._clocks.job.record_decision(lambda: float(self._outdated)))

    def _find_play_time(self, t: float, in_background: bool) -> float:
        """Return the scene time for which a job that begins at time t solves [s].

        In the background, this is the time at which frames will reach its result. Never returns an earlier time than
        the last call, unless time jumps back.
        """
        last = self._play_time if self._play_time <= t + MAX_LEAD else -math.inf
        self._play_time = max(t + (self.schedule.lead if in_background else 0.0), last)
        return self._play_time

    def _play(self, outcome: SolveResult) -> None:
        """Play the result of a job from now on."""
        self.job_readings += self._clocks.job.take()
        report = self.stages.report
        report.skipped.update(self._skipped)
        self._skipped.clear()
        if outcome.tells_time and not math.isnan(outcome.seconds):
            self.schedule.note_solve(outcome.seconds, self._allowed == self.sampler.budget)
        self.schedule.rests = outcome.solutions is self.played.solutions and self.sampler.still
        for one in outcome.fresh:
            report.count_solve(one.solution.status)
        self.deadline.adapt(outcome, self.played)
        self._before, self.played, self._taken = self.played, outcome, outcome
        self._valid_at = outcome.time

    @property
    def _fresh(self) -> tuple[CachedSolution, ...]:
        return () if self._taken is None else self._taken.fresh

    @property
    def sample_counts(self) -> SampleCounts:
        """What the objects of the last frame asked for."""
        return self.played.sample_counts

    @property
    def newest_scene(self) -> Scene:
        """The scene that the last tick was given; `played` may be of an earlier one."""
        return self._seen or self.played.scene

    @property
    def labels(self) -> frozenset[str]:
        """Labels of all objects that the last frame concerns, including those that end in it."""
        return self._before.labels | self.played.labels

    @property
    def deviations(self) -> Reasons:
        """What the last frame leaves out or changes, by object and reason."""
        return self._deviations.describe(
            self._before,
            self.played,
            between=self.schedule.in_background,
            held_back=self.playback.modulator.held_back,
            silenced=self._silenced,
        )

    def adapt_budget(self, seconds: float) -> None:
        """Adapt schedule and sample budget to the duration of this tick, `seconds` [s], whose frame has been sent."""
        self._adapt(seconds)
        self._in_background = self.schedule.in_background

    def _adapt(self, seconds: float) -> None:
        taken = self._taken
        if self.budget_controller is None or taken is None:
            return
        if not math.isnan(taken.seconds):
            seconds = SHRINK_LOAD * taken.seconds * self.period / max(GOOD_SOLVE_TIME, self.period)
        elif not taken.solutions.one_tick_only:
            if taken.tells_time:
                self.schedule.note_tick(seconds)
            return
        if not taken.tells_time:
            return
        if any((one.samples.regions >= 0).any() for one in taken.fresh):
            return  # a region of fewer samples would have holes
        samples = max((len(one.samples) for one in taken.fresh), default=0)
        self._allowed = self.budget_controller.adapt(
            seconds, samples, self.schedule.expected_interval
        )
