"""The render loop. It never raises: an error in a tick silences the output and is reported."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import check_kind, check_number
from pacinian.closeable import Closeable
from pacinian.errors import ArgumentError, BackendError
from pacinian.plugins import registry
from pacinian.plugins.backend import Backend
from pacinian.rendering.background_solve import start_daemon
from pacinian.rendering.clock import Clock, SystemClock
from pacinian.rendering.deviation_log import HALTED, NOTHING, mark, mark_lateness
from pacinian.rendering.fail_safe_output import FailSafeOutput
from pacinian.rendering.frame_cycle import MAX_FRAMES
from pacinian.rendering.loop_settings import LoopSettings
from pacinian.rendering.pipeline import Pipeline
from pacinian.rendering.realtime_section import realtime_section
from pacinian.rendering.recorded_settings import to_config
from pacinian.rendering.recording_clock import RecordingClocks
from pacinian.rendering.report import Report
from pacinian.rendering.scene_log import TickInput, TickOutcome
from pacinian.rendering.scene_warnings import add_warnings
from pacinian.rendering.skin_loader import SkinLoader
from pacinian.rendering.stage_timer import StageTimer
from pacinian.rendering.tick_pacing import MAX_LAG, pace
from pacinian.scene.sampling.ramps import RAMP_TIME
from pacinian.scene.sampling.sample_counts import label_object
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.session import Session
from pacinian.skip_reasons import MISSED_TICKS, TICKS_HALTED
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.limits import Limits

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.plugins.backend import Frame
    from pacinian.plugins.solver import Solver
    from pacinian.rendering.background_schedule import BackgroundSchedule
    from pacinian.rendering.modulator import Modulator
    from pacinian.rendering.recording import Recorder
    from pacinian.rendering.report import Fault, Stage
    from pacinian.rendering.sample_solver import SampleSolver
    from pacinian.rendering.smoothing import Smoothing
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.scene.sampling.sample_counts import ObjectSampleCounts
    from pacinian.scene.sampling.samples import Samples
    from pacinian.solving.solution import Solution
    from pacinian.solving.targets import Targets
    from pacinian.types import Floats, Gains

MAX_DURATION = 1e9  # longest duration of a run [s]


class Renderer(Closeable):
    """Renders a scene on an array at a fixed rate: sample, propagate, solve, modulate, quantise, send.

    scene: a `Scene`, or a function that returns one for a time [s]. Time 0 is the first tick of `run`, or `open` if you
    call `tick` in a loop of your own. The function is called every tick and once before the first, and may set the
    limits and the solver. The scene can be replaced at any time, from any thread. backend, solver: names or objects.
    rate: ticks per second [Hz]. limits: every solution keeps them. sampler: has the budget, the spacing and the ramps.
    smoothing: slew-rate limit from row to row. clock: tests can replace it. recorder: records every tick; the renderer
    closes it.

    When the first hand of a kind appears, its skin is built. This may take some seconds, in which the output is silent.
    All hands of joints are one kind, and all hands that are meshes with the same faces. `open` builds the skins of the
    hands in the first scene in advance, and also that of hands of joints if `scene` is a function.

    Envelopes are evaluated at the device's rate. If a limit couples all gains (power, quiet points, exact samples) and
    objects have different envelopes, each envelope is replaced by its mean over the tick. With quiet zones, a row
    whose gains would exceed their limit is scaled down as a whole.

    Every tick sends a frame. adaptive: if ticks would be late, sampling and solving run in the background, in a thread
    of their own. Frames then stay on time, and move evenly from one solution to the next. In a scene without regions,
    if a solve takes more than 4 ms (or one tick, if that is longer), the samples of the lowest priority are dropped
    until there is time again. If not adaptive, solves take the time that they need, contacts with skin have more
    samples, and ticks may be late.

    strict: never degrade what the scene asks for. Nothing is coarsened, left out, merged or interpolated to save time,
    and solves take the time that they need. Ticks may therefore be late; the report names these by object and time. A
    scene with more samples than the budget is refused: `open` raises ArgumentError, and in a later tick it is a fault.
    Ramps and `smoothing` shape the output as before, because they do not depend on load. Overrides `adaptive`.

    max_cycle_frames: largest number of frames that render a region in turn, so that people feel their mean. The
    device must play each of them 500 times a second. A region with more samples than the budget is split into
    bands, one for each frame. If transducers are at their limit, two frames render the same samples in free air
    with waves from two sides. While most solves for moving samples are late, only one frame is used. 1 disables
    cycles. peak: highest radiation pressure on the skin of the hands [Pa]. A solution that would exceed it is scaled
    down. Without a hand in the scene, no skin is evaluated. If `adaptive`, and a new hand might get more, the output is
    silent until a solution takes this hand into account. In a cycle, single frames press more strongly than their mean.
    Therefore, `peak` also limits the target of each frame, but never to less than the target of the whole cycle. The
    pressure of an object that has a `force` is limited to `peak`, too.

    start_thread: runs a function in a new thread of the given name, for solves in the background.

    Use the renderer as a context manager, or call `run`, which opens and closes it. A fault, for example an exception
    in a plug-in or a lost device, silences the output until `reset`; the loop continues and counts ticks.
    Raises ArgumentError, UnknownPlugin, PluginError; `open` also raises any exception of the backend.
    """

    def __init__(
        self,
        array: Array,
        scene: Scene | Callable[[float], Scene],
        *,
        medium: Air | None = None,
        solver: str | Solver = "auto",
        backend: str | Backend = "simulated",
        rate: float = 1000.0,
        limits: Limits | None = None,
        sampler: Sampler | None = None,
        smoothing: Smoothing | None = None,
        adaptive: bool = True,
        strict: bool = False,
        max_cycle_frames: int = MAX_FRAMES,
        peak: float = math.inf,
        clock: Clock | None = None,
        recorder: Recorder | None = None,
        start_thread: Callable[[Callable[[], object], str], None] = start_daemon,
    ) -> None:
        _check_scene(scene)
        if isinstance(scene, Scene):
            scene.check_files()
        self.scene = scene
        self.clock = clock or SystemClock()
        self.recording_clocks = clocks = RecordingClocks.make(self.clock.now)
        self.session = Session(array, medium, solver, clock=clocks.job.now)
        self.session.record_decision = clocks.job.record_decision
        made = registry.backend(backend) if isinstance(backend, str) else backend
        check_kind("backend", made, Backend)
        capability = registry.read_capability(made)
        self.limits = Limits() if limits is None else limits
        check_kind("limits", self.limits, Limits)
        self.sampler = Sampler(ramp=RAMP_TIME) if sampler is None else sampler
        check_kind("sampler", self.sampler, Sampler)
        self.settings = settings = LoopSettings.make_checked(
            rate, smoothing, adaptive=adaptive, strict=strict, max_cycle_frames=max_cycle_frames, peak=peak
        )  # fmt: skip
        self.period, self.strict, self.peak = settings.period, settings.strict, settings.peak
        self.smoothing, self.max_cycle_frames = settings.smoothing, settings.max_cycle_frames
        self.report = Report()
        self.recorder = recorder
        self._stages = StageTimer(self.clock.now, self.report)
        self._pipeline = Pipeline(
            self.session, self.sampler, settings, capability, self._stages, clocks, start_thread
        )
        self._emitter = FailSafeOutput(made, self._stages)
        self._skins = SkinLoader(limited=self.peak < math.inf)
        # Clock reading at the scene's time 0 [s]: that of `open`, then of the first tick, if `run` makes it.
        self.start = 0.0
        self._opened = False
        self._missed = 0  # ticks skipped just before the present one
        self._outcome: TickOutcome | None = None  # of this tick; None before its frame is sent

    def __repr__(self) -> str:
        scene, report, fault = self.scene, self.report, self.halted
        count = f"{len(scene.objects)} objects" if isinstance(scene, Scene) else "a moving scene"
        halted = "" if fault is None else f", halted: {fault}"
        return (
            f"<Renderer of {count} by {self.session.solver.name} on {type(self.backend).__name__}, "
            f"{len(self.session.array)} transducers, {1.0 / self.period:g} Hz: "
            f"{report.ticks:,} ticks, {report.late_ticks:,} late{halted}>"
        )

    @property
    def backend(self) -> Backend:
        """The backend; call `use` to replace it."""
        return self._emitter.backend

    @property
    def halted(self) -> Fault | None:
        """The fault that keeps the output silent, if any."""
        return self._emitter.halted

    @property
    def stage(self) -> Stage:
        """The present stage of the tick; between ticks "scene"."""
        return self._stages.stage

    @property
    def silent(self) -> bool:
        """Whether the output is silent, and stays so with the same scene, limits and solver."""
        return self._pipeline.playback.silent if self.halted is None else not self._emitter.loud

    @property
    def repeats(self) -> bool:
        """Whether the last tick repeated the frame before it.

        The next ticks also repeat it, unless the scene changes or something that moves comes into reach.
        """
        return self._outcome is not None and self._pipeline.repeats

    @property
    def modulator(self) -> Modulator:
        """The modulator, which turns solutions into rows of gains."""
        return self._pipeline.playback.modulator

    @property
    def schedule(self) -> BackgroundSchedule:
        """Decides whether solves run in the background."""
        return self._pipeline.schedule

    @property
    def played(self) -> SolutionSequence:
        """What the last frame plays, with its samples and targets."""
        return self._pipeline.played.solutions

    @property
    def sample_solver(self) -> SampleSolver:
        """Solves for the samples. While solves run in the background, a thread uses it."""
        return self._pipeline.solver

    @property
    def solution(self) -> Solution | None:
        """The last solution; None before the first."""
        return self.played.rows[-1].solution if self.played.rows else None

    @property
    def samples(self) -> Samples | None:
        """Samples of the last solution, or of all frames of a cycle together; None before the first solution."""
        return self.played.played_samples

    @property
    def targets(self) -> Targets | None:
        """Targets of the last solution, or of all frames of a cycle together; None before the first solution."""
        return self.played.targets

    def open(self) -> None:
        """Open the device, silently, and warm up, so that the first tick is not slow."""
        if self._opened:
            return
        try:
            self.backend.open(self.session.array)
            self._opened = True
            with limit_blas_threads():  # as in the ticks, which reuse what is computed here
                first = self._pipeline.warm_up(self._scene, self.limits)
                self._skins.load_first(first, any_time=callable(self.scene))
            if self.recorder is not None:
                self.recorder.begin(self.session.array, self.backend.capability, to_config(self))
                if first is not None:
                    self.recorder.prepare(first)
            self.report = self._stages.report = Report()
            if first is not None:
                self._pipeline.warn(first, self.limits)
            self.reset()
            self.start = self.clock.now()
        except BaseException as error:
            # a backend that refuses to open has nothing to close, but one that was interrupted may be open
            self._opened = self._opened or not isinstance(error, Exception)
            self.close()
            raise

    def use(self, backend: Backend) -> Backend:
        """Send to another backend from the next tick on; return the previous one, which the caller must close.

        Call this between ticks, from the thread that ticks. backend: must be open and silent, if the renderer is open.
        Its levels and rate may differ. The previous backend still sounds, so let one tick pass before you close it.
        If this raises ArgumentError, nothing has changed.
        """
        check_kind("backend", backend, Backend)
        before = self.backend
        if self.recorder is not None and backend.capability != before.capability:
            raise ArgumentError("backend", "must have the same capability while this is recorded")
        self._pipeline.use(backend.capability)
        self._emitter.backend = backend
        return before

    def close(self) -> None:
        """Silence and close the device; may be called twice."""
        if not self._opened:
            return
        self._opened = False
        try:
            self._emitter.close()
        finally:
            self._pipeline.close()
            if self.recorder is not None:
                self._emitter.attempt("record", self.recorder.close)

    def __enter__(self) -> Renderer:
        self.open()
        return self

    def run(
        self,
        duration: float | None = None,
        on_tick: Callable[[Report], object] | None = None,
        max_lag: float = MAX_LAG,
    ) -> Report:
        """Run ticks for `duration` [s], or until Ctrl-C; always silence the output at the end.

        on_tick: called after each tick. max_lag: lag up to which the loop catches up by ticking faster [s]. With more
        lag, missed ticks are skipped and counted in `report.skipped["missed ticks"]`. Pass 0 if only the present
        matters. Scene time 0 is the first tick since `open`. Ctrl-C ends the run and sets `report.interrupted`.
        """
        max_lag = check_number("max_lag", max_lag, low=0.0)
        if duration is not None:
            duration = check_number("duration", duration, low=0.0, high=MAX_DURATION)
        was_open, interrupted = self._opened, False
        try:
            self.open()
            self.report.interrupted = False
            with realtime_section():
                begins = not self.report.ticks
                for due, lost in pace(self.clock, self.period, duration, max_lag):
                    if begins:  # time 0 must not be before the loop is ready
                        self.start, begins = due, False
                    self.tick(due, lost)
                    if on_tick is not None:
                        on_tick(self.report)
        except KeyboardInterrupt:
            interrupted = True
        finally:
            try:
                self._emitter.silence()
                with suppress(Exception):  # of a measurement
                    self._pipeline.finish_measuring()
            finally:
                if not was_open:
                    self.close()
                self.report.interrupted = self.report.interrupted or interrupted
        return self.report

    def tick(self, due: float | None = None, missed: int = 0) -> None:
        """Run one tick, due at clock time `due` [s]; now by default. missed: number of ticks skipped just before it.

        Raises BackendError if the renderer is not open, and no other Exception.
        """
        if not self._opened:
            raise BackendError("the renderer is not open: use `with renderer:`, or `run`")
        begin = self.clock.now()
        due = begin if due is None else due
        self._outcome, self._missed = None, missed
        if missed:
            self.report.skipped[MISSED_TICKS] += missed
        if self.halted is None:
            with limit_blas_threads():  # always, because another number of threads rounds otherwise
                self._emitter.attempt("scene", lambda: self._step(due))
        else:
            self.report.skipped[TICKS_HALTED] += 1
            if self._emitter.loud:  # silencing failed before, so retry
                self._emitter.silence()
        end = self.clock.now()
        if (outcome := self._outcome) is not None:
            late, deviations = outcome.late, outcome.deviations
        else:
            late = end > due + self.period
            labels = sorted(self._labels)
            halted = mark(NOTHING, labels, HALTED)
            deviations = mark_lateness(halted, labels, late=late, missed=missed)
        self.report.count_tick(end - begin, late, due - self.start, deviations)

    @property
    def sample_counts(self) -> dict[str, ObjectSampleCounts]:
        """What each object of the last frame asked for, and what was left out or changed, by the object's label."""
        return self._pipeline.sample_counts.objects

    @property
    def last_frame(self) -> Frame:
        """The last frame; its arrays are reused. Raises BackendError before the first."""
        if (frame := self._pipeline.playback.last_frame) is None:
            raise BackendError("nothing has been sent yet")
        return frame

    @property
    def rendered_scene(self) -> Scene:
        """Scene of the last frame; older than the newest while solves run in the background. Empty before the first."""
        return self._pipeline.played.scene

    @property
    def newest_scene(self) -> Scene:
        """Scene of the last tick, whether or not it has been rendered yet. Empty before the first."""
        return self._pipeline.newest_scene

    @property
    def lag(self) -> float:
        """Age of the last frame's scene [s]: the last tick's time minus the scene time that the frame was solved for.

        Negative if the frame was solved for a later time.
        """
        return self._pipeline.lag

    @property
    def emitted_gains(self) -> Gains:
        """The last gains at full envelope as rounded by the device, (N,), even if it is silent now."""
        solution = self.solution
        gains = (
            np.zeros(len(self.session.array), np.complex64) if solution is None else solution.gains
        )
        return self._pipeline.playback.quantise_gains(gains, self._pipeline.limits)

    @property
    def cycle_gains(self) -> Gains:
        """Like `emitted_gains`, for each frame of the cycle, (K, N); people feel the mean of these frames."""
        pipeline = self._pipeline
        return pipeline.playback.quantise_frames(pipeline.played.solutions, pipeline.limits)

    @property
    def sample_pressures(self) -> Floats:
        """Sound pressure amplitudes at the played samples, as `compute_pressures` returns them, (M,) [Pa].

        Costs less than that while solves run in the background. If the field is steered, these are the pressures at the
        samples where they were solved for.
        """
        outcome, samples = self._pipeline.played, self.samples
        if outcome.sample_pressures is not None or samples is None:
            return np.empty(0) if outcome.sample_pressures is None else outcome.sample_pressures
        return self.compute_pressures(samples.positions, outcome.solutions.facing)

    def compute_pressures(self, points: Floats, facing: SkinFacing | None = None) -> Floats:
        """Return the root mean square of the pressure amplitude at points over the frames of `cycle_gains`: (M,) [Pa].

        points: (M, 3) [m].
        """
        return self._pipeline.probe.compute_pressures(points, facing, self.cycle_gains)

    def reset(self) -> None:
        """Clear a fault and all state, so that the next tick starts from silence."""
        self._emitter.halted = None
        self.recording_clocks.tick.take()
        self.restart()

    def restart(self) -> None:
        """Discard what is played, so that the next frame starts from silence. A fault stays."""
        self._pipeline.reset()
        if self.recorder is not None:
            self.recorder.mark_reset()

    def _fall_silent(self) -> None:
        """Silence the output, and discard what is played."""
        self._emitter.silence()
        self.restart()

    def _step(self, due: float) -> None:
        pipeline, stages = self._pipeline, self._stages
        # The end of a run silences the output.
        if pipeline.playback.last_frame is not None and not self._emitter.loud:
            self.reset()
        begin = self.recording_clocks.tick.now()
        stages.begin("scene", self.report, begin)
        t = check_number("clock", due - self.start)
        scene = self._scene(t)
        self._skins.load_new(
            scene.hands, self.recording_clocks.tick.record_decision, self._fall_silent
        )
        limits, solver = self.limits, self.session.solver  # other threads may set them at any time
        frame = pipeline.make_frame(scene, limits, t, due, self.report.frames_sent)
        stages.enter("send")
        self._emitter.send(frame)
        self._outcome = self._judge(due)
        if pipeline.budget_controller is not None:
            pipeline.adapt_budget(self.recording_clocks.tick.now() - begin)
        stages.enter("record")
        noted = self.recording_clocks.tick.take()
        if self.recorder is not None:
            asked = TickInput(scene, solver, limits)
            readings = noted, pipeline.job_readings
            known = self.recorder.unrecorded
            self.recorder.write(
                frame, t, asked, readings, self._outcome, same=pipeline.playback.is_repeat(frame)
            )
            if self.recorder.unrecorded != known:
                text = f"scenes are no longer recorded: {self.recorder.unrecorded}"
                add_warnings(self.report, [text])
        stages.enter("scene")

    def _judge(self, due: float) -> TickOutcome:
        """Return the outcome of the tick whose frame has just been sent: lateness, sample counts and deviations."""
        pipeline, sent = self._pipeline, self.clock.now()
        late, deviations = sent > due + self.period, pipeline.deviations
        if late or self._missed:
            labels = sorted(pipeline.labels)
            deviations = mark_lateness(deviations, labels, late=late, missed=self._missed)
        return TickOutcome(sent, late, pipeline.sample_counts, deviations)

    @property
    def _labels(self) -> Collection[str]:
        """Labels of the objects that a tick without a frame concerns."""
        objects = self.scene.objects if isinstance(self.scene, Scene) else ()
        return self._pipeline.labels or {label_object(item, i) for i, item in enumerate(objects)}

    def _scene(self, t: float) -> Scene:
        """Return the scene at time t [s]."""
        if isinstance(self.scene, Scene):
            return self.scene
        _check_scene(self.scene)  # which may have been set to anything
        scene = self.scene(t)
        check_kind("scene", scene, Scene)
        return scene


def _check_scene(scene: object) -> None:
    """Raise ArgumentError unless `scene` is a `Scene` or a function."""
    if not (isinstance(scene, Scene) or callable(scene)):
        raise ArgumentError("scene", f"must be a Scene, or a function to one, not {scene!r}")
