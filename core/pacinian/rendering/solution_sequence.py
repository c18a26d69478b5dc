"""The solutions that the ticks play for some samples, and the result of the job that made them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from pacinian.acoustics.pressure import sound_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.rendering.deviation_log import NOTHING
from pacinian.solving.targets import Targets, number_regions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.plugins.solver import Solver
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.field_steering import Motion
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene
    from pacinian.solving.limits import Limits
    from pacinian.types import Floats

RISEN_FROM = 0.99  # share of the full force from which ramps count as ended

# A solution knows a hand that is at most this far from where it was when the solution was made [m]. A hand at 1 m/s
# needs this much if each solution is played for 75 ms.
MAX_KNOWN_DISTANCE = 0.08


@dataclass(frozen=True, eq=False)
class SolutionSequence:
    """The solutions to play for some samples.

    samples: those asked for. limits: that all gains keep. rows: the solutions to play, in turn if there are several.
    one_per_row: whether every row of a tick has a solution of its own, because a technique moves the samples; `rows`
    then has one entry for each row. cycle: whether the solutions are the frames of a cycle, and people feel their mean.
    complete: whether all frames of the cycle are solved. common: in a cycle, the samples of all frames together that
    are solved for. asked: target radiation pressure of `common`, (M,) [Pa]. one_tick_only: whether this is valid for
    one tick only, because a technique moves the samples or an envelope is averaged over the tick. growth: factor by
    which the gains will grow once the samples reach the full pressure of their objects. hurried: whether regions get
    fewer frames than they could have, for want of time. missed: in a cycle, indices of the samples that get clearly
    less than their target from all frames together, by the last solve that each sample was part of. motion: how
    `samples` have moved since the solve; None if the field stays where it was solved for. before_motion: the samples of
    the solve, if `samples` have moved since.
    """

    samples: Samples
    limits: Limits
    rows: tuple[CachedSolution, ...] = ()
    one_per_row: bool = False
    cycle: bool = False
    complete: bool = True
    common: Samples | None = None
    asked: Floats | None = None
    one_tick_only: bool = False
    growth: float = 1.0
    hurried: bool = False
    missed: tuple[int, ...] = ()
    motion: Motion | None = None
    before_motion: Samples | None = None

    @property
    def frames(self) -> int:
        """Number of frames that take turns."""
        return len(self.rows) if self.cycle else 1

    @property
    def solved_samples(self) -> Samples:
        """The samples where they were solved for."""
        return self.samples if self.before_motion is None else self.before_motion

    @cached_property
    def muted(self) -> SolutionSequence:
        """The same with gains of 0, into which the output fades; without the jumps of a technique."""
        rows = {one: replace(one, gains=0.0 * one.gains, contributions=None) for one in self.rows}
        played = self.rows[-1:] if self.one_per_row else self.rows
        return replace(self, rows=tuple(rows[one] for one in played), one_per_row=False)

    @property
    def played_samples(self) -> Samples | None:
        """Samples of the last solution, or of all frames of a cycle together; None without a solution."""
        last = self.rows[-1].samples if self.rows else None
        played = self.common if self.cycle else last
        if played is None or self.motion is None or not self.motion.shift.any():
            return played
        return played.changed(positions=played.positions + self.motion.shift)

    @property
    def targets(self) -> Targets | None:
        """Targets of the last solution, or of all frames of a cycle together; None without a solution."""
        if self.cycle:
            assert self.asked is not None
            assert self.common is not None
            t = sound_pressure(self.asked, self.rows[-1].solution.medium)
            return Targets.make_unchecked(t, number_regions(len(t), self.common.regions))
        return self.rows[-1].solution.targets if self.rows else None

    @property
    def facing(self) -> SkinFacing | None:
        """Facing of the skin at `played_samples`; None if that is not on skin."""
        if not self.cycle:
            return self.rows[-1].solution.facing if self.rows else None
        if self.common is None or self.common.capsules is None:
            return None
        return SkinFacing.of(self.common.normals, self.common.capsules)


class SolveResult(NamedTuple):
    """The result of sampling and solving for a scene.

    solver: the solver that was used. fresh: those of `solutions` that are new. sample_pressures: sound
    pressure amplitude at the played samples, as emitted where they were solved for, (M,) [Pa]; None if it is not known.
    time: scene time for which this was solved [s]. seconds: duration in the background [s]; NaN if it ran in a tick.
    too_fast: labels of the objects whose vibration the device cannot play. seen_hands: joints or vertices of the hands
    with whose skin this was solved, by name, (P, 3) [m]. labels: of all objects that this concerns. deviations: what
    this leaves out or changes, see `describe_solve`.
    """

    scene: Scene
    sample_counts: SampleCounts
    solutions: SolutionSequence
    solver: Solver
    fresh: tuple[CachedSolution, ...] = ()
    sample_pressures: Floats | None = None
    time: float = 0.0
    seconds: float = math.nan
    too_fast: tuple[str, ...] = ()
    seen_hands: Mapping[str, Floats] = MappingProxyType({})
    labels: frozenset[str] = frozenset()
    deviations: Reasons = NOTHING

    def knows(self, hand: Hand) -> bool:
        """Return whether this was solved with the skin of a hand near its present place, or with an equal hand."""
        then = self.seen_hands.get(hand.name)
        if then is not None and then.shape == hand.carriers.shape:
            d = hand.carriers - then
            if float((d * d).sum(axis=1).max()) <= MAX_KNOWN_DISTANCE * MAX_KNOWN_DISTANCE:
                return True
        return any(hand is one or hand.same(one) for one in self.scene.hands)

    @property
    def tells_time(self) -> bool:
        """Whether its duration is representative: something was solved, or there was nothing to solve."""
        return bool(self.fresh) or not len(self.solutions.samples)
