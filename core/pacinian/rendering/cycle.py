"""Cycles: regions whose frames differ, and whose mean over a few frames is what was asked.

Skin integrates what comes again fast enough. So a region that is too large for one solve sounds in bands, one after the
other; and one that the array makes unevenly sounds in two frames, whose waves come from different sides and leave
different errors. Of K frames, each is asked for what the others leave: K P - sum_j P_j, where P is asked of all
together and frame j makes P_j.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure, sound_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.rendering.reachability import ReachabilityFilter
from pacinian.scene.sampling.bands import Bands
from pacinian.scene.sampling.samples import no_samples
from pacinian.session import Session
from pacinian.solving.problem import Targets, number_regions

if TYPE_CHECKING:
    from pacinian.rendering.modulator import CachedSolution
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Flags, Floats, Gains

INTEGRATED = 500.0  # [Hz]: what comes again so often is felt as steady up to some 6 Pa
MAX_FRAMES = 4  # of a cycle, unless told otherwise
TILTS = -0.15, 0.15  # of the waves of two frames that are to differ: see `Session.tilt`
HELD = 0.02  # share of the transducers at their limit from which on there are two frames
FREE = 0.01  # share below which there is one again
HURRIED = 0.5  # share of late solves above which there is one frame
CALM = 0.1  # share below which there may be several again
SEEN = 64  # solves of which that is the share, the last ones most
LEAST, HIGHEST = 0.15, 2.5  # of its share of what is asked: what a frame may be asked for
ROUNDS = 3  # solves of each frame after the samples have changed
TRIES = 12  # the same, with those whose time was too short


@dataclass
class Part:
    """One frame of a cycle, and what solves for it.

    session: with the points and the last solution of this frame. solved: what it plays; None before the first.
    tries: solves since the samples have changed. rounds: of these, those that had enough time. turn: when it was solved
    last, in solves.
    """

    session: Session
    reach: ReachabilityFilter
    solved: CachedSolution | None = None
    tries: int = 0
    rounds: int = 0
    turn: int = 0


class Cycle:
    """The frames that sound in turn, for one player.

    One of several frames is solved for in each tick, so that what they press lags the more behind what moves, the more
    there are. Where most solves for samples that have moved are late, there is one.

    session: solves for the first, and for all that needs no others. most: frames at most. budget: samples at most in
    each, where bands can bring that about. peak: pressure that no frame is asked for more [Pa].
    """

    def __init__(
        self, session: Session, most: int = 1, budget: int = 256, peak: float = math.inf
    ) -> None:
        self.most, self.budget, self.peak = most, budget, peak
        self._first = Part(session, ReachabilityFilter(session))
        self.reset()

    def reset(self) -> None:
        """Forget all that was solved."""
        self._first.solved, self._first.turn = None, 0
        self.parts = [self._first]
        self._wanted = 1  # frames at most of these samples
        self._late, self._hurried, self._moved = 0.0, False, False
        self._bands, self._banded, self._tilted, self._turn = Bands(), False, False, 0
        self.samples = no_samples()
        """What the frames make together."""
        self._shares = np.ones((0, 1))
        self._asked = np.zeros(0)

    @property
    def count(self) -> int:
        """Frames that sound in turn; 1 where each makes all that is asked."""
        return len(self.parts)

    @property
    def allowed(self) -> int:
        """Frames at most, as there is time for now."""
        return 1 if self._hurried else self.most

    def begin(self, samples: Samples, most: int | None = None) -> None:
        """Make these samples from now on. most: frames, if fewer than usual."""
        solid = bool((samples.regions >= 0).any())
        most = self._wanted = min(self.allowed, self.most if most is None else most) if solid else 1
        self._moved = True
        self.samples, self._asked = samples, samples.radiation_pressure.copy()
        self._shares = self._bands.shares(samples, self.budget, most)
        self._banded = self._shares.shape[1] > 1
        self._tilted = self._tilted and not self._banded and most >= len(TILTS)
        self._arrange()

    def consider(self, solved: CachedSolution) -> None:
        """See how a solve went: whether there is time for several frames, and whether two are worth it or one does.

        Two are where transducers are at their limit: their mean is nearer to what is asked then (decision 32).
        """
        solution = solved.solution
        if self._moved:
            self._moved = False
            self._late += (solution.late - self._late) / SEEN
            self._hurried = self._late > (CALM if self._hurried else HURRIED)
        if self._banded or self._wanted < len(TILTS) or solution.late:
            return
        tilted = solution.saturation >= (FREE if self._tilted else HELD)
        if tilted != self._tilted:
            self._tilted = tilted
            self._arrange()

    def _arrange(self) -> None:
        """Have as many parts as there are frames, each with its tilt, and all to be solved again."""
        M, count = self._shares.shape
        if not self._banded:
            count = len(TILTS) if self._tilted else 1
            self._shares = np.full((M, count), 1.0 / count)
        first = self._first.session
        if count < len(self.parts):
            last = max(self.parts, key=lambda part: part.turn)
            self._first.solved = last.solved  # until it is solved anew
            del self.parts[count:]
        while len(self.parts) < count:
            session = Session(first.array, first.medium, first.solver, clock=first.clock)
            session.propagator.work = first.propagator.work
            self.parts.append(Part(session, ReachabilityFilter(session)))
        for part, tilt in zip(self.parts, TILTS if self._tilted else (0.0,) * count, strict=True):
            part.rounds = part.tries = 0
            part.session.tilt, part.session.solver = tilt, first.solver

    def due(self) -> Part | None:
        """The part to be solved next: the one whose last time is longest ago; None if all are as good as they get."""
        open_ = [part for part in self.parts if part.rounds < ROUNDS and part.tries < TRIES]
        return min(open_, key=lambda part: part.turn) if open_ else None

    def sounds(self, part: Part) -> Flags:
        """Which samples sound in one part, (M,)."""
        return self._shares[:, self.parts.index(part)] > 0.0

    def left(self, part: Part, own: Flags, P: Floats, facing: SkinFacing | None) -> Floats:
        """What the other frames leave for one of them to make at its own samples, (M',) [Pa].

        own: which of the samples those are, (M,). P: asked of all frames together there, (M',) [Pa].
        """
        self._asked[own] = P
        K, q = self.count, self.samples.positions[own]
        part.session.propagator.set_points(q, facing)
        others = np.zeros(len(q))
        for share, other in zip(self._shares[own].T, self.parts, strict=True):
            if other is part:
                continue
            solved = other.solved
            if solved is None:
                others += K * share * P
            else:
                p = part.session.propagator.apply(solved.gains)
                others += radiation_pressure(p, part.session.medium)
        nominal = K * self._shares[own, self.parts.index(part)] * P
        wanted = np.clip(K * P - others, LEAST * nominal, HIGHEST * nominal)
        return np.asarray(np.minimum(wanted, np.maximum(self.peak, P)))

    def keep(self, part: Part, solved: CachedSolution) -> None:
        """One part has been solved."""
        self._turn += 1
        part.solved, part.turn, part.tries = solved, self._turn, part.tries + 1
        part.rounds += solved.final

    def row(self, number: int) -> CachedSolution | None:
        """What the row of that number plays; None before the first solve."""
        here = self.parts[number % self.count].solved
        return here or next((part.solved for part in self.parts if part.solved), None)

    @property
    def sounding(self) -> list[Gains]:
        """The gains of the frames that sound in turn, each (N,)."""
        return [part.solved.gains for part in self.parts if part.solved is not None]

    @property
    def targets(self) -> Targets:
        """What is asked of all frames together."""
        t = sound_pressure(self._asked, self._first.session.medium)
        return Targets.unchecked(t, number_regions(len(t), self.samples.regions))

    @property
    def facing(self) -> SkinFacing | None:
        """Of the skin at the samples."""
        if self.samples.capsules is None:
            return None
        return SkinFacing.of(self.samples.normals, self.samples.capsules)


def split_frames(most: int, rate: float) -> int:
    """Frames of a cycle at most, on a device of `rate` frames a second [Hz]: each place comes again at 500 Hz."""
    return max(1, min(most, int(rate / INTEGRATED)))
