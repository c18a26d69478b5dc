"""Turn samples into the rows of a frame: solve if necessary, reuse solutions, and apply envelopes."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import sound_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.rendering.cached_solution import CachedSolution
from pacinian.rendering.cycle import Cycle
from pacinian.rendering.envelope_groups import EnvelopeGroups, split_contributions
from pacinian.rendering.mixing import (
    find_fading,
    mean_amplitude,
    split_by_voice,
    voice_amplitudes,
)
from pacinian.rendering.reachability import HARDLY_REACHED
from pacinian.rendering.slew_limiter import SlewRateLimiter
from pacinian.scene.modulation.presentation import present
from pacinian.scene.sampling.samples import BESIDE, join_samples, no_samples

if TYPE_CHECKING:
    from pacinian.rendering.cycle import Part
    from pacinian.rendering.reachability import ReachabilityFilter
    from pacinian.rendering.slew_limiter import Smoothing
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.solving.problem import Limits
    from pacinian.types import Floats, Gains, Singles

MIN_POWER = 1e-30  # smallest power used as a divisor
CACHE_BYTES = 32 << 20  # size of the cache of solutions for the steps of a modulation [bytes]
BETTER = 0.99  # largest ratio of new to old error at which a late solution counts as improved
TRIES = 6  # most successive solves without improvement; a busy processor may spoil some

Step = tuple[object, ...]


class Modulator:
    """Turns samples into rows of gains.

    session: solves. times: of a tick's rows, from its start, (K,) [s]. gap: from row to row [s]. skipped: counts work
    that was not needed, by reason. cycle: renders regions in several frames, if allowed.
    """

    def __init__(
        self,
        session: Session,
        times: Floats,
        gap: float,
        smoothing: Smoothing,
        skipped: Counter[str],
        cycle: Cycle | None = None,
    ) -> None:
        self.session, self.skipped = session, skipped
        self.switches = False
        """Whether square waves have steps, for a device whose transducers are either on or off."""
        self.smoother = SlewRateLimiter(smoothing, len(session.array))
        self._smoothing, self._jumps = smoothing, replace(smoothing, rate=None)
        self.solved: list[CachedSolution] = []
        """The solutions that sound: one for all rows, or one for each."""
        self.fresh: list[CachedSolution] = []
        """The solutions solved in this tick."""
        self.placed: CachedSolution | None = None
        """The solution whose points the propagator holds; None if it may hold others."""
        self.cycle = cycle or Cycle(session)
        self._row = 0  # number of the next row
        self._key: tuple[object, ...] = ()
        self._steps: dict[Step, CachedSolution] = {}
        self._parts: tuple[Samples, list[tuple[Object, Samples]]] = (no_samples(), [])
        self._followed: list[CachedSolution] = []
        self._before: CachedSolution | None = None  # solution that still fades out
        self._span = 0  # remaining rows of a change
        self._growth = 1.0
        self._limited = False  # limits are new, so do not fade
        self._further = True  # whether to improve late solutions
        self._several = False  # whether a cycle of several frames sounds
        self.retime(times, gap)

    @property
    def reach(self) -> ReachabilityFilter:
        """The reachability filter of the first frame."""
        return self.cycle.parts[0].reach

    def retime(self, times: Floats, gap: float) -> None:
        """Make rows at other times from the next tick on; keep the solutions. Arguments as for the constructor."""
        K, N = len(times), len(self.session.array)
        self.times, self._gap = times, gap
        self.steady = False
        """Whether the next tick's rows will all equal the last row, if nothing changes."""
        self._carriers = np.zeros((K, N), dtype=np.complex64)
        self._smooth = np.zeros((K, N), dtype=np.complex64)
        self._rows = np.zeros((K, N), dtype=np.complex64)

    def reset(self) -> None:
        """Discard all solutions, and start from silence."""
        self._key, self._steps, self._limited = (), {}, False
        self.solved, self._followed, self.placed, self._before = [], [], None, None
        self.cycle.reset()
        self.smoother.reset()

    def solve(
        self, samples: Samples, t: float, limits: Limits, deadline: float, further: bool = True
    ) -> None:
        """Update the solutions for the tick that begins at time t [s]; deadline: from now [s]; may be infinite.

        further: whether to improve solutions that ran out of time.
        """
        self._further = further
        key = samples, limits, self.session.solver
        if self._key != key:
            self._limited = self._limited or (bool(self._key) and self._key[1] is not limits)
            self._key, self._steps, self._parts = key, {}, _parts(samples)
            self._growth = _growth(samples)
            alone = bool(self._parts[1]) or limits_join(limits)
            self.cycle.begin(samples, 1 if alone else None)
        self.fresh = []
        base, parts = self._parts
        self._several = self.cycle.count > 1
        if self._several:
            self.solved = self._in_turn(limits, deadline)
            return
        if not parts:
            found = self._found((), base, t, limits, deadline)
            self.cycle.consider(found)
            self.solved = [found]
            return
        solved: list[CachedSolution] = []
        for now in (t + self.times).tolist():
            step = tuple(item.technique.step(now) for item, _ in parts)
            kept = self._steps.get(step)
            if kept is None or not self._is_done(kept):
                row = join_samples(
                    [base, *(_present_item(item, part, now) for item, part in parts)]
                )
                kept = self._found(step, row, t, limits, deadline / len(self.times))
            else:
                self.skipped["solve, step of a modulation known"] += 1
            solved.append(kept)
        self.solved = solved

    def _is_done(self, kept: CachedSolution) -> bool:
        """Return whether a cached solution is good enough for this tick."""
        return kept.final or not self._further

    @property
    def held_back(self) -> bool:
        """Whether the limit of the slew rate kept the last row from its solution for longer than a change may take."""
        smoother = self.smoother
        return smoother.settings.rate is not None and not smoother.settled and self._span <= 0

    def rows(self, t: float, ticks: int = 1) -> Gains:
        """Return the gains of the rows of the tick that begins at time t [s], (K, N); the array is reused.

        ticks: number of ticks between solutions, over which a change is spread.
        """
        solved = self.solved
        flat = self.smoother.settled and len(solved) == 1 and solved == self._followed
        flat = flat and not self._several
        if flat:
            self._smooth[:], self._before = self.smoother.gains, None
            self.smoother.rest()
        else:
            self._follow(solved, ticks)
        at, before = t + self.times, self._before
        if flat:
            self._write_steady(solved[0], voice_amplitudes(solved[0], at, self.switches))
        for n, one in enumerate(() if flat else solved):
            own = slice(n, len(at), len(solved))  # its rows
            a, s = voice_amplitudes(one, at[own], self.switches), self._smooth[own]
            if before is None and one.parts is None:
                self._rows[own] = a[0][:, None] * s
                continue
            sound, rest = split_by_voice(one, a, s)
            if before is not None:
                fading = voice_amplitudes(before, at[own], self.switches)
                more, rest = split_by_voice(before, fading, rest)
                sound += more
            self._rows[own] = sound + mean_amplitude(one, a)[:, None] * rest
        self._row += len(at)
        self.steady = flat and solved[0].steady
        return self._rows

    def _write_steady(self, one: CachedSolution, a: Singles) -> None:
        """Write the rows while nothing fades. a: amplitudes of the voices, (V, K)."""
        if one.parts is None:
            np.multiply(a[0][:, None], self._smooth, out=self._rows)
            return
        g = one.gains
        turn = np.vdot(g, self._smooth[0]) / max(float(np.vdot(g, g).real), MIN_POWER)
        a = np.vstack([a, mean_amplitude(one, a)])
        np.matmul((turn * a.T).astype(np.complex64), one.parts, out=self._rows)

    def _follow(self, solved: list[CachedSolution], ticks: int) -> None:
        carriers = self._carriers[: len(solved)]
        for carrier, one in zip(carriers, solved, strict=True):
            carrier[:] = one.gains
        # an intended jump of a focus is not limited, and new limits apply from the first row on
        jumps = self._limited or bool(self._parts[1]) or self.cycle.count > 1
        self.smoother.settings = self._jumps if jumps else self._smoothing
        self._limited = False
        if solved != self._followed:
            self._span = ticks * len(self.times)
            self._before = find_fading(self._followed, solved)
        span = 1 if self.smoother.settings.rate is None else self._span
        self.smoother.follow(carriers, self._gap, self._smooth, span, self._growth)
        self._span -= len(self.times)
        self._followed = solved

    def _found(
        self, step: Step, samples: Samples, t: float, limits: Limits, deadline: float
    ) -> CachedSolution:
        """Return the solution for `samples`, from the cache or new.

        If limits couple all gains (power, quiet zones, exact samples), gains cannot be combined from those of each
        voice. Then the solve uses each voice's mean strength over the tick.
        """
        voices = EnvelopeGroups(samples)
        P = samples.radiation_pressure
        joint = len(voices) > 1 and limits_join(limits)
        if joint:
            strength = voices.strength(t + self.times).mean(axis=1)
            P, step = P * strength[voices.index], (*step, strength.tobytes())
        kept = self._steps.get(step)
        if kept is not None and self._is_done(kept):
            self.skipped["solve, nothing moved"] += 1
            return kept
        made = self._solve_part(self.cycle.parts[0], samples, P, voices, joint, limits, deadline)
        if kept is not None and made.solution.error > BETTER * kept.solution.error:
            vain = kept.vain + 1
            final = made.final or vain == TRIES
            made = replace(kept, steady=voices.steady and final, final=final, vain=vain)
        self.fresh.append(made)
        self.placed = made
        if (len(self._steps) + 1) * made.nbytes > CACHE_BYTES:
            self._steps = {}
        self._steps[step] = made
        return made

    def _in_turn(self, limits: Limits, deadline: float) -> list[CachedSolution]:
        """Return the solution that each row plays in a cycle of frames; first solve for one frame, if any needs it."""
        cycle, samples = self.cycle, self.cycle.samples
        part = cycle.due()
        if part is None:
            self.skipped["solve, nothing moved"] += 1
        elif self._further or not cycle.sounding:
            P, voices = samples.radiation_pressure, EnvelopeGroups(samples)
            made = self._solve_part(part, samples, P, voices, False, limits, deadline)
            cycle.keep(part, made)
            cycle.consider(made)
            self.fresh.append(made)
            self.placed = None
        rows = (cycle.row(self._row + k) for k in range(len(self.times)))
        return [solved for solved in rows if solved is not None]

    def _solve_part(
        self, part: Part, samples: Samples, P: Floats, voices: EnvelopeGroups, joint: bool, limits: Limits,
        deadline: float,
    ) -> CachedSolution:  # fmt: skip
        """Return a new solution for radiation pressures P, (M,) [Pa], minus the share of the cycle's other frames.

        joint: whether P already contains the voices' strengths.
        """
        several = self.cycle.count > 1
        q = samples.positions
        sounded = (P > 0.0) | (samples.regions == BESIDE)
        sounded &= part.reach.find_reachable(q, self.skipped)
        if several:
            sounded &= self.cycle.sounds(part)
        index = voices.index
        if limits.exact is not None:  # flags for the remaining samples
            exact = limits.exact_mask(len(q))[sounded] if len(q) else None
            limits = replace(limits, exact=exact)
        if not sounded.all():
            samples, q, P, index = samples.only(sounded), q[sounded], P[sounded], index[sounded]
        facing, self.placed = None, None
        weakened: tuple[tuple[int, int], ...] = ()
        if samples.capsules is not None and len(q):
            facing = SkinFacing.of(samples.normals, samples.capsules)
            share = part.reach.share(q, facing, self.skipped)
            hardly = samples.objects[(share < HARDLY_REACHED) & (samples.regions != BESIDE)]
            weakened = tuple(Counter(hardly.tolist()).items()) if len(hardly) else ()
            P = P * share
        if several:
            P = self.cycle.compute_rest(part, sounded, P, facing)
        session = part.session
        session.solver = self.session.solver
        solution = session.solve(
            q,
            sound_pressure(P, session.medium),
            limits=limits,
            deadline=None if deadline == math.inf else deadline,
            facing=facing,
            regions=samples.regions,
        )
        voices.index = index
        parts = None
        if len(voices) > 1 and not joint and len(q):
            parts = split_contributions(solution, session.propagator, index, len(voices))
        sounding, averaged = None if joint else voices, joint and not voices.steady
        made = CachedSolution(
            solution.gains, sounding, parts, solution, samples, False, True, 0, averaged, weakened
        )
        final = not made.ran_out_of_time
        return replace(made, steady=voices.steady and final, final=final)


def limits_join(limits: Limits) -> bool:
    """Return whether limits couple all gains, so that these cannot be combined from the parts of voices."""
    return limits.power is not None or bool(limits.solver_limits)


def _parts(samples: Samples) -> tuple[Samples, list[tuple[Object, Samples]]]:
    """Return the samples of objects that sound as a whole, and separately those of each object with a technique."""
    items = samples.items
    moving = sorted(i for i in set(samples.objects.tolist()) if not items[i].technique.still)
    if not moving:
        return samples, []
    parts = [(items[i], samples.only(samples.objects == i)) for i in moving]
    return samples.only(~np.isin(samples.objects, moving)), parts


def _growth(samples: Samples) -> float:
    """Return the factor by which the gains will grow once the samples reach the full pressure of their objects."""
    P, most = float(samples.radiation_pressure.sum()), float(samples.most.sum())
    return math.sqrt(most / P) if most > P > MIN_POWER else 1.0


def _present_item(item: Object, samples: Samples, t: float) -> Samples:
    return present(item.technique, samples, t, item.pose.matrix)
