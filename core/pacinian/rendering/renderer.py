"""The loop. It never raises: what goes wrong in a tick silences the output and is reported."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.acoustics.facing import Facing
from pacinian.checks import kind, number
from pacinian.errors import ArgumentError, BackendError
from pacinian.plugins import registry
from pacinian.plugins.backend import Backend
from pacinian.rendering.clock import Clock, SystemClock
from pacinian.rendering.drive import Quantiser
from pacinian.rendering.governor import Governor
from pacinian.rendering.player import Player
from pacinian.rendering.report import Fault, Report
from pacinian.rendering.scene_log import Asked
from pacinian.rendering.smooth import Smoothing
from pacinian.rendering.tape import Tape
from pacinian.rendering.turns import Turns
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.sampling.samples import nothing
from pacinian.scene.scene import Scene
from pacinian.scene.time.envelope import resolve
from pacinian.session import Session
from pacinian.solving.blas import one_thread
from pacinian.solving.problem import Limits

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import TracebackType

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Frame
    from pacinian.plugins.solver import Solver
    from pacinian.rendering.player import Solved
    from pacinian.rendering.recording import Recorder
    from pacinian.scene.sampling.samples import Samples
    from pacinian.solving.solution import Solution
    from pacinian.types import Floats, Gains

Stage = Literal["open", "scene", "sample", "solve", "drive", "send", "record", "silence"]

SHARE = 0.7  # of a tick that a solve may take before it must give its best answer
MOST = 1000  # frames a tick
RAMP = 0.005  # [s] in which a sample comes up or goes
LOOK = 64  # solves for each whose error after rounding to levels is measured
BEHIND = 0.1  # [s] by which the loop may lag before it gives up catching up (sleep, a debugger)


class Renderer:
    """Renders a scene on an array at a fixed rate: sample, propagate, solve, modulate, quantise, send.

    scene: a `Scene`, or a function from time since `open` [s] to one, called every tick and once before the
    first; replace it at any time, from any thread. backend, solver: names or objects. rate: ticks per second [Hz].
    limits: what every solution keeps. sampler: budget, spacing, ramps. smoothing: from row to row. clock:
    for tests. recorder: keeps every tick; closed with the renderer.

    Envelopes are followed at the device's rate; where limits join all gains (power, quiet zones, exact
    samples) and objects have different envelopes, each one's mean over a tick counts. Where ticks would be
    late, one samples the scene and the next solves for it, by turns, and then there are fewer samples,
    highest priority first, until there is time again: `governed`. Every tick sends a frame.

    Use as a context manager, or call `run`, which opens and closes. A fault (a plug-in raises, a
    device is gone) silences the output and holds it silent until `reset`; the loop goes on and counts.
    Raises ArgumentError, UnknownPlugin, PluginError; `open` also what the backend raises.
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
        governed: bool = True,
        clock: Clock | None = None,
        recorder: Recorder | None = None,
    ) -> None:
        if not (isinstance(scene, Scene) or callable(scene)):
            raise ArgumentError("scene", f"must be a Scene, or a function to one, not {scene!r}")
        self.scene = scene
        self.clock = clock or SystemClock()
        self.tape = Tape(self.clock.now)
        self.session = Session(array, medium, solver, clock=self.tape.now)
        self.backend = registry.backend(backend) if isinstance(backend, str) else backend
        kind("backend", self.backend, Backend)
        self.limits = Limits() if limits is None else limits
        kind("limits", self.limits, Limits)
        self.sampler = Sampler(ramp=RAMP) if sampler is None else sampler
        kind("sampler", self.sampler, Sampler)
        self.smoothing = Smoothing() if smoothing is None else smoothing
        kind("smoothing", self.smoothing, Smoothing)
        self.period = 1.0 / number("rate", rate, low=1.0, high=100_000.0)  # [s]
        self.report = Report()
        self.halted: Fault | None = None
        self.recorder = recorder
        capability = self.backend.capability
        if capability.rate < rate * (1.0 - 1e-9):
            raise ArgumentError(
                "rate", f"of {rate:g} Hz is above the backend's {capability.rate:g} Hz"
            )
        rows = max(1, round(capability.rate / rate))  # frames that one tick lasts
        if rows > MOST:
            raise ArgumentError(
                "rate", f"of {rate:g} Hz makes {rows} frames a tick, more than {MOST}"
            )
        gap = self.period / rows  # [s]
        times: Floats = np.arange(rows, dtype=np.float64) * gap
        self.sampler.prepare(array, self.session.medium)
        self.player = Player(self.session, times, gap, self.smoothing, self.report.skipped)
        self.governor = Governor(self.period, self.sampler.budget) if governed else None
        self.turns = Turns(self.period)
        self._sampled = self._played = nothing()
        self._seen: Scene | None = None
        self._changed = True  # since it was sampled
        self._quantiser = Quantiser(capability, rows, len(array))
        self._sent: tuple[object, ...] = ()
        self._frame: Frame
        self._entered = self._start = 0.0  # [s]
        self._stage: Stage = "open"
        self._limits = self.limits  # of this tick
        self._unlooked = LOOK  # solves since the error of one was measured
        self._opened = False
        self._loud = False  # something was sent since the last silence

    @property
    def solution(self) -> Solution | None:
        """The last solution; None before the first."""
        return self.player.solved[-1].solution if self.player.solved else None

    @property
    def samples(self) -> Samples | None:
        """What was asked of it; None before the first."""
        return self.player.solved[-1].samples if self.player.solved else None

    def open(self) -> None:
        """Claim the device, silent; compile and load what a tick needs."""
        if self._opened:
            return
        from pacinian.rendering.settings import written

        self.backend.open(self.session.array)
        self._opened = True
        try:
            self._warm_up()
            if self.recorder is not None:
                self.recorder.begin(self.session.array, self.backend.capability, written(self))
        except BaseException:
            self.close()
            raise
        self.report = Report()
        self.sampler.skipped = self.player.skipped = self.report.skipped
        self.reset()
        self._start = self.clock.now()

    def _warm_up(self) -> None:
        """Sample the scene, solve and round a few points for nobody: the first tick is then like the others."""
        spare = Session(self.session.array, self.session.medium, self.session.solver)
        points = spare.propagator.origin + np.array([[0.02, 0.0, 0.2], [-0.02, 0.0, 0.2]])
        up = np.array([[0.0, 0.0, -1.0]] * 2)
        try:
            spare.solve(points[:1], [1.0])
            gains = spare.solve(points, [1.0, 1.0], facing=Facing(up)).gains
            self._quantiser.emitted(gains, self._ceiling)
            given = self.scene
            scene = given if isinstance(given, Scene) else given(0.0)
            self.sampler.sample(scene)
            held = {id(item.envelope): resolve(item.envelope) for item in scene.objects}
            for envelope in held.values():
                envelope.at(self.player.times)  # a recorded wave takes 0.3 s to load
        except Exception:  # the first tick meets it again, and reports it
            return

    def close(self) -> None:
        """Silence, and give the device back; may be called twice."""
        if not self._opened:
            return
        self._opened, self._loud = False, True
        try:
            self._silence()
        finally:
            self._attempt("silence", self.backend.close)
            if self.recorder is not None:
                self._attempt("record", self.recorder.close)

    def __enter__(self) -> Renderer:
        self.open()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def run(
        self, duration: float | None = None, on_tick: Callable[[Report], object] | None = None
    ) -> Report:
        """Tick at the rate for `duration` [s], or until Ctrl-C; then silence, always.

        on_tick: called after each tick. Ctrl-C ends the run with `report.interrupted`.
        """
        if duration is not None:
            duration = number("duration", duration, low=0.0)
        was_open = self._opened
        self.open()
        self.report.interrupted = False
        try:
            with _undisturbed():
                self._loop(duration, on_tick)
        except KeyboardInterrupt:
            self.report.interrupted = True
        finally:
            try:
                self._silence()
            finally:
                if not was_open:
                    self.close()
        return self.report

    def _loop(self, duration: float | None, on_tick: Callable[[Report], object] | None) -> None:
        begin = due = self.clock.now()
        while duration is None or due - begin < duration - self.period / 2.0:
            self.clock.wait_until(due)
            self.tick(due)
            due += self.period
            behind = self.clock.now() - due
            if behind > BEHIND:
                lost = int(behind / self.period)
                self.report.skipped["missed ticks"] += lost
                due += lost * self.period
            if on_tick is not None:
                on_tick(self.report)

    def tick(self, due: float | None = None) -> None:
        """One tick, due at `due` [s] of the clock, now unless given.

        Raises BackendError if not open, and no other Exception.
        """
        if not self._opened:
            raise BackendError("the renderer is not open: use `with renderer:`, or `run`")
        begin = self.clock.now()
        due = begin if due is None else due
        if self.halted is None:
            self._attempt("scene", lambda: self._step(due))
        else:
            self.report.skipped["halted"] += 1
            if self._loud:  # the device refused to be silent: ask again
                self._silence()
        end = self.clock.now()
        self.report.tick(end - begin, end > due + self.period)

    @property
    def sent(self) -> Frame:
        """The last frame; its arrays are reused. Raises BackendError before the first."""
        if not self._sent:
            raise BackendError("nothing has been sent yet")
        return self._frame

    @property
    def emitted(self) -> Gains:
        """What the device made of the last gains at full envelope, (N,), whether it is silent now or not."""
        solved = self.player.solved
        gains = solved[-1].gains if solved else np.zeros(len(self.session.array), np.complex64)
        return self._emitted(gains).copy()

    def reset(self) -> None:
        """Sound again after a fault, from silence and with nothing remembered."""
        self.halted, self._sent = None, ()
        self.tape.take()
        self.sampler.reset()
        self.player.reset()
        self.session.forget()
        self.turns = Turns(self.period)
        self._sampled = self._played = nothing()
        self._seen, self._changed = None, True
        if self.governor is not None:
            self.governor = Governor(self.period, self.sampler.budget)
            self.sampler.allowed = self.sampler.budget
        if self.recorder is not None:
            self.recorder.forget()

    def _step(self, due: float) -> None:
        if self._sent and not self._loud:  # it was silenced, by the end of a run
            self.reset()
        begin = self._entered = self.tape.now()
        self._stage = "scene"
        t = number("clock", due - self._start)
        self._limits, solver = self.limits, self.session.solver  # others may set them at any time
        given = self.scene
        scene = given if isinstance(given, Scene) else given(t)
        kind("scene", scene, Scene)
        frame = self._frame_of(scene, t, due)
        self._enter("send")
        self._loud = True
        self.backend.send(frame)
        self.report.frames_sent += 1
        if self.governor is not None:
            self._govern(self.governor, self.tape.now() - begin)
        self._enter("record")
        noted = self.tape.take()
        if self.recorder is not None:
            asked = Asked(scene, solver, self._limits)
            self.recorder.write(frame, t, asked, noted, same=frame is not self._frame)
        self._enter("scene")

    def _govern(self, governor: Governor, seconds: float) -> None:
        """Decide how the next ticks come to be in time, by how long this one took [s]."""
        fresh = self.player.fresh
        if self.turns.tick(seconds, bool(fresh)) or not fresh:
            return
        samples = max(len(one.samples) for one in fresh)
        self.sampler.allowed = governor.tick(seconds, samples)

    def _frame_of(self, scene: Scene, t: float, due: float) -> Frame:
        """The frame for a scene at time t [s]; the last one again if nothing has changed."""
        self._enter("sample")
        self._changed = self._changed or scene is not self._seen
        self._seen = scene
        if self.turns.samples:
            if self._changed:  # also where it has come back since
                self.sampler.changed()
            self._sampled, self._changed = self.sampler.sample(scene, t), False
        if self.turns.solves:
            self._played = self._sampled
        else:
            self.report.skipped["solve, in turn with sampling"] += 1
        samples = self._played
        sequence, sent = self.report.frames_sent, (samples, self._limits, self.session.solver)
        if self.player.steady and self._sent == sent:
            self.player.fresh.clear()
            self.report.skipped["solve, nothing moved"] += 1
            self.report.skipped["drive, nothing changed"] += 1
            return replace(self._frame, sequence=sequence, time=due)
        self._enter("solve")
        skipped, kept = self.report.skipped, "solve, nothing moved"
        before = skipped[kept]
        self.player.solve(samples, t, self._limits, SHARE * self.period)
        if not self.turns.solves:  # whether anything has moved was not looked at
            skipped[kept] = before
        self._sent = sent
        fresh = self.player.fresh
        self._unlooked += len(fresh)
        for one in fresh:  # the propagator is where the last of them is
            error = None
            if one is fresh[-1] and self._unlooked >= LOOK and len(one.samples):
                self._unlooked, error = 0, self._error(one)
            self.report.solved(one.solution.status, error)
        self._enter("drive")
        down = self._limits.power is not None
        rows = self.player.rows(t)
        self._frame = self._quantiser.frame(rows, self._ceiling, sequence, due, down)
        return self._frame

    def _enter(self, stage: Stage) -> None:
        """Note that a stage begins, and how long the one before it took."""
        now = self.clock.now()
        self.report.staged(self._stage, now - self._entered)
        self._stage, self._entered = stage, now

    def _error(self, solved: Solved) -> float:
        """Relative error of the sound pressures that the device's levels make."""
        p = self.session.propagator.apply(self._emitted(solved.gains))
        return solved.solution.targets.miss(p)

    def _emitted(self, gains: Gains) -> Gains:
        down = self._limits.power is not None
        return self._quantiser.emitted(gains, self._ceiling, down)

    @property
    def _ceiling(self) -> float:
        return min(1.0, self._limits.gain or 1.0)

    def _attempt(self, stage: Stage, action: Callable[[], None]) -> bool:
        """Do it; a failure is reported, halts, and silences the output."""
        self._stage = stage
        try:
            action()
        except Exception as error:
            fault = Fault(self.report.ticks, self._stage, f"{type(error).__name__}: {error}", error)
            if self.halted is None or fault.stage != "silence":
                self.report.fault(fault)
            self.halted = self.halted or fault
            if stage != "silence":
                self._silence()
            return False
        return True

    def _silence(self) -> None:
        """Silence the device; once more if that is interrupted."""
        if not self._loud:
            return
        try:
            done = self._attempt("silence", self.backend.silence)
        except KeyboardInterrupt:
            self.report.interrupted = True
            done = self._attempt("silence", self.backend.silence)
        self._loud = not done


@contextmanager
def _undisturbed() -> Generator[None]:
    """One thread of linear algebra, and nothing old to search for garbage: both cost milliseconds."""
    gc.collect()
    gc.freeze()
    try:
        with one_thread():
            yield
    finally:
        gc.unfreeze()
