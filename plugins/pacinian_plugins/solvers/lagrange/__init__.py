"""Least squares under limits by its Lagrange dual (the end of the paper's section 4), phases free or given."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.checks import check_integer, check_number
from pacinian.native import solving as kernels
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.evidence import TOLERANCE, measure_violations, relative_error
from pacinian.solving.limit_enforcement import enforce_limits
from pacinian.solving.phases import choose_phases_into, initial_phases
from pacinian_plugins.native.lagrange import begin, within
from pacinian_plugins.solvers.lagrange import regions
from pacinian_plugins.solvers.lagrange.phase_free import PhaseFreeSolve
from pacinian_plugins.solvers.lagrange.workspace import SMALL, Workspace

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Floats

AT_LIMIT = 1.0 - 1e-5  # |h| from which a transducer counts as held
NEARLY = 0.98  # of full drive: where the strongest takes less, its proportions are hard to make
WHOLE = 1.0 + 1e-6  # of the power limit: this much is rounding


@dataclass(frozen=True)
class Lagrange(pc.Solver):
    """min 1/2 ||p - B g||^2 + mu/2 ||g||^2 subject to `limits`: gain, power, exact samples, quiet points.

    mu: regularisation, relative to trace(B B^H) / M. mu_regions: the same where there are regions, whose
    samples lie closer than the array resolves. rounds: how often free phases are chosen anew where
    more than the gain limit keeps targets from being met. starts: how many other phases are gone on with where
    up to 16 points cannot be met, or are to be as strong as possible; none in a loop, where phases go on from the last.

    Under the gain limit alone phases and gains are found together (`polish`); the other limits are then
    looked at, and where one is broken, or there are more samples than transducers, convex problems are
    solved for one choice of phases after the other (`constrained`). Where no limit is reached it is the
    regularised pseudo-inverse. Targets with regions, whose phases are all given, are solved by `regions`.
    `scale="max"`: the largest multiple of the targets; of regions, the largest that is even.
    """

    name: ClassVar[str] = "lagrange"
    linear: ClassVar[bool] = True
    surrounds: ClassVar[bool] = True
    keeps: ClassVar[frozenset[str]] = frozenset({"quiet", "exact"})

    mu: Annotated[float, Meta(gt=0.0, le=1.0)] = 1e-6
    mu_regions: Annotated[float, Meta(gt=0.0, le=1.0)] = 5e-3
    rounds: Annotated[int, Meta(ge=1, le=100)] = 20
    starts: Annotated[int, Meta(ge=0, le=64)] = 16

    def __post_init__(self) -> None:
        for name in ("mu", "mu_regions"):
            value = check_number(name, getattr(self, name), low=0.0, high=1.0, above=True)
            object.__setattr__(self, name, value)
        object.__setattr__(self, "rounds", check_integer("rounds", self.rounds, low=1))
        object.__setattr__(self, "starts", check_integer("starts", self.starts, low=0))

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the gains; see `pacinian.Solver.solve`."""
        if targets.regions is not None:
            return self._regions(propagator, targets, limits, warm, budget, out)
        strongest = targets.scale == "max"
        mu = self.mu * propagator.power
        if not mu:
            return pc.Result(note="no transducer reaches the points")
        if len(targets.amplitudes) > len(out) or (
            strongest and not (targets.all_free and targets.amplitudes.min() > 0.0)
        ):
            return self._constrained(propagator, targets, limits, budget, out, mu)
        result, done = self._polished(propagator, targets, limits, warm, budget, out, mu)
        broken = self._broken(propagator, targets, limits, out)
        if budget.spent or (done and not broken):
            return result
        first = out.copy()
        made = propagator.apply(out).astype(np.complex128)
        phases = None if broken else np.asarray(np.angle(made), np.float64)
        second = self._constrained(propagator, targets, limits, budget, out, mu, phases)
        if strongest and not limits.solver_limits:
            for g in (first, out):
                enforce_limits(g, limits, targets.scale)  # as strong as they may be
            if _strength(propagator, targets, out) < _strength(propagator, targets, first):
                out[:] = first
                return result
        return second

    def _regions(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, budget: pc.Budget, out: pc.Gains,
    ) -> pc.Result:  # fmt: skip
        """Write the gains for targets with regions, all of given phase."""
        result = regions.solve(propagator, targets, limits, warm, budget, out, self.mu_regions)
        if budget.spent or not self._broken(propagator, targets, limits, out):
            return result
        mu = self.mu_regions * propagator.power
        return self._constrained(propagator, targets, limits, budget, out, mu)

    def _broken(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits, out: pc.Gains
    ) -> bool:
        """Whether gains, (N,), break a limit other than that of the gains."""
        if limits.power is not None:
            if targets.scale == "max" and targets.regions is None:
                return True  # the strongest for the gain limit is not that for power
            power = float(np.vdot(out, out).real)
            if not power <= WHOLE * limits.power:
                return True
        if not limits.solver_limits:
            return False
        return bool(measure_violations(propagator, limits, targets, propagator.apply(out), out))

    def _polished(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, budget: pc.Budget, out: pc.Gains, mu: float,
    ) -> tuple[pc.Result, bool]:  # fmt: skip
        """Write the gains that only their own limit keeps from meeting the targets.

        And whether nothing stronger is to be looked for, where that is asked: it is where full drive misses the
        proportions, and in a loop where they are missed.
        """
        M, N = len(targets.amplitudes), len(out)
        key = Workspace, M, N
        room = acquire(key, lambda: Workspace.of(M, N))
        share, unit = self._begin(propagator, targets, limits, warm, mu, room)
        single = out.dtype == np.complex64
        polish = PhaseFreeSolve(
            propagator.single, propagator.gram, room.p, room.free, mu, room, budget,
            unit / max(share, 1.0), out if single else np.empty(N, np.complex64),
            starts=self.starts if warm is None else 0,
        )  # fmt: skip
        strongest = targets.scale == "max" and room.free.all()
        end = polish.strongest() if strongest else polish.run()
        bound, objective = end.bound, end.objective
        if not single:
            fine = polish.refined(propagator.B)
            out[:] = polish.unit * fine.h
            bound, objective = fine.bound, fine.objective
        # of the strongest nothing is proven: those are of the multiple found, not of the targets
        proven = (unit / share) ** 2 if share >= 1.0 and not strongest else math.nan
        result = pc.Result(
            iterations=end.steps,
            limited=end.held > 0 and limits.gain is not None,
            late=end.late,
            bound=bound * proven,
            objective=objective * proven,
            multipliers=None if strongest else room.y * (unit / share),
            mu=mu,
            note=held(end.held, N),
        )
        release(key, room, M * N)
        return result, not strongest or end.share > (NEARLY if warm is None else 0.0)

    def _begin(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, mu: float, room: Workspace,
    ) -> tuple[float, float]:  # fmt: skip
        """Write targets, in units of the limit, and the multipliers of the pseudo-inverse, to `room`.

        Returns by how much they are scaled to be within the numbers' range, and the unit [gain].
        """
        M, N = len(targets.amplitudes), len(propagator.array)
        start = None if warm is None else warm.phases
        if M <= SMALL and limits.gain is not None:
            first, steps = initial_phases(M, start)
            begin(
                propagator.gram, targets.amplitudes, targets.phases, first, steps, mu, self.mu,
                limits.gain, N, room.p, room.free, room.y, room.L, room.found,
            )  # fmt: skip
            return float(room.found[0]), limits.gain
        norm = choose_phases_into(propagator, targets, start, room.p, room.free)
        y = propagator.factor(mu).solve(room.p)
        # without a limit none is to be felt, whatever phases are found
        unit = limits.gain or 100.0 * float(np.abs(propagator.adjoint(y)).max()) or 1.0
        share = within(norm / unit, self.mu, mu, N)
        np.multiply(y, mu * share / unit, out=room.y)
        room.p[:] *= share / unit
        return share, unit

    def _constrained(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        budget: pc.Budget, out: pc.Gains, mu: float, phases: Floats | None = None,
    ) -> pc.Result:  # fmt: skip
        """Write the gains that all limits allow; free phases of the strongest are turned from `phases`, (M,)."""
        from pacinian_plugins.solvers.lagrange.constrained import Constrained  # more to compile

        problem = Constrained.of(propagator, targets, limits, budget, mu)
        exact = targets.scale == "exact"
        if exact:
            found = problem.nearest(self.rounds)
        else:
            found = problem.strongest(phases) if targets.regions is None else problem.evenly()
        answer = found.answer
        out[:] = problem.unit * answer.h
        at_limit = int((np.abs(answer.h) > AT_LIMIT).sum()) if limits.gain is not None else 0
        reached = math.sqrt(kernels.peak(out)) > 0.0
        return pc.Result(
            iterations=answer.steps,
            limited=reached
            and (at_limit > 0 or bool(limits.solver_limits) or limits.power is not None),
            late=answer.late or budget.spent,
            bound=problem.unit**2 * found.bound if exact else math.nan,
            objective=problem.unit**2 * found.objective if exact else math.nan,
            mu=mu,
            note=held(at_limit, len(out)),
            unproven=found.unproven,
        )


def _strength(propagator: pc.Propagator, targets: pc.Targets, out: pc.Gains) -> tuple[bool, float]:
    """Whether gains keep the proportions, and how strong they are: what is stronger compares as larger."""
    p = propagator.apply(out)
    return relative_error(targets, p) <= TOLERANCE, float(np.linalg.norm(p))


def held(count: int, N: int) -> str:
    """What to say of `count` of N transducers at their limit."""
    return f"{count / N:.0%} of the transducers at their limit" if count else ""


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [Lagrange]
