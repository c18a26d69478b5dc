"""Cycles: several frames that render a region in turn, so that their mean meets the target.

Skin integrates pressures that repeat fast enough. Therefore a region that is too large for one solve is rendered in
bands, one after the other. A region in free air that the array renders unevenly is rendered in two frames, whose waves
come from different sides and have different errors. In a cycle of K frames, each frame is solved for the pressure that
the others do not make: K P - sum_j P_j, where P is the target of the cycle and each other frame j produces P_j.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.rendering.cached_solution import RETRY_INTERVAL
from pacinian.rendering.reachability import ReachabilityFilter
from pacinian.scene.config_sections import DEFAULT_BUDGET
from pacinian.scene.sampling.region_bands import Bands
from pacinian.scene.sampling.samples import no_samples
from pacinian.session import Session

if TYPE_CHECKING:
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Flags, Floats

MIN_REPETITION_RATE = 500.0  # repetition rate from which pressures up to some 6 Pa feel steady [Hz]
MAX_FRAMES = 4  # default limit of the number of frames in a cycle
TILTS = -0.15, 0.15  # tilts of the waves of two frames, see `Session.tilt`
# Share of transducers at their limit above which bands in free air, each with several times the target, are worse than
# fewer samples. On skin, bands are better all the same. While a region moves, its bands stay.
MAX_BAND_SATURATION = 0.1
# Share of transducers at their limit, with a single frame, below which the region may be divided into bands again.
BANDS_AGAIN_BELOW = 0.02
TWO_FRAMES_FROM = 0.02  # share of transducers at their limit from which two frames are used
ONE_FRAME_BELOW = 0.01  # share of transducers at their limit below which one frame is used again
ONE_FRAME_LATE_SHARE = 0.5  # share of late solves above which only one frame is used
RECOVERED_LATE_SHARE = 0.1  # share of late solves below which several frames are allowed again
AVERAGED_SOLVES = 64  # time constant of the share of late solves, in solves
MIN_SHARE, MAX_SHARE = 0.15, 2.5  # range of a frame's target, relative to its nominal share
MIN_PRESSURE = 1e-30  # smallest target used as a divisor [Pa]
MAX_ROUNDS = 3  # largest number of complete solves of each frame after the samples have changed
# Number of solves of a frame for the same samples, late ones included, after which the frame waits for RETRY_INTERVAL
# before each further solve.
MAX_TRIES = 12
# Time after which two frames are tried again for samples for which they were given up (MAX_LATE_TRIES), if the samples
# have not moved meanwhile [s].
TRY_AGAIN_AFTER = 2.0
# After this number of solves of a frame, if all of them ran out of time, one frame is used instead of two.
MAX_LATE_TRIES = 3


@dataclass
class CycleFrame:
    """One frame of a cycle, with its session.

    session: has the points and the last solution of this frame. reach: its reachability filter. solved: the solution
    that it plays; None before the first. tries: number of solves since the samples changed. rounds: number of these
    that had enough time. last_solve_number: sequence number, among all solves of the cycle, of this frame's last one.
    retry: time from which to solve again after MAX_TRIES [s]. relative_target: target of the last solve, relative to
    this frame's nominal share, (M',). own: mask of the samples that the last solve was for, (M,); of size 0 if its
    target is forgotten, or before the first solve.
    """

    session: Session
    reach: ReachabilityFilter
    solved: CachedSolution | None = None
    tries: int = 0
    rounds: int = 0
    last_solve_number: int = 0
    retry: float = -math.inf
    relative_target: Floats = field(default_factory=lambda: np.empty(0))
    own: Flags = field(default_factory=lambda: np.empty(0, np.bool_))

    def forget_target(self) -> None:
        """Forget the target of the last solve."""
        self.own = np.empty(0, np.bool_)


class Cycle:
    """The frames that sound in turn, for one modulator.

    Each tick solves for only one frame, so that the output lags further behind moving objects with more frames. If most
    solves for moved samples are late, only one frame is used; and if there is no time for two frames of samples that do
    not move, one frame is used for these samples.

    session: solves for the first frame, and for samples that need only one. most: largest number of frames. peak: that
    of `LoopSettings`; here, it limits the target of each frame [Pa].
    """

    def __init__(
        self, session: Session, most: int = 1, budget: int = DEFAULT_BUDGET, peak: float = math.inf
    ) -> None:
        self.most, self.peak = most, peak
        self.budget = budget
        """Largest number of samples in each band, if bands can achieve this. The loop sets it to the sampler's."""
        self.coarsens = True
        """Whether a region may have fewer samples than its spacing asks for; the loop sets this."""
        self._first = CycleFrame(session, ReachabilityFilter(session.propagator))
        self.reset()

    def reset(self) -> None:
        """Discard all solutions."""
        self._first.solved, self._first.last_solve_number = None, 0
        self._first.forget_target()
        self.frames = [self._first]
        self._wanted = 1  # most frames for these samples
        self._late, self._hurried, self._moved, self._given_up = 0.0, False, False, False
        self._again = math.inf  # time from which samples given up get another chance [s]
        self._bands, self._banded, self._overdriven = Bands(), False, False
        self._on_skin, self._tilted, self._solve_number = False, False, 0
        self.samples = no_samples()
        """The samples that the frames render together."""
        self._shares = np.ones((0, 1))
        self.asked = np.zeros(0)
        """Target of all frames together, (M,) [Pa]."""

    @property
    def count(self) -> int:
        """Number of frames in the cycle; 1 if each frame renders all samples."""
        return len(self.frames)

    @property
    def hurried(self) -> bool:
        """Whether regions get fewer frames than they could have, for want of time."""
        hurried = (self._hurried and self.most > 1) or self._given_up
        return hurried and bool((self.samples.regions >= 0).any())

    @property
    def allowed(self) -> int:
        """Largest number of frames for which there is time at present."""
        return 1 if self._hurried else self.most

    @property
    def max_bands(self) -> int:
        """Largest number of bands for the next samples."""
        return 1 if self._overdriven else self.allowed

    def begin(self, samples: Samples, most: int | None = None) -> None:
        """Render these samples from now on. most: largest number of frames; `self.most` by default."""
        solid = bool((samples.regions >= 0).any())
        most = self._wanted = min(self.allowed, self.most if most is None else most) if solid else 1
        self._moved, self._given_up = True, False
        if not np.array_equal(samples.keys, self.samples.keys):
            for frame in self.frames:
                frame.forget_target()
        self.samples, self.asked = samples, samples.radiation_pressure.copy()
        self._on_skin = samples.capsules is not None
        self._shares = self._bands.shares(samples, self.budget, min(most, self.max_bands))
        self._banded = self._shares.shape[1] > 1
        self._tilted = self._tilted and self._may_tilt
        self._arrange()

    @property
    def _may_tilt(self) -> bool:
        """Whether two waves may render these samples. On skin, one wave whose phases relax is better."""
        return not self._banded and not self._on_skin and self._wanted >= len(TILTS)

    def forget(self) -> None:
        """Discard the first frame's solution, which becomes outdated while a single frame renders all samples."""
        self._first.solved = None

    def consider(self, solved: CachedSolution) -> None:
        """Decide from a solve whether there is time for several frames, and whether to use two or one.

        Two frames are used if transducers are at their limit, because their mean is then closer to the target
        (decision 32).
        """
        solution = solved.solution
        if self._moved:
            self._moved = False
            self._late += (solution.late - self._late) / AVERAGED_SOLVES
            self._hurried = self._late > (
                RECOVERED_LATE_SHARE if self._hurried else ONE_FRAME_LATE_SHARE
            )
        settled = self._banded and all(frame.tries > 1 for frame in self.frames)
        if settled and self.coarsens and not self._on_skin:
            self._overdriven = self._overdriven or solution.saturation > MAX_BAND_SATURATION
        elif not self._banded and solution.saturation < BANDS_AGAIN_BELOW:
            self._overdriven = False
        if solution.late or not self._may_tilt:
            return
        tilted = solution.saturation >= (ONE_FRAME_BELOW if self._tilted else TWO_FRAMES_FROM)
        if tilted != self._tilted:
            self._tilted = tilted
            self._arrange()

    def _arrange(self) -> None:
        """Make a `CycleFrame` for each frame, with its tilt, and mark all for solving."""
        M, count = self._shares.shape
        if not self._banded:
            count = len(TILTS) if self._tilted else 1
            self._shares = np.full((M, count), 1.0 / count)
        first = self._first.session
        if count != len(self.frames):
            for frame in self.frames:
                frame.forget_target()
        if count < len(self.frames):
            last = max(self.frames, key=lambda frame: frame.last_solve_number)
            self._first.solved = last.solved  # until it is solved again
            del self.frames[count:]
        while len(self.frames) < count:
            session = Session(first.array, first.medium, first.solver, clock=first.clock)
            session.record_decision = first.record_decision
            session.propagator.work = first.propagator.work
            self.frames.append(CycleFrame(session, ReachabilityFilter(session.propagator)))
        for frame, tilt in zip(self.frames, TILTS if self._tilted else (0.0,) * count, strict=True):
            frame.rounds = frame.tries = 0
            frame.session.tilt = tilt
            # A band makes only a part of the pressure at some samples. Corrections would raise the pressure there, and
            # phases would relax for them.
            frame.session.refines = not self._banded

    def due(self, t: float, rounds: int = MAX_ROUNDS) -> CycleFrame | None:
        """Return the frame to solve for at time t [s], which is the one solved least recently; None if there is none.

        rounds: number of complete solves of a frame that are enough.
        """
        open_ = [
            frame
            for frame in self.frames
            if frame.rounds < rounds and (frame.tries < MAX_TRIES or t >= frame.retry)
        ]
        return min(open_, key=lambda frame: frame.last_solve_number) if open_ else None

    def sounds(self, frame: CycleFrame) -> Flags:
        """Return whether each sample sounds in this frame, (M,)."""
        return self._shares[:, self.frames.index(frame)] > 0.0

    def sum_others(
        self, frame: CycleFrame, own: Flags, P: Floats, facing: SkinFacing | None
    ) -> Floats:
        """Return the sum of what the other frames make at one frame's own samples, (M',) [Pa].

        own: mask of these samples, (M,). P: target of the whole cycle there, (M',) [Pa].
        """
        self.asked[own] = P
        q = self.samples.positions[own]
        frame.session.propagator.set_points(q, facing)
        others = np.zeros(len(q))
        for share, other in zip(self._shares[own].T, self.frames, strict=True):
            if other is frame:
                continue
            solved = other.solved
            if solved is None:
                others += self.count * share * P
            else:
                p = frame.session.propagator.apply(solved.gains)
                others += radiation_pressure(p, frame.session.medium)
        return others

    def find_remaining_target(
        self, frame: CycleFrame, own: Flags, P: Floats, others: Floats
    ) -> Floats:
        """Return the target of one frame at its own samples, (M',) [Pa]: what the other frames do not make.

        own, P: as for `sum_others`. others: its result. If another frame ran out of time, this
        frame keeps the target of its own last solve. Otherwise, it would follow the errors of the other one, and never
        settle.
        """
        nominal = self.count * self._shares[own, self.frames.index(frame)] * P
        if not np.array_equal(own, frame.own):
            frame.own, frame.relative_target = own, np.ones(len(P))
        in_time = (
            one.solved is not None and not one.solved.ran_out_of_time
            for one in self.frames
            if one is not frame
        )
        if all(in_time):
            remaining = (self.count * P - others) / np.maximum(nominal, MIN_PRESSURE)
            frame.relative_target = np.clip(remaining, MIN_SHARE, MAX_SHARE)
        return np.asarray(np.minimum(frame.relative_target * nominal, np.maximum(self.peak, P)))

    def keep(self, frame: CycleFrame, solved: CachedSolution, t: float) -> None:
        """Store the new solution of a frame, made at time t [s]."""
        self._solve_number += 1
        frame.solved, frame.last_solve_number, frame.tries = (
            solved,
            self._solve_number,
            frame.tries + 1,
        )
        frame.rounds += solved.final
        frame.retry = t + RETRY_INTERVAL
        if self._tilted and not frame.rounds and frame.tries == MAX_LATE_TRIES:
            self._given_up, self._tilted, self._wanted = True, False, 1
            self._again = t + TRY_AGAIN_AFTER
            self._arrange()

    def try_again(self, solved: CachedSolution, t: float) -> None:
        """Use two frames again at time t [s], if they were given up at least TRY_AGAIN_AFTER before.

        A busy processor may have been the reason. solved: the solution of the single frame.
        """
        if self._given_up and t >= self._again:
            self._given_up, self._wanted = False, min(self.allowed, self.most)
            self.consider(solved)

    @property
    def solutions(self) -> tuple[CachedSolution, ...]:
        """The solution that each frame plays. A frame that is not solved yet plays the solution of another one."""
        solved = [frame.solved for frame in self.frames]
        first = next((one for one in solved if one is not None), None)
        return tuple(one or first for one in solved) if first is not None else ()

    @property
    def complete(self) -> bool:
        """Whether all frames are solved."""
        return all(frame.solved is not None for frame in self.frames)


def split_frames(most: int, rate: float) -> int:
    """Return the largest number of frames in a cycle, at most `most`, so that each repeats at 500 Hz or more.

    rate: of the device, rows per second [Hz].
    """
    return max(1, min(most, int(rate / MIN_REPETITION_RATE)))
