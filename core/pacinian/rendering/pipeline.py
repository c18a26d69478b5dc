"""Make a frame from a scene: sample, solve, modulate and quantise, as far as time allows.

Sampling and solving are one job. It runs in the tick, or in a thread beside the ticks if these would be late. Only its
result (`SolveResult`) passes to the rest of the tick.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.background_schedule import GOOD_SOLVE_TIME, BackgroundSchedule
from pacinian.rendering.background_solve import BackgroundSolve, start_daemon
from pacinian.rendering.emitted_measurement import Probe
from pacinian.rendering.felt_monitor import FeltMonitor
from pacinian.rendering.frame_cycle import Cycle, split_frames
from pacinian.rendering.frame_deviations import FrameDeviations
from pacinian.rendering.measurement_schedule import Measurement
from pacinian.rendering.playback import Playback
from pacinian.rendering.report import StageTimer
from pacinian.rendering.row_times import compute_row_times
from pacinian.rendering.sample_budget_controller import MAX_LOAD, SampleBudgetController
from pacinian.rendering.sample_solver import SampleSolver, limits_join
from pacinian.rendering.scene_warnings import is_too_fast
from pacinian.rendering.solution_sequence import SolutionSequence, SolveResult
from pacinian.rendering.steered_solver import STEERED_TIME_FACTOR
from pacinian.rendering.warmup import load_envelopes, try_out
from pacinian.scene.sampling.sample_counts import FAR, ON_TRANSDUCER, SampleCounts, label_object
from pacinian.scene.sampling.samples import no_samples
from pacinian.scene.scene import Scene
from pacinian.skip_reasons import MEASUREMENTS_FAILED, NOT_DUE, NOTHING_CHANGED, UNDER_WAY
from pacinian.solving.problem import Limits

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Capability, Frame
    from pacinian.plugins.solver import Solver
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.recording_clock import RecordingClock
    from pacinian.rendering.smoothing import Smoothing
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.session import Session
    from pacinian.types import Floats

# Deadline of a solve, relative to the time that it may take: one tick, or `max_ticks` ticks in the background.
DEADLINE_SHARE = 0.7
# The loop waits for a background solve that has run for this long [s], or for `max_ticks` ticks if that is longer.
WAIT_FOR_SOLVE_AFTER = 0.02
# Largest movement of samples since the last background solve for which no other solve is made: a twentieth of a
# wavelength [m].
MAX_UNSOLVED_MOVEMENT = 4e-4
# Quiet zones, power limits and exact samples take longer to solve for. If the solver ran out of time and the samples
# are at rest, the next solve beside the ticks gets so many times as long, up to a limit [relative to the deadline].
DEADLINE_FACTOR_GROWTH, MAX_DEADLINE_FACTOR = 4.0, 32.0
MAX_LEAD = 0.02  # longest time ahead for which a solve is made [s]


class Pipeline:
    """Makes the frames of one render loop.

    session: solves. sampler: samples the scene. smoothing: slew-rate limit from row to row. capability: of the device.
    period: of a tick [s]. adaptive: whether to solve beside the ticks if these would be late, to end solves in time,
    and to reduce the number of samples, except those of regions. most: largest number of frames in a cycle. peak:
    largest target of such a frame [Pa]. stages: stage timer, which also holds the report. recording_clock: of the
    ticks. job_recording_clock: of sampling and solving; `session` uses it, too. strict: never leave anything out, and
    do not adapt. start_thread: starts the thread that solves beside the ticks. Raises ArgumentError.
    """

    def __init__(
        self,
        session: Session,
        sampler: Sampler,
        smoothing: Smoothing,
        capability: Capability,
        period: float,
        adaptive: bool,
        most: int,
        peak: float,
        stages: StageTimer,
        recording_clock: RecordingClock,
        job_recording_clock: RecordingClock,
        strict: bool = False,
        start_thread: Callable[[Callable[[], object], str], None] = start_daemon,
    ) -> None:
        self.session, self.sampler, self.period = session, sampler, period
        self.stages, self._most = stages, most
        self._recording_clock, self._job_recording_clock = recording_clock, job_recording_clock
        sampler.prepare(session.array, session.medium)
        self.strict = sampler.strict = strict
        sampler.peak = peak
        self.playback = Playback(session.array, session.medium, smoothing, capability, period)
        cycle = Cycle(session, split_frames(most, capability.rate), sampler.budget, peak)
        cycle.coarsens = not strict
        self.solver = SampleSolver(session, self.playback.times, cycle)
        self._skipped = sampler.skipped = self.solver.skipped  # of a job, until it is taken
        self._adaptive = adaptive and not strict
        sampler.fine = not self._adaptive
        self.budget_controller = (
            SampleBudgetController(period, sampler.budget) if self._adaptive else None
        )
        self._allowed = sampler.budget  # number of samples that the next job may use
        self.background = BackgroundSolve[SolveResult | Measurement | None](start_thread)
        self._job_stages = StageTimer(stages.now, stages.report)
        self.limits = Limits()  # of this tick
        self.probe, self._monitor = Probe(session), FeltMonitor(session, sampler, self.playback)
        self.schedule, self._beside = BackgroundSchedule(period), False
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
        self._taken: SolveResult | None = None  # of this tick
        self.lag = 0.0
        """Age of the last frame's scene [s]: the last tick's time minus the scene time that the frame was solved for.

        Negative if the frame was solved for a later time.
        """
        self._play_time = -math.inf  # scene time for which the last job solved [s]
        self._started = 0.0  # clock reading when the job that runs beside the ticks began [s]
        self._deadline_factor = 1.0  # factor on the deadline of the next job beside the ticks
        self._measures = False  # whether the job beside the ticks only measures
        self._unhurried = False  # whether it solves for a scene at rest, without a deadline
        self._solved_now = False  # whether the last tick solved
        self._seen: Scene | None = None
        self._changed = True  # whether the scene has changed since the last job began
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
        self.schedule, self._beside = BackgroundSchedule(self.period), False  # as a replay begins
        try:
            self.playback.quantise_gains(try_out(self.session).gains, limits)
            first, self.limits = scene(0.0), limits
            self._set_sampler(limits, self.session.solver)
            self.sampler.sample(first)
            load_envelopes(first, self.playback.times)
        except Exception:
            if self.strict:
                raise
            return None
        return first

    def use(self, capability: Capability) -> None:
        """Make frames for a device with this capability from now on. Raises ArgumentError."""
        if capability == self.playback.capability:
            return
        times, gap = compute_row_times(capability, self.period)
        self._discard_job()
        self.playback.use(capability, times, gap)
        fast = self._find_too_fast(self.played.solutions)
        self.played = self.played._replace(sample_pressures=None, too_fast=fast)
        self.solver.times = times
        self.solver.cycle.most = split_frames(self._most, capability.rate)

    def reset(self) -> None:
        """Discard all state and start from silence. Solves run where they ran at the last frame that was sent."""
        self.background.drop()
        self._skipped.clear()
        self.sampler.reset()
        self.solver.reset()
        self.playback.reset()
        self.session.forget()
        self._monitor.reset()
        self._job_recording_clock.take()
        # what a tick without a frame has counted is in no recording
        self.schedule = BackgroundSchedule(self.period, beside=self._beside)
        self._begin()
        if self.budget_controller is not None:
            self.budget_controller = SampleBudgetController(self.period, self.sampler.budget)
            self.sampler.allowed = self._allowed = self.sampler.budget

    def finish_measuring(self) -> None:
        """Wait for the measurement that runs beside the ticks, if one does."""
        if self._measures and self.background.running:
            self._take_job()

    def close(self) -> None:
        """Let the thread that solves beside the ticks end."""
        self.background.close()

    @property
    def still(self) -> bool:
        """Whether the last tick repeated the frame before, and nothing that was seen is pending."""
        return self._repeated and not (self._changed or self.background.running)

    def frame(self, scene: Scene, limits: Limits, t: float, due: float, sequence: int) -> Frame:
        """Return the frame for a scene at time t [s], due at `due` [s]; reuses the last one if nothing changed."""
        self.limits, self._taken, self.job_readings = limits, None, []
        self._changed, self._seen = self._changed or scene is not self._seen, scene
        solver = self.session.solver  # other threads may set another one at any time
        ticks, beside = self._count_ticks(t), self._may_wait(limits, solver)
        if ticks > 1 and not beside:
            self.sampler.rest_until(t - self.period)
        if beside:
            self._solve_beside(scene, limits, solver, t, ticks)
        else:
            self._solve_now(scene, limits, solver, t)
        self.lag = t - self.played.time
        play, inputs = self.played.solutions, (self.played.solutions.samples, limits, solver)
        spread = self.schedule.find_spread(ends=not len(play.samples)) if beside else 1
        same = self.playback.follow(play, inputs, t, spread)
        self._repeated = same and not self._fresh
        if self._repeated:
            self.stages.report.skipped[NOTHING_CHANGED] += 1
            frame = self.playback.repeat(sequence, due)
        else:
            self.stages.enter("drive")
            frame = self.playback.make_frame(play, limits, inputs, t, spread, sequence, due)
        self._monitor.watch(scene, self.played, limits, t, ticks)
        return frame

    def _count_ticks(self, t: float) -> int:
        """Return the number of ticks from the last one to that at time t [s]: 1, unless the loop has rested."""
        last, self._time = self._time, t
        return max(1, round((t - last) / self.period)) if self._repeated and t > last else 1

    def _may_wait(self, limits: Limits, solver: Solver) -> bool:
        """Return whether the solve for this tick may run beside it, because an older result is still right to play."""
        last = self.played
        same = last.solutions.limits == limits and last.solver is solver
        return self.schedule.beside and same and not last.solutions.brief

    def _solve_now(self, scene: Scene, limits: Limits, solver: Solver, t: float) -> None:
        """Sample and solve in this tick. Measure beside it, if that may be late."""
        if not self._measures:
            self._discard_job()
        elif self.background.done or self._recording_clock.replays:
            self._take_job()  # at a time that is not recorded; `_solve_beside` forgets it
        self._solved_now = True
        self.stages.enter("sample")
        self._play(self._make_job(scene, limits, solver, t, self.stages, beside=False)())
        # the last measurement may still be under way, with the propagator that the next one needs
        if self.background.running or (measure := self._monitor.take_job()) is None:
            return
        if self._adaptive and not self._recording_clock.replays:
            self._start_job(measure, measures=True)
        else:
            self._count_measurement(measure())

    def _solve_beside(
        self, scene: Scene, limits: Limits, solver: Solver, t: float, ticks: int
    ) -> None:
        """Take the result of the job beside the ticks if it is done, and start the next if it is time to.

        ticks: number of ticks since the last one.
        """
        if self._solved_now:
            self.finish_measuring()
            self._monitor.forget()  # because measurements beside the ticks delay solves
            self._solved_now = False
        self.schedule.pass_ticks(ticks)
        if self.background.running:
            if not self._is_done():
                self.stages.report.skipped[UNDER_WAY] += 1
                return
            result = self._take_job()
            if result is not None and result.solutions.brief:
                self._solve_now(scene, limits, solver, t)
                return
        # measure in the pause between two solves, so that no solution waits for the measurement
        if (measure := self._monitor.take_job()) is not None:
            self._start_job(measure, measures=True)
        elif self.schedule.begin_solve(self._changed, not scene.objects):
            job = self._make_job(scene, limits, solver, t, self._job_stages, beside=True)
            self._start_job(job, measures=False)
        else:
            self.stages.report.skipped[NOT_DUE] += 1

    def _start_job(
        self, job: Callable[[], SolveResult | Measurement | None], *, measures: bool
    ) -> None:
        """Start a job beside the ticks. measures: whether it only measures, so that it may run beside a solve."""
        # a thread must not enter the tick's stages
        self._job_stages.begin("sample", self.stages.report, self.stages.now())
        self._started, self._measures = self.stages.now(), measures
        self.background.deferred = self._recording_clock.replays
        self.background.start(job)

    def _take_job(self) -> SolveResult | None:
        """Wait for the job beside the ticks, and use its result; return that of a solve."""
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
        if self._seen and self._seen.objects:  # what ends must end soon
            limit *= math.inf if self._unhurried else self._deadline_factor
        overdue = self.stages.now() - self._started >= limit
        return bool(self._recording_clock.note(lambda: float(overdue or self.background.done)))

    def _discard_job(self) -> None:
        """Wait for the job beside the ticks, if one runs, and drop its result."""
        if self.background.running:
            with suppress(Exception):  # the next job will raise it again
                self.background.take()
            self._changed = self._changed or not self._measures
            self._measures = False
            self.job_readings += self._job_recording_clock.take()

    def _make_job(
        self, scene: Scene, limits: Limits, solver: Solver, t: float, stages: StageTimer, *, beside: bool
    ) -> Callable[[], SolveResult]:  # fmt: skip
        """Return a function that samples and solves. beside: whether it runs beside the ticks."""
        rests = self.schedule.rests and not self._changed
        if self._changed:  # even if it has changed back since
            self.sampler.invalidate()
        self._changed = False
        if self.budget_controller is not None:
            self.sampler.allowed = self._allowed
        self._set_sampler(limits, solver)
        time = (self.schedule.max_ticks if beside else 1) * self.period
        if beside:
            time *= self._deadline_factor
        deadline = DEADLINE_SHARE * time if self._adaptive else math.inf
        rows = self.played.solutions.rows
        self._unhurried = beside and rests and bool(rows) and rows[0].awaits_rest
        if self._unhurried:
            deadline = math.inf
        at = self._find_play_time(t, beside)
        last, known = self.played, self.sampler.sample_counts

        def run() -> SolveResult:
            begin = self._job_recording_clock.now() if beside else math.nan
            samples = self.sampler.sample(scene, at, at - t)
            counts = self.sampler.sample_counts
            if counts is not known and len(counts.samples):
                self._note_unreachable(counts)
            stages.enter("solve")
            self.solver.skins = self.sampler.pose_seen() if len(samples) else ()
            self.solver.cycle.budget = self.sampler.frame_budget
            self.solver.refines_at_rest = beside and self._adaptive
            near = MAX_UNSOLVED_MOVEMENT if beside and self._adaptive else 0.0
            solutions = self.solver.solve(samples, t, limits, solver, deadline, near, at)
            fast = last.too_fast
            if solutions is not last.solutions:
                fast = self._find_too_fast(solutions)
            fresh, pressures = tuple(self.solver.fresh), None
            if beside:  # a steered field makes at its samples what it made where it was solved for
                same = (
                    solutions.rows == last.solutions.rows
                    and solutions.limits == last.solutions.limits
                )
                pressures = (
                    last.sample_pressures
                    if same
                    else self._compute_sample_pressures(solutions, limits)
                )
            seconds = self._job_recording_clock.now() - begin if beside else math.nan
            if beside:
                stages.enter("drive")  # ends "solve"
            return SolveResult(
                scene, counts, solutions, solver, fresh, pressures, at, seconds, fast
            )

        return run

    def _compute_sample_pressures(
        self, solutions: SolutionSequence, limits: Limits
    ) -> Floats | None:
        """Return the pressures at the samples of what has just been solved, if a propagator is still that of these."""
        solutions = replace(solutions, motion=None)
        samples = solutions.played_samples
        for part in self.solver.cycle.parts:
            propagator = part.session.propagator
            whole = samples is not None and np.array_equal(propagator.points, samples.positions)
            if whole and propagator.nulls is None:
                p = [propagator.apply(g) for g in self.playback.quantise_frames(solutions, limits)]
                return np.asarray(np.sqrt((np.abs(p) ** 2).mean(axis=0)))
        return None

    def _find_play_time(self, t: float, beside: bool) -> float:
        """Return the scene time for which a job that begins at time t solves [s].

        In the background, this is the time at which the interpolated frames will reach the result: the loop will take
        the result after as many ticks as it took the last results, and frames reach it when the loop takes the
        following one. Never returns an earlier time than the last call, unless time jumps back.
        """
        ticks = self.schedule.ticks + self.schedule.interval
        lead = min(ticks * self.period, MAX_LEAD) if beside else 0.0
        last = self._play_time if self._play_time <= t + MAX_LEAD else -math.inf
        self._play_time = max(t + lead, last)
        return self._play_time

    def _play(self, outcome: SolveResult) -> None:
        """Play the result of a job from now on."""
        self.job_readings += self._job_recording_clock.take()
        report = self.stages.report
        report.skipped.update(self._skipped)
        self._skipped.clear()
        if outcome.tells_time and not math.isnan(outcome.seconds):
            self.schedule.note_solve(outcome.seconds, self._allowed == self.sampler.budget)
        self.schedule.rests = outcome.solutions is self.played.solutions and self.sampler.still
        for one in outcome.fresh:
            report.count_solve(one.solution.status)
        self._set_deadline_factor(outcome)
        self._before, self.played, self._taken = self.played, outcome, outcome

    def _set_deadline_factor(self, outcome: SolveResult) -> None:
        """Set the factor on the deadline of the next job beside the ticks, after this result."""
        limits = outcome.solutions.limits
        rests = outcome.solutions.samples is self.played.solutions.samples
        waits = rests and (limits_join(limits) or limits.zones)
        if waits and any(one.ran_out_of_time for one in outcome.fresh):
            self._deadline_factor = min(
                DEADLINE_FACTOR_GROWTH * self._deadline_factor, MAX_DEADLINE_FACTOR
            )
        elif outcome.fresh or not waits:
            self._deadline_factor = 1.0

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
    def labels(self) -> set[str]:
        """Labels of all objects that the last frame concerns, including those that end in it."""
        return self._before.labels | self.played.labels

    @property
    def deviations(self) -> Reasons:
        """What the last frame leaves out or changes, by object and reason."""
        return self._deviations.describe(
            self._before,
            self.played,
            between=self.schedule.beside,
            held_back=self.playback.modulator.held_back,
        )

    def adapt_budget(self, seconds: float) -> None:
        """Adapt schedule and sample budget to the duration of this tick, `seconds` [s], whose frame has been sent."""
        self._adapt(seconds)
        self._beside = self.schedule.beside

    def _adapt(self, seconds: float) -> None:
        taken = self._taken
        if self.budget_controller is None or taken is None:
            return
        if not math.isnan(taken.seconds):
            seconds = MAX_LOAD * taken.seconds * self.period / max(GOOD_SOLVE_TIME, self.period)
        elif not taken.solutions.brief:
            if taken.tells_time:
                self.schedule.note_tick(seconds)
            return
        if not taken.tells_time:
            return
        if any((one.samples.regions >= 0).any() for one in taken.fresh):
            return  # a region of fewer samples would have holes
        samples = max((len(one.samples) for one in taken.fresh), default=0)
        self._allowed = self.budget_controller.tick(seconds, samples, self.schedule.interval)

    def _set_sampler(self, limits: Limits, solver: Solver) -> None:
        """Set what the sampler must know of a tick's limits and solver."""
        alone = limits_join(limits)
        self.sampler.bands = 1 if alone else self.solver.cycle.max_bands
        self.sampler.steers = not alone and not limits.zones
        self.sampler.surround = solver.surrounds and not alone
        self.sampler.max_uniform_points = 0.0 if alone else solver.max_uniform_points

    def _note_unreachable(self, counts: SampleCounts) -> None:
        """Note the samples that no sound can reach."""
        unreachable = self.solver.reach.find_unreachable(counts.samples.positions)
        if unreachable is None:
            return
        far, on = unreachable
        for reason, found in (FAR, far), (ON_TRANSDUCER, on):
            if found.any():
                counts.drop(reason, found)

    def _find_too_fast(self, play: SolutionSequence) -> tuple[str, ...]:
        """Return the labels of the objects whose vibration the device cannot play.

        Each of several frames in turn has only its share of the device's rate.
        """
        items = play.samples.items
        rate = self.playback.capability.rate / (len(play.rows) if play.cycle else 1)
        used = np.unique(play.samples.objects).tolist()
        return tuple(label_object(items[i], i) for i in used if is_too_fast(items[i], rate))
