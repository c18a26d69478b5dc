"""The loop. It never raises: what goes wrong in a tick silences the output and is reported."""

from __future__ import annotations

import gc
import operator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.acoustics.pressure import sound_pressure
from pacinian.checks import FAR, kind, number
from pacinian.errors import ArgumentError, BackendError
from pacinian.plugins import registry
from pacinian.plugins.backend import Backend
from pacinian.rendering.clock import Clock, SystemClock
from pacinian.rendering.drive import Quantiser, modulate
from pacinian.rendering.report import Fault, Report
from pacinian.scene.objects import Scene
from pacinian.scene.sampling import Sampler, Samples, envelopes
from pacinian.session import Session
from pacinian.solving.blas import one_thread
from pacinian.solving.problem import Limits

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import TracebackType

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.solver import Solver
    from pacinian.solving.solution import Solution
    from pacinian.types import Flags, Floats, Gains

Stage = Literal["open", "scene", "sample", "solve", "drive", "send", "silence"]

SHARE = 0.7  # of a tick that a solve may take before it must give its best answer
MOST = 1000  # frames a tick
LOOK = 8  # solves for each whose error after rounding to levels is measured
TOUCHING = 1e-5  # [m]; a sample this near to a transducer is on it
BEHIND = 0.1  # [s] by which the loop may lag before it gives up catching up (sleep, a debugger)


class Renderer:
    """Renders a scene on an array at a fixed rate: sample, propagate, solve, modulate, quantise, send.

    scene: a `Scene`, or a function from time since `open` [s] to one, called every tick; replace
    it at any time, from any thread. backend, solver: names or objects. rate: ticks per second [Hz].
    limits: what every solution keeps. sampler: budget and spacing. clock: for tests.

    An envelope that all objects share is followed at the device's rate; of different ones each
    object's mean over a tick counts.

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
        clock: Clock | None = None,
    ) -> None:
        if not (isinstance(scene, Scene) or callable(scene)):
            raise ArgumentError("scene", f"must be a Scene, or a function to one, not {scene!r}")
        self.scene = scene
        self.clock = clock or SystemClock()
        self.session = Session(array, medium, solver, clock=self.clock.now)
        self.backend = registry.backend(backend) if isinstance(backend, str) else backend
        kind("backend", self.backend, Backend)
        self.limits = Limits() if limits is None else limits
        kind("limits", self.limits, Limits)
        self.sampler = Sampler() if sampler is None else sampler
        kind("sampler", self.sampler, Sampler)
        self.period = 1.0 / number("rate", rate, low=1.0, high=100_000.0)  # [s]
        self.report = Report()
        self.halted: Fault | None = None
        self.solution: Solution | None = None
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
        self._times = np.arange(rows) * self.period / rows  # [s]
        self._quantiser = Quantiser(capability, rows, len(array))
        self._modulated = np.zeros((rows, len(array)), dtype=np.complex64)
        self._gains = np.zeros(len(array), dtype=np.complex64)
        self._spare = np.zeros(len(array), dtype=np.complex64)
        away = np.abs(array.positions - self.session.propagator.origin)
        self._extent = away.max(axis=0) + TOUCHING  # [m]
        self._solved: tuple[object, ...] | None = None
        self._start = 0.0  # [s]
        self._stage: Stage = "open"
        self._opened = False
        self._loud = False  # something was sent since the last silence

    def open(self) -> None:
        """Claim the device, silent; compile and load what a tick needs."""
        if self._opened:
            return
        self.backend.open(self.session.array)
        self._opened = True
        try:
            self._warm_up()
        except BaseException:
            self.close()
            raise
        self.report, self.halted, self._solved = Report(), None, None
        self._start = self.clock.now()

    def _warm_up(self) -> None:
        """Solve and round two points for nobody: the first tick is then like the others."""
        spare = Session(self.session.array, self.session.medium, self.session.solver)
        points = spare.propagator.origin + np.array([[0.02, 0.0, 0.2], [-0.02, 0.0, 0.2]])
        try:
            gains = spare.solve(points, [1.0, 1.0]).gains
        except Exception:  # the first tick meets it again, and reports it
            return
        self._quantiser.emitted(gains, self._ceiling)

    def close(self) -> None:
        """Silence, and give the device back; may be called twice."""
        if not self._opened:
            return
        self._opened, self._loud = False, True
        try:
            self._silence()
        finally:
            self._attempt("silence", self.backend.close)

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
    def emitted(self) -> Gains:
        """What the device made of the last gains at full envelope, (N,), whether it is silent now or not."""
        return self._emitted().copy()

    def reset(self) -> None:
        """Sound again after a fault."""
        self.halted, self._solved = None, None

    def _step(self, due: float) -> None:
        drive = self._solve(due - self._start)
        self._drive(drive, due)
        self._stage = "send"
        self._loud = True
        self.backend.send(self._frame)
        self.report.frames_sent += 1

    def _solve(self, t: float) -> Floats:
        """Bring the gains up to date for time t [s]; return the envelope that is left to apply, (K,)."""
        self._stage = "scene"
        given = self.scene
        scene = given if isinstance(given, Scene) else given(t)
        self._stage = "sample"
        samples = self.sampler.sample(scene)
        drive, strength = self._envelopes(scene, t)
        key = samples, strength.tobytes(), self.limits, self.session.solver
        if self._solved is not None and all(map(operator.eq, key, self._solved)):
            self.report.skipped["solve, nothing moved"] += 1
            return drive
        self._solved = None
        self._stage = "solve"
        self._find(samples, strength)
        self._solved = key
        return drive

    def _envelopes(self, scene: Scene, t: float) -> tuple[Floats, Floats]:
        """What all objects share, (K,), which needs no solve; and each object's own factor, (objects,).

        Where objects have different envelopes, each one's mean over the tick is its factor.
        """
        objects, times = scene.objects, t + self._times
        if not objects:
            return np.ones(len(times)), np.ones(0)
        if all(item.envelope == objects[0].envelope for item in objects[1:]):
            return envelopes(objects[:1], times)[0], np.ones(len(objects))
        return np.ones(len(times)), envelopes(objects, times).mean(axis=1)

    def _find(self, samples: Samples, strength: Floats) -> None:
        """Gains for `samples`, each object's radiation pressure times its strength, (objects,)."""
        pressure = samples.radiation_pressure * strength[samples.objects]
        q = samples.positions
        kept = (pressure > 0.0) & self._reachable(q)
        if not kept.all():
            q, pressure = q[kept], pressure[kept]
        self.report.skipped["samples out of the workspace"] += samples.culled
        self.report.skipped["samples over budget"] += samples.dropped
        solution = self.session.solve(
            q,
            sound_pressure(pressure, self.session.medium),
            limits=self.limits,
            deadline=SHARE * self.period,
            out=self._spare,
        )
        self._gains, self._spare = self._spare, self._gains
        self.solution = solution
        error = None if self.report.solves % LOOK else self._error(solution)
        self.report.solved(solution.status, error)

    def _reachable(self, q: Floats) -> Flags:
        """Which of the points q, (M, 3) [m], sound can be sent to: not too far, and on no transducer."""
        kept = np.ones(len(q), dtype=np.bool_)
        if not len(q):
            return kept
        d = np.abs(q - self.session.propagator.origin)
        if d.max() > FAR / 2.0:
            kept = np.asarray((d * d).sum(axis=1) <= FAR * FAR)
            self.report.skipped["samples out of reach"] += len(q) - int(kept.sum())
        inside = (d <= self._extent).all(axis=1)
        if self.session.medium.singular and inside.any():
            for m in np.flatnonzero(inside):
                r = self.session.array.positions - q[m]
                if (r * r).sum(axis=1).min() < TOUCHING**2:  # no hand can be there
                    kept[m] = False
                    self.report.skipped["samples on a transducer"] += 1
        return kept

    def _error(self, solution: Solution) -> float:
        """Relative error of the sound pressures that the device's levels make."""
        return solution.targets.miss(self.session.propagator.apply(self._emitted()))

    def _drive(self, envelope: Floats, due: float) -> None:
        self._stage = "drive"
        modulate(self._gains, envelope, self._modulated)
        sequence = self.report.frames_sent
        down = self.limits.power is not None
        self._frame = self._quantiser.frame(self._modulated, self._ceiling, sequence, due, down)

    def _emitted(self) -> Gains:
        down = self.limits.power is not None
        return self._quantiser.emitted(self._gains, self._ceiling, down)

    @property
    def _ceiling(self) -> float:
        return min(1.0, self.limits.gain or 1.0)

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
