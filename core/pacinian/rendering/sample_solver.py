"""Solve for the samples of a scene; reuse solutions while nothing moves."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure, sound_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.region_numbers import BESIDE
from pacinian.rendering.cached_solution import RETRY_INTERVAL, CachedSolution
from pacinian.rendering.contact_follower import ContactFollower
from pacinian.rendering.envelope_gains import MIN_POWER
from pacinian.rendering.envelope_groups import EnvelopeGroups, split_contributions
from pacinian.rendering.field_steering import MAX_MISPLACEMENT, find_factors
from pacinian.rendering.reachability import WEAKENED_BELOW
from pacinian.rendering.skin_limit import SkinLimit
from pacinian.rendering.solution_sequence import SolutionSequence
from pacinian.rendering.steered_solver import SteeredSolver
from pacinian.rendering.zone_limit import keep_zones_quiet
from pacinian.scene.modulation.presentation import present
from pacinian.scene.sampling.samples import join_samples, no_samples
from pacinian.skip_reasons import NOTHING_MOVED, STEP_KNOWN

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian.plugins.solver import Solver
    from pacinian.rendering.frame_cycle import Cycle, CycleFrame
    from pacinian.rendering.reachability import ReachabilityFilter
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.solving.limits import Limits
    from pacinian.types import Floats, Gains

# Largest size of the cache of solutions for the steps of a modulation [bytes].
CACHE_BYTES = 32 << 20
# Largest ratio of new to old error at which a late solution counts as improved.
MAX_IMPROVED_RATIO = 0.99
MISSED_BELOW = 0.9  # share of its target below which a sample counts as weaker than asked
# Samples creep if they move, but are at most MAX_MISPLACEMENT from where they were solved for. They are solved for
# again this time after the last solve [s].
MAX_CREEP_TIME = 0.033
# Number of successive solves without improvement after which the next one waits for RETRY_INTERVAL.
MAX_FAILED_IMPROVEMENTS = 6
# Regions that have been at rest for REST_BEFORE_LONG_SOLVE [s] are solved for once more, without a deadline, if the
# last solve had a deadline and took at most MAX_HURRIED_TIME [s]. The solve without a deadline takes up to five times
# as long as that one. It ends early if the scene changes.
REST_BEFORE_LONG_SOLVE, MAX_HURRIED_TIME = 0.1, 0.02

Step = tuple[object, ...]


@dataclass
class SampleSolver:
    """Solves for samples.

    session: solves. times: of a tick's rows, from its start, (K,) [s]. cycle: renders regions in several frames, if
    allowed; its `peak` also limits the pressure on skin. fresh: the solutions of the last call of `solve` that are new.
    skipped: counts samples and solves that were left out, by reason. round_gains: rounds gains as the device does; by
    default, it does not. skins: of the hands in the scene. spares_solves: whether to solve only as often as skin needs
    it. Samples that creep are then not solved for again, fields move with their samples, and regions at rest are solved
    for without a deadline. The render loop sets `skins` and `spares_solves`.
    """

    session: Session
    times: Floats
    cycle: Cycle
    skipped: Counter[str] = field(default_factory=Counter[str])
    round_gains: Callable[[Gains, Limits], Gains] = lambda gains, limits: gains
    fresh: list[CachedSolution] = field(default_factory=list[CachedSolution], init=False)
    skins: Sequence[PosedSkin] = field(default=(), init=False)
    spares_solves: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        self.skin_limit = SkinLimit(self.session)
        self._steered = SteeredSolver(self.session.array)
        self._contacts = ContactFollower(self.session.array)
        self.reset()

    @property
    def reach(self) -> ReachabilityFilter:
        """The reachability filter of the first frame."""
        return self.cycle.frames[0].reach

    def reset(self) -> None:
        """Discard all solutions."""
        self._key: tuple[object, ...] = ()
        self._samples, self._begun = no_samples(), -math.inf  # last solved for, and from when [s]
        self._steps: dict[Step, CachedSolution] = {}
        self._by_technique: tuple[Samples, list[tuple[Object, Samples]]] = (no_samples(), [])
        self._growth = 1.0
        # Samples of a cycle, those of them that are solved for, and the mask of these, (M,).
        self._common = no_samples(), no_samples(), np.zeros(0, np.bool_)
        # Samples of a cycle that get clearly less than their target, (M,).
        self._missed = np.zeros(0, np.bool_)
        self._last: SolutionSequence | None = None
        self._steered.reset()
        self._contacts.reset()
        self.fresh = []
        self.cycle.reset()
        self.skin_limit.reset()

    def solve(
        self, samples: Samples, t: float, limits: Limits, solver: Solver, deadline: float,
        at: float | None = None,
    ) -> SolutionSequence:  # fmt: skip
        """Return what to play for `samples` at time t [s]: the same object as before if nothing has changed.

        deadline: from now [s]; may be infinite. at: time for which the positions of the samples hold [s]; t by default.
        """
        self.fresh = []
        kept = (limits, solver) == self._key[1:]
        steers = self.spares_solves and self._may_steer(samples, limits)
        if not (steers and kept):
            self._steered.reset()
        if steers:
            steered = self._steered.solve(
                samples,
                t if at is None else at,
                lambda samples, factor: self._solve(
                    samples, t, limits, solver, factor * deadline, guarded=True
                ),
                lambda solutions: self._is_due(solutions, t),
                self._move_frames,
            )
            if steered is not None:
                self._contacts.reset()
                return steered
        creeps = self.spares_solves and kept and self._are_creeping(samples, t)
        if creeps:
            samples = self._samples
        solutions = self._solve(samples, t, limits, solver, deadline, once=creeps)
        if self.spares_solves and self._may_follow(solutions):
            return self._contacts.follow(solutions, t if at is None else at)
        self._contacts.reset()
        return solutions

    def _may_steer(self, samples: Samples, limits: Limits) -> bool:
        """Return whether the field of these samples may move with them: one object in free air, and no hand near it."""
        if self.skins or samples.capsules is not None or not len(samples):
            return False
        if limits.forbids_steering:
            return False
        own = samples.objects[0]
        return bool(
            (samples.objects == own).all()
            and (samples.regions >= 0).all()
            and samples.items[own].technique.keeps_places
        )

    def _may_follow(self, solutions: SolutionSequence) -> bool:
        """Return whether the field of these solutions may move with their samples: contacts with skin, in one frame."""
        samples, limits = solutions.samples, solutions.limits
        if samples.capsules is None or limits.forbids_steering:
            return False
        one = not (solutions.cycle or solutions.one_per_row or solutions.one_tick_only)
        pressed = samples.regions[samples.radiation_pressure > 0.0]
        return one and len(pressed) > 0 and bool((pressed >= 0).all())

    def _move_frames(self, centre: Floats, place: Floats) -> None:
        """Steer what the frames of the cycle play from `centre` to `place`, (3,) [m]."""
        factors = find_factors(self.session.array, self.session.medium, centre, place)
        for frame in self.cycle.frames:
            if frame.solved is not None:
                frame.solved = replace(frame.solved, gains=frame.solved.gains * factors)

    def _is_due(self, solutions: SolutionSequence, t: float) -> bool:
        """Return whether another solve at time t [s] may bring `solutions` nearer to the targets."""
        return (
            self.cycle.due(t) is not None
            if solutions.cycle
            else not solutions.rows[0].needs_no_solve(t)
        )

    def _solve(
        self, samples: Samples, t: float, limits: Limits, solver: Solver, deadline: float, *, once: bool = False,
        guarded: bool = False,
    ) -> SolutionSequence:  # fmt: skip
        """Return what to play for `samples` at time t [s].

        once: see `_solve_cycle_frame`. guarded: whether the caller plays an earlier solution if that of this solve is
        worse because it ran out of time. Therefore, two frames may be tried again.
        """
        key, last = (samples, limits, solver), self._last
        if (
            last is not None
            and not len(samples)
            and not len(last.samples)
            and key[1:] == self._key[1:]
        ):
            self.cycle.begin(samples)
            self.cycle.consider(last.rows[0])
            self.skipped[NOTHING_MOVED] += 1
            return last  # a hand that moves through empty space needs no new silence
        if self._key != key:
            self._key, self._steps, self._by_technique = key, {}, _split_by_technique(samples)
            self._samples, self._begun = samples, t
            self._last, self._growth = None, _compute_growth(samples)
            alone = bool(self._by_technique[1]) or limits.couples_gains
            self.cycle.begin(samples, 1 if alone else None)
        if guarded and self._last is not None:
            self.cycle.try_again(self._last.rows[0], t)
        if self.cycle.count > 1:
            return self._solve_cycle_frame(samples, t, limits, solver, deadline, once=once)
        self.cycle.forget()
        last = self._last
        if last is not None and last.rows[0].needs_no_solve(t) and not last.one_tick_only:
            self.skipped[NOTHING_MOVED] += 1
            return last
        base, parts = self._by_technique
        if not parts:
            found = self._get_or_solve((), base, t, limits, solver, deadline)
            self.cycle.consider(found)
            self._last = self._make(samples, limits, (found,))
            return self._last
        solved: list[CachedSolution] = []
        for now in (t + self.times).tolist():
            step = tuple(item.technique.step(now) for item, _ in parts)
            kept = self._steps.get(step)
            if kept is None or not kept.needs_no_solve(t):
                row = join_samples(
                    [base, *(_present_item(item, part, now) for item, part in parts)]
                )
                kept = self._get_or_solve(step, row, t, limits, solver, deadline / len(self.times))
            else:
                self.skipped[STEP_KNOWN] += 1
            solved.append(kept)
        return self._make(samples, limits, tuple(solved), one_per_row=True, one_tick_only=True)

    def _make(
        self, samples: Samples, limits: Limits, rows: tuple[CachedSolution, ...],
        *, one_per_row: bool = False, one_tick_only: bool = False,
    ) -> SolutionSequence:  # fmt: skip
        one_tick_only = one_tick_only or any(one.averaged for one in rows)
        return SolutionSequence(
            samples,
            limits,
            rows,
            one_per_row,
            one_tick_only=one_tick_only,
            growth=self._growth,
            hurried=self.cycle.hurried,
        )

    def _get_or_solve(
        self, step: Step, samples: Samples, t: float, limits: Limits, solver: Solver, deadline: float
    ) -> CachedSolution:  # fmt: skip
        """Return the solution for `samples`, from the cache or new.

        If limits couple all gains (power, quiet points, exact samples), gains cannot be combined from those of each
        group. Then the solve uses each group's mean strength over the tick.
        """
        groups = EnvelopeGroups(samples)
        P = samples.radiation_pressure
        joint = len(groups) > 1 and limits.couples_gains
        if joint:
            strength = groups.strength(t + self.times).mean(axis=1)
            P, step = P * strength[groups.index], (*step, strength.tobytes())
        kept = self._steps.get(step)
        if kept is not None and kept.needs_no_solve(t):
            self.skipped[NOTHING_MOVED] += 1
            return kept
        made = self._solve_frame(
            self.cycle.frames[0], samples, P, groups, joint, limits, solver, deadline,
            again=kept is not None,
        )  # fmt: skip
        better = kept is None or made.solution.error <= MAX_IMPROVED_RATIO * kept.solution.error
        if kept is not None and kept.evaluated and not better:
            failures, final = kept.failed_improvements + 1, made.final
            waits = final or failures >= MAX_FAILED_IMPROVEMENTS
            retry = t + RETRY_INTERVAL if waits else t
            solution = kept.solution
            if final:  # the old solution is as good as the new one, which had enough time
                solution = replace(solution, late=False, status=made.solution.status)
            made = replace(
                kept,
                solution=solution,
                steady=groups.steady and waits,
                final=final,
                failed_improvements=failures,
                retry=retry,
                awaits_rest=False,
            )
        hurried = deadline < math.inf and made.solution.seconds <= MAX_HURRIED_TIME
        refines = self.spares_solves and made.final and hurried and not joint
        if refines and (samples.regions >= 0).any():
            made = replace(made, awaits_rest=True, final=False, retry=t + REST_BEFORE_LONG_SOLVE)
        self.fresh.append(made)
        if (len(self._steps) + 1) * made.nbytes > CACHE_BYTES:
            self._steps = {}
        self._steps[step] = made
        return made

    def _are_creeping(self, samples: Samples, t: float) -> bool:
        """Return whether the samples creep, so that they need no other solve at time t [s]."""
        if samples is self._samples or not 0.0 <= t - self._begun < MAX_CREEP_TIME:
            return False
        return samples.is_near(self._samples, MAX_MISPLACEMENT)

    def _solve_cycle_frame(
        self, samples: Samples, t: float, limits: Limits, solver: Solver, deadline: float, *, once: bool
    ) -> SolutionSequence:  # fmt: skip
        """Return the frames of a cycle; first solve for one of them, if any needs it.

        once: solve each frame only once, because the samples will have moved before a second solve would help.
        """
        cycle = self.cycle
        if self._common[0] is not samples:
            far = self.reach.find_unreachable(samples.positions)
            reached = (samples.radiation_pressure > 0.0) | (samples.regions == BESIDE)
            if far is not None:
                reached &= ~(far[0] | far[1])
            common = samples if reached.all() else samples.only(reached)
            self._common = samples, common, reached
            self._missed = np.zeros(len(samples), np.bool_)
        frame = cycle.due(t, 1) if once else cycle.due(t)
        if frame is None:
            self.skipped[NOTHING_MOVED] += 1
        else:
            P, groups = samples.radiation_pressure, EnvelopeGroups(samples)
            again = frame.tries > 0
            made = self._solve_frame(
                frame, samples, P, groups, False, limits, solver, deadline, again=again
            )
            self._missed[cycle.sounds(frame)] = False
            self._missed[list(made.missed)] = True
            cycle.keep(frame, made, t)
            cycle.consider(made)
            self.fresh.append(made)
        _, common, reached = self._common
        return SolutionSequence(
            samples, limits, cycle.solutions, cycle=cycle.count > 1, complete=cycle.complete,
            common=common, asked=cycle.asked[reached], growth=self._growth, hurried=cycle.hurried,
            missed=tuple(np.flatnonzero(self._missed).tolist()),
        )  # fmt: skip

    def _solve_frame(
        self, frame: CycleFrame, samples: Samples, P: Floats, groups: EnvelopeGroups, joint: bool, limits: Limits,
        solver: Solver, deadline: float, *, again: bool,
    ) -> CachedSolution:  # fmt: skip
        """Return a new solution for radiation pressures P, (M,) [Pa], minus the share of the cycle's other frames.

        joint: whether P already contains the groups' strengths. again: whether there is a solution for these samples.
        """
        several, all_samples = self.cycle.count > 1, samples
        q = samples.positions
        sounded = (P > 0.0) | (samples.regions == BESIDE)
        sounded &= frame.reach.find_reachable(q, self.skipped)
        if several:
            sounded &= self.cycle.sounds(frame)
        index = groups.index
        if limits.exact is not None:  # flags for the remaining samples
            exact = limits.make_exact_mask(len(q))[sounded] if len(q) else None
            limits = replace(limits, exact=exact)
        if not sounded.all():
            samples, q, P, index = samples.only(sounded), q[sounded], P[sounded], index[sounded]
        facing, weakened = None, np.empty(0, np.intp)
        kept, asked = np.flatnonzero(sounded), samples.regions != BESIDE
        if samples.capsules is not None and len(q):
            facing = SkinFacing.of(samples.normals, samples.capsules)
            share = frame.reach.weigh_targets(q, facing, self.skipped)
            weakened = kept[(share < WEAKENED_BELOW) & asked]
            P = P * share
        others = self.cycle.sum_others(frame, sounded, P, facing) if several else np.zeros(len(q))
        target = self.cycle.find_remaining_target(frame, sounded, P, others) if several else P
        session = frame.session
        solution = session.solve(
            q,
            sound_pressure(target, session.medium),
            limits=limits,
            deadline=None if deadline == math.inf else deadline,
            solver=solver,
            facing=facing,
            regions=samples.regions,
        )
        reached = radiation_pressure(solution.sound_pressure, session.medium) + others
        missed = kept[(reached < MISSED_BELOW * self.cycle.count * P) & asked]
        groups.index = index
        parts = None
        if len(groups) > 1 and not joint and len(q):
            parts = split_contributions(solution, session.propagator, index, len(groups))
        sounding, averaged = None if joint else groups, joint and not groups.steady
        made = CachedSolution(
            solution.gains, sounding, parts, solution, samples, False, True, 0, averaged,
            all_samples, tuple(weakened.tolist()), tuple(missed.tolist()),
        )  # fmt: skip
        final = not (made.ran_out_of_time or session.unsettled)
        made = replace(made, steady=groups.steady and final, final=final)
        made = self.skin_limit.enforce(made, self.skins, self.cycle.peak, again=again)
        if (zones := session.propagator.quiet_subspace) is None:
            return made
        return keep_zones_quiet(made, zones, lambda gains: self.round_gains(gains, limits))


def _split_by_technique(samples: Samples) -> tuple[Samples, list[tuple[Object, Samples]]]:
    """Return the samples of objects that sound as a whole, and separately those of each object with a technique."""
    items = samples.items
    moving = sorted(i for i in set(samples.objects.tolist()) if not items[i].technique.keeps_places)
    if not moving:
        return samples, []
    parts = [(items[i], samples.only(samples.objects == i)) for i in moving]
    return samples.only(~np.isin(samples.objects, moving)), parts


def _compute_growth(samples: Samples) -> float:
    """Return the factor by which the gains will grow until the samples have the full pressure of their objects.

    They have it when their ramps have ended.
    """
    P, most = float(samples.radiation_pressure.sum()), float(samples.most.sum())
    return math.sqrt(most / P) if most > P > MIN_POWER else 1.0


def _present_item(item: Object, samples: Samples, t: float) -> Samples:
    return present(item.technique, samples, t, item.pose.matrix)
