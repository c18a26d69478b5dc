"""Make a frame from a scene: sample, solve, modulate and quantise, as far as time allows."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.errors import ArgumentError
from pacinian.rendering.budget_controller import BudgetController
from pacinian.rendering.cycle import Cycle, split_frames
from pacinian.rendering.deviations import (
    AVERAGED,
    FEWER_FRAMES,
    INTERPOLATED,
    NOTHING,
    OUT_OF_TIME,
    SLEW_LIMITED,
    WEAKENED,
    mark,
)
from pacinian.rendering.modulator import Modulator, limits_join
from pacinian.rendering.probe import Probe
from pacinian.rendering.quantiser import Quantiser
from pacinian.rendering.tick_alternation import TickAlternation
from pacinian.rendering.warmup import load_envelopes, try_out
from pacinian.scene.sampling.account import (
    FAR,
    ON_TRANSDUCER,
    Account,
    label_object,
    label_samples,
)
from pacinian.scene.sampling.samples import no_samples
from pacinian.scene.scene import Scene
from pacinian.solving.problem import Limits

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Capability, Frame
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.deviations import Reasons
    from pacinian.rendering.report import StageTimer
    from pacinian.rendering.slew_limiter import Smoothing
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.types import Complexes, Floats, Gains

DEADLINE_SHARE = 0.7  # deadline of a solve, relative to a tick
MAX_ROWS = 1000  # most frames per tick
TICKS_PER_LOOK = 64  # ticks between measurements of the emitted field


class Sampled(NamedTuple):
    """A scene with its samples, and their account."""

    scene: Scene
    samples: Samples
    account: Account


class Pipeline:
    """Makes the frames of one render loop.

    session: solves. sampler: samples the scene. smoothing: slew-rate limit from row to row. capability: of the device.
    period: of a tick [s]. governed: whether to reduce the number of samples, except those of regions, if ticks would be
    late. most: largest number of frames in a cycle. peak: largest target of such a frame [Pa]. stages: stage timer,
    which also holds the report. strict: never leave anything out, and give solves all the time they need. Raises
    ArgumentError.
    """

    def __init__(
        self,
        session: Session,
        sampler: Sampler,
        smoothing: Smoothing,
        capability: Capability,
        period: float,
        governed: bool,
        most: int,
        peak: float,
        stages: StageTimer,
        strict: bool = False,
    ) -> None:
        self.session, self.sampler, self.period = session, sampler, period
        self.stages, self._most = stages, most
        sampler.prepare(session.array, session.medium)
        self.strict = sampler.strict = strict
        sampler.peak = peak
        self._deadline = math.inf if strict else DEADLINE_SHARE * period  # of a solve [s]
        times, gap = row_times(capability, period)
        cycle = Cycle(session, split_frames(most, capability.rate), sampler.budget, peak)
        self.player = Modulator(session, times, gap, smoothing, stages.report.skipped, cycle)
        self.player.switches = len(capability.sizes) == 2
        self.quantiser = Quantiser(capability, len(times), len(session.array))
        self.governor = (
            BudgetController(period, sampler.budget) if governed and not strict else None
        )
        self.limits = Limits()  # of this tick
        self.probe = Probe(session)
        self._unlooked = TICKS_PER_LOOK  # ticks since the last measurement
        self._begin()

    def _begin(self) -> None:
        self.turns = TickAlternation(self.period)
        self._sampled = self._played = self._before = Sampled(Scene(), no_samples(), Account())
        self._described: tuple[tuple[object, ...], Reasons] = (), NOTHING
        self._seen: Scene | None = None
        self._changed = True  # whether the scene changed since it was sampled
        self._made: tuple[object, ...] = ()  # inputs of the last frame
        self._frame: Frame

    def warm_up(self, scene: Callable[[float], Scene], limits: Limits) -> Scene | None:
        """Sample the scene at time 0, and solve and quantise for a few points, without output.

        Returns the scene; None after an exception, which the first tick will raise and report again. If `strict`, the
        exception is raised at once.
        """
        try:
            self.quantise_gains(try_out(self.session).gains)
            first, self.limits = scene(0.0), limits
            self._set_sampler()
            self.sampler.sample(first)
            load_envelopes(first, self.player.times)
        except Exception:
            if self.strict:
                raise
            return None
        return first

    def count(self) -> None:
        """Count in the current report of the stage timer from now on."""
        self.sampler.skipped = self.player.skipped = self.stages.report.skipped

    def use(self, capability: Capability) -> None:
        """Make frames for a device with this capability from now on. Raises ArgumentError."""
        if capability == self.quantiser.capability:
            return
        times, gap = row_times(capability, self.period)
        self.player.retime(times, gap)
        self.player.cycle.most = split_frames(self._most, capability.rate)
        self.player.switches = len(capability.sizes) == 2
        self.quantiser = Quantiser(capability, len(times), len(self.session.array))

    def reset(self) -> None:
        """Discard all state and start from silence."""
        self.sampler.reset()
        self.player.reset()
        self.session.forget()
        self._begin()
        if self.governor is not None:
            self.governor = BudgetController(self.period, self.sampler.budget)
            self.sampler.allowed = self.sampler.budget

    @property
    def shown(self) -> Scene:
        """Scene of the last frame; not always the newest if sampling and solving alternate. Empty before the first."""
        return self._played.scene

    @property
    def sent(self) -> Frame | None:
        """The last frame; None before the first."""
        return self._frame if self._made else None

    @property
    def silent(self) -> bool:
        """Whether the last frame is silent, and so are all later ones if nothing changes."""
        return bool(self._made) and self.player.steady and not self._frame.amplitude.any()

    def frame(self, scene: Scene, limits: Limits, t: float, due: float, sequence: int) -> Frame:
        """Return the frame for a scene at time t [s], due at `due` [s]; reuses the last one if nothing changed."""
        self.stages.enter("sample")
        self.limits = limits
        samples = self._sample(scene, t)
        skipped, kept = self.stages.report.skipped, "solve, nothing moved"
        made = samples, limits, self.session.solver
        if self.player.steady and self._made == made:
            self.player.fresh.clear()
            self._look()
            skipped[kept] += 1
            skipped["drive, nothing changed"] += 1
            return replace(self._frame, sequence=sequence, time=due)
        self.stages.enter("solve")
        before = skipped[kept]
        self.player.solve(samples, t, limits, self._deadline, self.turns.solves)
        if not self.turns.solves:  # not known whether anything moved
            skipped[kept] = before
        self._look()
        self.stages.enter("drive")
        rows = self.player.rows(t, 2 if self.turns.taking else 1)
        self._frame = self.quantiser.frame(rows, self._ceiling, sequence, due, self._down)
        self._made = made
        return self._frame

    @property
    def account(self) -> Account:
        """What the objects of the last frame asked for."""
        return self._played.account

    @property
    def labels(self) -> set[str]:
        """Labels of all objects that the last frame concerns, those included that it ends."""
        found = {*self._played.account.labels, *self._before.account.labels}
        for one in self._played, self._before:
            found.update(label_samples(one.samples))
        return found

    @property
    def deviations(self) -> Reasons:
        """What the last frame leaves out or changes, by object and reason."""
        player, account = self.player, self._played.account
        weakened: set[CachedSolution] = set()
        ran_out_of_time = averaged = False
        for one in set(player.solved):
            ran_out_of_time, averaged = (
                ran_out_of_time or one.ran_out_of_time,
                averaged or one.averaged,
            )
            if one.weakened:
                weakened.add(one)
        reasons: list[str] = []
        if self.turns.taking and self._moves:
            reasons.append(INTERPOLATED)
        if ran_out_of_time:
            reasons.append(OUT_OF_TIME)
        if averaged:
            reasons.append(AVERAGED)
        if player.held_back:
            reasons.append(SLEW_LIMITED)
        if player.cycle.hurried:
            reasons.append(FEWER_FRAMES)
        if account.clean and not reasons and not weakened:
            return NOTHING
        key = account, id(self._before.samples), id(self._played.samples), reasons, weakened
        if self._described[0] != key:
            made: Reasons = account.deviations
            for label, count in _count_weakened(weakened).items():
                made = mark(made, [label], WEAKENED, count)
            for reason in reasons:
                made = mark(made, sorted(self.labels), reason)
            self._described = key, made
        return self._described[1]

    @property
    def _moves(self) -> bool:
        """Whether, while ticks alternate, the last frame lies between the solutions for different samples."""
        shown = self._played.samples
        return self._sampled.samples is not shown or self._before.samples is not shown

    def same(self, frame: Frame) -> bool:
        """Return whether a frame repeats the one before."""
        return frame is not self._frame

    def govern(self, seconds: float) -> None:
        """Adapt alternation and sample budget to the duration of this tick, `seconds` [s]."""
        fresh = self.player.fresh
        if self.governor is None or self.turns.tick(seconds, bool(fresh)) or not fresh:
            return
        if any((one.samples.regions >= 0).any() for one in fresh):
            return  # a region of fewer samples would have holes
        samples = max(len(one.samples) for one in fresh)
        self.sampler.allowed = self.governor.tick(seconds, samples)

    def quantise_gains(self, gains: Gains) -> Gains:
        """Return gains, (N,), as rounded by the device; the array is reused."""
        return self.quantiser.quantise_gains(gains, self._ceiling, self._down)

    def _sample(self, scene: Scene, t: float) -> Samples:
        """Sample the scene, if it is this tick's turn, and return the samples to solve for."""
        self._changed = self._changed or scene is not self._seen
        self._seen = scene
        self._set_sampler()
        if self.turns.samples:
            if self._changed:  # even if it has changed back since
                self.sampler.invalidate()
            last, samples = self._sampled.account, self.sampler.sample(scene, t)
            if (account := self.sampler.account) is not last and len(account.samples):
                self._note_unreachable(account)
            self._sampled, self._changed = Sampled(scene, samples, account), False
        if self.turns.solves:
            self._before, self._played = self._played, self._sampled
        else:
            self.stages.report.skipped["solve, in turn with sampling"] += 1
        return self._played.samples

    def _set_sampler(self) -> None:
        """Set what the sampler must know of this tick's limits and solver."""
        alone, solver = limits_join(self.limits), self.session.solver
        self.sampler.bands = 1 if alone else self.player.cycle.allowed
        self.sampler.surround = solver.surrounds and not alone
        self.sampler.even = 0.0 if alone else solver.even

    def _note_unreachable(self, account: Account) -> None:
        """Note the samples that no sound can reach."""
        unreachable = self.player.reach.find_unreachable(account.samples.positions)
        if unreachable is None:
            return
        far, on = unreachable
        for reason, found in (FAR, far), (ON_TRANSDUCER, on):
            if found.any():
                account.drop(reason, found)

    def _look(self) -> None:
        """Count the solves; every LOOK ticks, measure the emitted field at the samples and between them."""
        report, placed = self.stages.report, self.player.placed
        for one in self.player.fresh:
            report.count_solve(one.solution.status)
        self._unlooked += 1
        cycle = self.player.cycle
        several = cycle.count > 1 and len(cycle.sounding) == cycle.count
        if self._unlooked < TICKS_PER_LOOK or not (
            several or (placed is not None and len(placed.samples))
        ):
            return
        if several:
            samples, targets, facing = cycle.samples, cycle.targets, cycle.facing
            gains = self.sounding
            p: Complexes | Floats = self.probe.hear(samples.positions, facing, gains)
        else:
            assert placed is not None
            samples, targets = placed.samples, placed.solution.targets
            if not self.player.fresh and targets.regions is None:
                return  # nothing new to measure
            propagator = self.session.propagator
            facing, gains = propagator.facing, self.quantise_gains(placed.gains)[None]
            p = propagator.apply(gains[0])
        self._unlooked = 0
        report.add_measurement(
            targets.relative_error(p), self.probe.look(samples, targets, facing, gains)
        )

    @property
    def sounding(self) -> Gains:
        """Gains of the frames of the cycle, as rounded by the device, (K, N)."""
        every = self.player.cycle.sounding if self.player.cycle.count > 1 else []
        if not every and self.player.solved:
            every = [self.player.solved[-1].gains]
        N = len(self.session.array)
        made = [self.quantise_gains(gains).copy() for gains in every]
        return np.array(made, np.complex64).reshape(-1, N)

    @property
    def _ceiling(self) -> float:
        return min(1.0, self.limits.gain or 1.0)

    @property
    def _down(self) -> bool:
        return self.limits.power is not None


def row_times(capability: Capability, period: float) -> tuple[Floats, float]:
    """Return the times of a tick's rows from its start, (K,) [s], and the interval between them [s].

    Raises ArgumentError.
    """
    rate = 1.0 / period
    if capability.rate < rate * (1.0 - 1e-9):
        raise ArgumentError("rate", f"of {rate:g} Hz is above the backend's {capability.rate:g} Hz")
    count = max(1, round(capability.rate / rate))  # rows per tick
    if count > MAX_ROWS:
        raise ArgumentError(
            "rate", f"of {rate:g} Hz makes {count} frames a tick, more than {MAX_ROWS}"
        )
    gap = period / count
    times: Floats = np.arange(count, dtype=np.float64) * gap
    return times, gap


def _count_weakened(solved: set[CachedSolution]) -> Counter[str]:
    """Return the number of weakened samples by object; of solutions for the same samples, the one with most counts."""
    most: dict[int, Counter[str]] = {}
    for one in solved:
        found = Counter({label_object(one.samples.items[i], i): count for i, count in one.weakened})
        most[id(one.samples)] = most.get(id(one.samples), Counter()) | found
    return sum(most.values(), Counter[str]())
