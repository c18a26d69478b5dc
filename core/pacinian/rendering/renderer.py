"""The loop. It never raises: what goes wrong in a tick silences the output and is reported."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

import numpy as np
from threadpoolctl import threadpool_limits

from pacinian.acoustics.pressure import sound_pressure
from pacinian.checks import FAR, number
from pacinian.errors import ArgumentError, PointOnTransducer
from pacinian.plugins import registry
from pacinian.rendering.clock import Clock, SystemClock
from pacinian.rendering.drive import Quantiser, modulate
from pacinian.rendering.report import Fault, Report
from pacinian.scene.objects import Scene
from pacinian.scene.sampling import Sampler, Samples, envelopes
from pacinian.session import Session
from pacinian.solving.problem import Limits

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import TracebackType

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend
    from pacinian.plugins.solver import Solver
    from pacinian.solving.solution import Solution
    from pacinian.types import Floats, Gains

Stage = Literal["open", "scene", "sample", "solve", "drive", "send", "silence"]

SHARE = 0.7  # of a tick that a solve may take before it must give its best answer
BEHIND = 0.1  # [s] by which the loop may lag before it gives up catching up (sleep, a debugger)


class Renderer:
    """Renders a scene on an array at a fixed rate: sample, propagate, solve, modulate, quantise, send.

    scene: a `Scene`, or a function from time since `open` [s] to one, called every tick; replace
    it at any time, from any thread. backend, solver: names or objects. rate: ticks per second [Hz].
    limits: what every solution keeps. sampler: budget and spacing. clock: for tests.

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
        self.scene = scene
        self.clock = clock or SystemClock()
        self.session = Session(array, medium, solver, clock=self.clock.now)
        self.backend = registry.backend(backend) if isinstance(backend, str) else backend
        self.limits = limits or Limits()
        self.sampler = sampler or Sampler()
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
        self._times = np.arange(rows) * self.period / rows  # [s]
        self._quantiser = Quantiser(capability, rows, len(array))
        self._modulated = np.zeros((rows, len(array)), dtype=np.complex64)
        self._gains = np.zeros(len(array), dtype=np.complex64)
        self._solved: tuple[Samples, bytes] | None = None
        self._start = 0.0  # [s]
        self._stage: Stage = "open"
        self._opened = False

    def open(self) -> None:
        """Claim the device, silent; compile and load what a tick needs."""
        if self._opened:
            return
        self.backend.open(self.session.array)
        self._opened = True
        self.report, self.halted = Report(), None
        try:
            self._solve(0.0)
            self._drive(np.ones(len(self._times)), 0.0)
        except Exception:
            pass
        self._solved = None
        self.report, self._start = Report(), self.clock.now()

    def close(self) -> None:
        """Silence, and give the device back; may be called twice."""
        if self._opened:
            self._opened = False
            self._silence()
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
            number("duration", duration, low=0.0)
        was_open = self._opened
        self.open()
        try:
            with _undisturbed():
                self._loop(duration, on_tick)
        except KeyboardInterrupt:
            self.report.interrupted = True
        finally:
            self._silence()
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
        """One tick, due at `due` [s] of the clock, now unless given. Never raises an Exception."""
        begin = self.clock.now()
        due = begin if due is None else due
        if self.halted is None:
            self._attempt("scene", lambda: self._step(due))
        else:
            self.report.skipped["halted"] += 1
        end = self.clock.now()
        self.report.tick(end - begin, end > due + self.period)

    @property
    def emitted(self) -> Gains:
        """What the device made of the last gains at full envelope, (N,), whether it is silent now or not."""
        return self._quantiser.emitted(self._gains, self._ceiling).copy()

    def reset(self) -> None:
        """Sound again after a fault."""
        self.halted, self._solved = None, None

    def _step(self, due: float) -> None:
        drive = self._solve(due - self._start)
        self._drive(drive, due)
        self._stage = "send"
        self.backend.send(self._frame)
        self.report.frames_sent += 1

    def _solve(self, t: float) -> Floats:
        """Bring the gains up to date for time t [s]; return the envelope that is left to apply, (K,)."""
        self._stage = "scene"
        scene = self.scene if isinstance(self.scene, Scene) else self.scene(t)
        self._stage = "sample"
        samples = self.sampler.sample(scene)
        drive, strength = self._envelopes(scene, t)
        key = strength.tobytes()
        if self._solved is not None and self._solved[0] is samples and self._solved[1] == key:
            self.report.skipped["solve, nothing moved"] += 1
            return drive
        self._solved = None
        self._stage = "solve"
        self._find(self._reachable(samples), strength)
        self._solved = samples, key
        return drive

    def _envelopes(self, scene: Scene, t: float) -> tuple[Floats, Floats]:
        """What all objects share, (K,), which needs no solve; and each object's own factor, (objects,)."""
        objects, times = scene.objects, t + self._times
        if not objects:
            return np.ones(len(times)), np.ones(0)
        if all(item.envelope == objects[0].envelope for item in objects[1:]):
            return objects[0].envelope.at(times), np.ones(len(objects))
        return np.ones(len(times)), envelopes(objects, times[:1])[:, 0]

    def _reachable(self, samples: Samples) -> Samples:
        """Without what is further away than sound is worth sending."""
        d = samples.positions - self.session.propagator.origin
        near = (d * d).sum(axis=1) <= FAR * FAR
        return samples if near.all() else samples.only(near)

    def _find(self, samples: Samples, strength: Floats) -> None:
        """Gains for `samples`, each object's radiation pressure times its strength, (objects,)."""
        pressure = samples.radiation_pressure * strength[samples.objects]
        amplitudes = sound_pressure(pressure, self.session.medium)
        try:
            self.solution = self.session.solve(
                samples.positions,
                amplitudes,
                limits=self.limits,
                deadline=SHARE * self.period,
                out=self._gains,
            )
        except PointOnTransducer as error:  # no hand can be there
            kept = np.ones(len(samples), dtype=np.bool_)
            kept[list(error.indices)] = False
            self.report.skipped["samples on a transducer"] += len(error.indices)
            self._find(samples.only(kept), strength)
            return
        self.report.skipped["samples out of reach"] += samples.culled
        self.report.skipped["samples over budget"] += samples.dropped
        self.report.solved(self.solution.status, self._error(self.solution))

    def _error(self, solution: Solution) -> float:
        """Relative error of the sound pressures that the device's levels make."""
        emitted = self._quantiser.emitted(self._gains, self._ceiling)
        return solution.targets.miss(self.session.propagator.apply(emitted))

    def _drive(self, envelope: Floats, due: float) -> None:
        self._stage = "drive"
        modulate(self._gains, envelope, self._modulated)
        sequence = self.report.frames_sent
        self._frame = self._quantiser.frame(self._modulated, self._ceiling, sequence, due)

    @property
    def _ceiling(self) -> float:
        return min(1.0, self.limits.gain or 1.0)

    def _attempt(self, stage: Stage, action: Callable[[], None]) -> None:
        """Do it; a failure silences the output and is reported."""
        self._stage = stage
        try:
            action()
        except Exception as error:
            message = f"{type(error).__name__}: {error}"
            fault = Fault(self.report.ticks, self._stage, message, error)
            self.report.fault(fault)
            first = self.halted is None
            self.halted = self.halted or fault
            if first and stage != "silence":
                self._silence()

    def _silence(self) -> None:
        self._attempt("silence", self.backend.silence)


@contextmanager
def _undisturbed() -> Generator[None]:
    """One thread of linear algebra, and nothing old to search for garbage: both cost milliseconds."""
    gc.collect()
    gc.freeze()
    try:
        with threadpool_limits(1):
            yield
    finally:
        gc.unfreeze()
