"""Least squares under limits, solved by its Lagrange dual (end of the paper's section 4), for free or given phases."""

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
from pacinian_plugins.solvers.lagrange.workspace import MAX_BEGIN_SAMPLES, Workspace

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Floats

AT_LIMIT = 1.0 - 1e-5  # |h| from which a transducer counts as at its limit
NEARLY = 0.98  # share of full drive below which the proportions count as hard to make
POWER_TOLERANCE = 1.0 + 1e-6  # factor on the power limit that allows for rounding


@dataclass(frozen=True)
class Lagrange(pc.Solver):
    """min 1/2 ||p - B g||^2 + mu/2 ||g||^2 subject to `limits`: gain, power, exact samples, quiet points.

    mu: regularisation, relative to trace(B B^H) / M. mu_regions: the same for targets with regions, because their
    samples lie closer together than the array resolves. rounds: maximum number of times that free phases are chosen
    again in `constrained`. starts: additional starting phases to try if up to 16 points cannot be met, or are to be
    as strong as possible; ignored in a loop, which continues from the previous phases.

    Under the gain limit alone, phases and gains are found together (`phase_free`). Then the other limits are
    checked. If one is broken, or if there are more samples than transducers, `constrained` solves a sequence of
    convex problems, one for each choice of phases. If no limit is reached, the solution is the regularised
    pseudo-inverse. Targets with regions have all their phases given and are solved by `regions`.
    `scale="max"`: the largest multiple of the targets; for regions, the largest even one.
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
            return self._solve_constrained(propagator, targets, limits, budget, out, mu)
        result, done = self._solve_gain_limited(propagator, targets, limits, warm, budget, out, mu)
        broken = self._has_violation(propagator, targets, limits, out)
        if budget.spent or (done and not broken):
            return result
        first = out.copy()
        made = propagator.apply(out).astype(np.complex128)
        phases = None if broken else np.asarray(np.angle(made), np.float64)
        second = self._solve_constrained(propagator, targets, limits, budget, out, mu, phases)
        if strongest and not limits.solver_limits:
            for g in (first, out):
                enforce_limits(g, limits, targets.scale)  # compare both at full strength
            if _strength(propagator, targets, out) < _strength(propagator, targets, first):
                out[:] = first
                return result
        return second

    def _regions(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, budget: pc.Budget, out: pc.Gains,
    ) -> pc.Result:  # fmt: skip
        """Write the gains for targets with regions, whose phases are all given."""
        result = regions.solve(propagator, targets, limits, warm, budget, out, self.mu_regions)
        if budget.spent or not self._has_violation(propagator, targets, limits, out):
            return result
        mu = self.mu_regions * propagator.power
        return self._solve_constrained(propagator, targets, limits, budget, out, mu)

    def _has_violation(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits, out: pc.Gains
    ) -> bool:
        """Return whether gains, (N,), break a limit other than the gain limit."""
        if limits.power is not None:
            if targets.scale == "max" and targets.regions is None:
                return True  # the strongest under the gain limit is not the strongest under power
            power = float(np.vdot(out, out).real)
            if not power <= POWER_TOLERANCE * limits.power:
                return True
        if not limits.solver_limits:
            return False
        return bool(measure_violations(propagator, limits, targets, propagator.apply(out), out))

    def _solve_gain_limited(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, budget: pc.Budget, out: pc.Gains, mu: float,
    ) -> tuple[pc.Result, bool]:  # fmt: skip
        """Write the gains for the gain limit alone; return the result and whether it is final.

        For `scale="max"`, it is final if the proportions are kept at nearly full drive, or, in a loop, at any drive.
        Otherwise a stronger solution may exist.
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
            fine = polish.refine(propagator.B)
            out[:] = polish.unit * fine.h
            bound, objective = fine.bound, fine.objective
        # no proof for the strongest: bound and objective are for the multiple found, not the targets
        proven = (unit / share) ** 2 if share >= 1.0 and not strongest else math.nan
        result = pc.Result(
            iterations=end.steps,
            limited=end.held > 0 and limits.gain is not None,
            late=end.late,
            bound=bound * proven,
            objective=objective * proven,
            multipliers=None if strongest else room.y * (unit / share),
            mu=mu,
            note=describe_held(end.held, N),
        )
        release(key, room, M * N)
        return result, not strongest or end.share > (NEARLY if warm is None else 0.0)

    def _begin(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, mu: float, room: Workspace,
    ) -> tuple[float, float]:  # fmt: skip
        """Write the targets, in units of the gain limit, and the multipliers of the pseudo-inverse to `room`.

        Returns the factor that scales the targets into the range of single precision, and the unit [gain].
        """
        M, N = len(targets.amplitudes), len(propagator.array)
        start = None if warm is None else warm.phases
        if M <= MAX_BEGIN_SAMPLES and limits.gain is not None:
            first, steps = initial_phases(M, start)
            begin(
                propagator.gram, targets.amplitudes, targets.phases, first, steps, mu, self.mu,
                limits.gain, N, room.p, room.free, room.y, room.L, room.found,
            )  # fmt: skip
            return float(room.found[0]), limits.gain
        norm = choose_phases_into(propagator, targets, start, room.p, room.free)
        y = propagator.factor(mu).solve(room.p)
        # without a gain limit, choose a unit so large that no gain reaches it, whatever the phases
        unit = limits.gain or 100.0 * float(np.abs(propagator.adjoint(y)).max()) or 1.0
        share = within(norm / unit, self.mu, mu, N)
        np.multiply(y, mu * share / unit, out=room.y)
        room.p[:] *= share / unit
        return share, unit

    def _solve_constrained(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        budget: pc.Budget, out: pc.Gains, mu: float, phases: Floats | None = None,
    ) -> pc.Result:  # fmt: skip
        """Write the gains under all limits; for `scale="max"`, free phases are optimised from `phases`, (M,) [rad]."""
        from pacinian_plugins.solvers.lagrange.constrained import Constrained  # slow to import

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
            note=describe_held(at_limit, len(out)),
            unproven=found.unproven,
        )


def _strength(propagator: pc.Propagator, targets: pc.Targets, out: pc.Gains) -> tuple[bool, float]:
    """Return a sort key: whether gains keep the proportions, then how strong they are [Pa]."""
    p = propagator.apply(out)
    return relative_error(targets, p) <= TOLERANCE, float(np.linalg.norm(p))


def describe_held(count: int, N: int) -> str:
    """Return a note for `count` of N transducers at their limit, or an empty text if there are none."""
    return f"{count / N:.0%} of the transducers at their limit" if count else ""


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [Lagrange]
