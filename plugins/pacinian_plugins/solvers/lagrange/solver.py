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
from pacinian.solving.limit_enforcement import enforce_limits
from pacinian.solving.phases import choose_phases_into, initial_phases
from pacinian.solving.solution_metrics import AT_LIMIT
from pacinian_plugins.native.lagrange import MAX_START, Workspace, scale_for_single, start
from pacinian_plugins.solvers.lagrange import regions
from pacinian_plugins.solvers.lagrange.gain_limited import PhaseFreeSolve
from pacinian_plugins.solvers.lagrange.problem import Problem

if TYPE_CHECKING:
    from pacinian.types import Floats

NEARLY_FULL_DRIVE = 0.98  # share of full drive below which the proportions count as hard to make


@dataclass(frozen=True)
class Lagrange(pc.Solver):
    """min 1/2 ||p - B g||^2 + mu/2 ||g||^2 subject to `limits`: gain, power, exact samples, quiet points.

    mu: regularisation, relative to trace(B B^H) / M. mu_regions: the same for targets with regions, because their
    samples lie closer together than the array resolves. rounds: maximum number of times that free phases are chosen
    again in `constrained`. starts: additional starting phases, tried for at most 16 points, if their targets are not
    met or with `scale="max"`; ignored in a loop, which continues from the previous phases.

    Under the gain limit alone, phases and gains are found together (`gain_limited`). Then the other limits are
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
        problem = Problem(propagator, targets, limits, warm, budget, out)
        if targets.regions is not None:
            return self._solve_regions(problem)
        mu = self.mu * propagator.power
        if not mu:
            return pc.Result(note="no transducer reaches the points")
        if len(targets.amplitudes) > len(out) or (
            problem.strongest and not (targets.all_free and targets.amplitudes.min() > 0.0)
        ):
            return self._solve_constrained(problem, mu)
        result, done = self._solve_gain_limited(problem, mu)
        broken = problem.has_violation()
        if budget.spent or (done and not broken):
            return result
        first = out.copy()
        made = propagator.apply(out).astype(np.complex128)
        phases = None if broken else np.asarray(np.angle(made), np.float64)
        second = self._solve_constrained(problem, mu, phases)
        if problem.strongest and not limits.solver_limits:
            for g in (first, out):
                enforce_limits(g, limits, targets.scale)  # compare both at full strength
            if problem.rank(out) < problem.rank(first):
                out[:] = first
                return result
        return second

    def _solve_regions(self, problem: Problem) -> pc.Result:
        """Write the gains for targets with regions, whose phases are all given."""
        result = regions.solve(problem, self.mu_regions)
        if problem.budget.spent or not problem.has_violation():
            return result
        return self._solve_constrained(problem, self.mu_regions * problem.propagator.power)

    def _solve_gain_limited(self, problem: Problem, mu: float) -> tuple[pc.Result, bool]:
        """Write the gains for the gain limit alone; return the result and whether it is final.

        For `scale="max"`, it is final if the proportions are kept at nearly full drive, or, in a loop, at any drive.
        Otherwise a stronger solution may exist.
        """
        propagator, targets, limits, warm, budget, out = problem
        M, N = len(targets.amplitudes), len(out)
        key = Workspace, M, N
        workspace = acquire(key, lambda: Workspace(M, N))
        share, unit = self._start(problem, mu, workspace)
        single = out.dtype == np.complex64
        polish = PhaseFreeSolve(
            propagator.single, propagator.gram, mu, workspace, budget,
            unit / max(share, 1.0), out if single else np.empty(N, np.complex64),
            starts=self.starts if warm is None else 0,
        )  # fmt: skip
        strongest = problem.strongest and workspace.free.all()
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
            multipliers=None if strongest else workspace.y * (unit / share),
            mu=mu,
            note=describe_held(end.held, N),
        )
        release(key, workspace, M * N)
        return result, not strongest or end.share > (NEARLY_FULL_DRIVE if warm is None else 0.0)

    def _start(self, problem: Problem, mu: float, workspace: Workspace) -> tuple[float, float]:
        """Write the targets, in units of the gain limit, and the multipliers of the pseudo-inverse.

        Returns the factor that scales the targets into the range of single precision, and the unit [gain].
        """
        propagator, targets, limits, warm, _, out = problem
        M, N = len(targets.amplitudes), len(out)
        w, phases = workspace, None if warm is None else warm.phases
        if M <= MAX_START and limits.gain is not None:
            first, steps = initial_phases(M, phases)
            share = start(
                propagator.gram, targets.amplitudes, targets.phases, first, steps, mu, self.mu, limits.gain, w
            )  # fmt: skip
            return share, limits.gain
        norm = choose_phases_into(propagator, targets, phases, w.p, w.free)
        y = propagator.factor(mu).solve(w.p)
        # without a gain limit, choose a unit so large that no gain reaches it, whatever the phases
        unit = limits.gain or 100.0 * float(np.abs(propagator.adjoint(y)).max()) or 1.0
        share = scale_for_single(norm / unit, self.mu, mu, N)
        np.multiply(y, mu * share / unit, out=w.y)
        w.p[:] *= share / unit
        return share, unit

    def _solve_constrained(
        self, problem: Problem, mu: float, phases: Floats | None = None
    ) -> pc.Result:
        """Write the gains under all limits; for `scale="max"`, free phases are optimised from `phases`, (M,) [rad]."""
        from pacinian_plugins.solvers.lagrange.constrained import Constrained  # slow to import

        limits, out, constrained = problem.limits, problem.out, Constrained.of(problem, mu)
        if not problem.strongest:
            found = constrained.nearest(self.rounds)
        elif problem.targets.regions is None:
            found = constrained.strongest(phases)
        else:
            found = constrained.evenly()
        answer, unit = found.answer, constrained.unit
        out[:] = unit * answer.h
        at_limit = int((np.abs(answer.h) > AT_LIMIT).sum()) if limits.gain is not None else 0
        reached = math.sqrt(kernels.peak(out)) > 0.0
        return pc.Result(
            iterations=answer.steps,
            limited=reached
            and (at_limit > 0 or bool(limits.solver_limits) or limits.power is not None),
            late=answer.late or problem.budget.spent,
            bound=math.nan if problem.strongest else unit**2 * found.bound,
            objective=math.nan if problem.strongest else unit**2 * found.objective,
            mu=mu,
            note=describe_held(at_limit, len(out)),
            unproven=found.unproven,
        )


def describe_held(count: int, N: int) -> str:
    """Return a note for `count` of N transducers at their limit, or an empty text if there are none."""
    return f"{count / N:.0%} of the transducers at their limit" if count else ""
