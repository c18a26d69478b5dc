"""Least squares under limits, solved by its Lagrange dual (end of the paper's section 4), for free or given phases."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_integer, check_number
from pacinian.native import solving as kernels
from pacinian.solving.back_propagation import NO_GRAM_MATRIX, affords_gram, back_propagate
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.limit_enforcement import enforce_limits
from pacinian.solving.phases import choose_phases_into, initial_phases
from pacinian.solving.skin_phases import REGION_MU
from pacinian.solving.solution_metrics import AT_LIMIT
from pacinian_plugins.native.lagrange import MAX_START, Workspace, scale_for_single, start
from pacinian_plugins.solvers.lagrange import regions
from pacinian_plugins.solvers.lagrange.gain_limited_newton import GainLimitedNewton
from pacinian_plugins.solvers.lagrange.solve_arguments import SolveArguments, describe_saturation

if TYPE_CHECKING:
    from pacinian.types import Floats

# `scale="max"` tries targets of fixed levels if its solution is weaker than this multiple of a focus: in general, and
# for close points.
MIN_STRENGTH, MIN_CLOSE_STRENGTH = 0.7, 1.6
MIN_CLOSE_COHERENCE = 0.5  # coherence above which two points are close
# Largest number of points that count as close, because the levels take too long for more. The number of points for
# which several starts are tried has its own limit, MAX_MULTISTART_SAMPLES.
MAX_CLOSE_POINTS = 16
MAX_LEVELS = 8  # largest number of these levels
# Factors from one level to the next. The search goes up by LEVEL_STEP until the first level that is missed, then down
# by the square root of LARGEST_STEP_DOWN at most; it ends when the step is below MIN_STEP.
LEVEL_STEP, LARGEST_STEP_DOWN, MIN_STEP = 1.25, 16.0, 1.05
NEARLY_FULL_DRIVE = 0.98  # fraction of full drive below which the proportions count as hard to make


@dataclass(frozen=True)
class Lagrange(pc.Solver):
    """min 1/2 ||p - B g||^2 + mu/2 ||g||^2 subject to `limits`: gain, power, exact samples, quiet points.

    mu: regularisation, relative to trace(B B^H) / M. mu_regions: the same for targets with regions, because their
    samples lie closer together than the array resolves. rounds: maximum number of times that free phases are chosen
    again in `constrained`. starts: additional starting phases, tried for at most 16 points, if their targets are not
    met or with `scale="max"`; ignored in a loop, which continues from the previous phases.

    Under the gain limit alone, phases and gains are found together (`gain_limited_newton`). Then the other limits are
    checked. If one is broken, or if there are more samples than transducers, `constrained` solves a sequence of
    convex problems, one for each choice of phases. If no limit is reached, the solution is the regularised
    pseudo-inverse. Targets with regions have all their phases given and are solved by `regions`. If the deadline leaves
    no time for B B^H, the gains are those of `back_propagate`.
    `scale="max"`: the largest multiple of the targets; for regions, the largest even one.
    """

    name: ClassVar[str] = "lagrange"
    linear: ClassVar[bool] = True
    surrounds: ClassVar[bool] = True
    keeps: ClassVar[frozenset[str]] = frozenset({"quiet", "exact"})

    mu: Annotated[float, Meta(gt=0.0, le=1.0)] = 1e-6
    mu_regions: Annotated[float, Meta(gt=0.0, le=1.0)] = REGION_MU
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
        arguments = SolveArguments(propagator, targets, limits, warm, budget, out)
        if targets.regions is not None:
            return self._solve_regions(arguments)
        mu = self.mu * propagator.power
        if not mu:
            return pc.Result(note="no transducer reaches the points")
        if limits.exact is None and not affords_gram(propagator, budget):
            phases = None if warm is None else warm.phases
            steps = back_propagate(propagator, targets, limits, phases, budget, out)
            return pc.Result(iterations=steps, late=True, note=NO_GRAM_MATRIX)
        if len(targets.amplitudes) > len(out) or (
            arguments.strongest and not (targets.all_free and targets.amplitudes.min() > 0.0)
        ):
            return self._solve_constrained(arguments, mu)
        result = self._solve_free_phases(arguments, mu)
        if arguments.strongest and not limits.solver_limits and not budget.spent:
            return self._strengthen_from_nearest(arguments, mu, result)
        return result

    def _solve_free_phases(self, arguments: SolveArguments, mu: float) -> pc.Result:
        """Write the gains, under the gain limit alone if that is enough, else under all limits."""
        propagator, _, limits, _, budget, out = arguments
        result, done = self._solve_gain_limited(arguments, mu)
        violated = arguments.has_violation()
        if done and not violated:
            return result
        if budget.spent:
            return result._replace(late=result.late or violated)
        first = out.copy()
        made = propagator.apply(out).astype(np.complex128)
        phases = None if violated else np.asarray(np.angle(made), np.float64)
        second = self._solve_constrained(arguments, mu, phases)
        if arguments.strongest and not limits.solver_limits:
            return _choose_stronger(arguments, (first, result), second)
        return second

    def _strengthen_from_nearest(
        self, arguments: SolveArguments, mu: float, result: pc.Result
    ) -> pc.Result:
        """Return `result`, or a stronger one if the gains in `out` are hardly stronger than a single focus.

        The phases of points that are closer than the array resolves can end where full drive makes hardly any sound.
        Then the gains that come nearest to targets of the norm that a focus has, of any phases, have better ones.
        """
        propagator, targets, limits, _, budget, out = arguments
        reach = float(arguments.compute_reach().min())
        if not reach:
            return result  # no sound comes to one of the points
        first = out.copy()
        enforce_limits(first, limits, targets.scale)
        kept, strength = arguments.rank(first)
        few = len(targets.amplitudes) <= MAX_CLOSE_POINTS
        close = few and arguments.coherence > MIN_CLOSE_COHERENCE
        enough = MIN_CLOSE_STRENGTH if close else MIN_STRENGTH
        if kept and strength >= enough * reach:
            return result
        met, missed = strength if kept else 0.0, math.inf  # norms of targets [Pa]
        phases: Floats | None = None
        for _ in range(MAX_LEVELS):
            if missed == math.inf:
                level = max(reach, LEVEL_STEP * met)
            else:
                level = math.sqrt(max(met, missed / LARGEST_STEP_DOWN) * missed)
            asked = targets.amplitudes * (level / targets.norm)
            nearest = dataclasses.replace(targets, amplitudes=asked, scale="exact")
            found, _ = self._solve_gain_limited(
                arguments._replace(targets=nearest, warm=None), mu, starts=0
            )
            made = np.asarray(np.angle(propagator.apply(out)), np.float64)
            # no proof: bound and objective are for these targets
            found = found._replace(bound=math.nan, objective=math.nan, multipliers=None)
            better = _choose_stronger(arguments, (first, result), found)
            if better is found:
                met, phases = level, made
            else:
                missed = level
            first, result = out.copy(), better
            if budget.spent or missed < MIN_STEP * met:
                break
        if phases is None:
            return result
        return _choose_stronger(
            arguments, (first, result), self._solve_constrained(arguments, mu, phases)
        )

    def _solve_regions(self, arguments: SolveArguments) -> pc.Result:
        """Write the gains for targets with regions, whose phases are all given."""
        result = regions.solve(arguments, self.mu_regions)
        if not arguments.has_violation():
            return result
        if arguments.budget.spent:
            return result._replace(late=True)  # the time may have run out just now
        return self._solve_constrained(arguments, self.mu_regions * arguments.propagator.power)

    def _solve_gain_limited(
        self, arguments: SolveArguments, mu: float, starts: int | None = None
    ) -> tuple[pc.Result, bool]:
        """Write the gains for the gain limit alone; return the result and whether it is final.

        starts: replaces the option of this name.

        For `scale="max"`, it is final if the proportions are kept at nearly full drive, or, in a loop, at any drive.
        Otherwise a stronger solution may exist.
        """
        propagator, targets, limits, warm, budget, out = arguments
        if starts is None:
            starts = self.starts if warm is None else 0
        M, N = len(targets.amplitudes), len(out)
        key = Workspace, M, N
        workspace = acquire(key, lambda: Workspace(M, N))
        scale, unit = self._start(arguments, mu, workspace)
        single = out.dtype == np.complex64
        newton = GainLimitedNewton(
            propagator.single, propagator.gram, mu, workspace, budget,
            unit / max(scale, 1.0), out if single else np.empty(N, np.complex64),
            starts=starts,
        )  # fmt: skip
        strongest = arguments.strongest and workspace.free.all()
        outcome = newton.solve_strongest() if strongest else newton.run()
        bound, objective = outcome.bound, outcome.objective
        if not single:
            fine = newton.refine(propagator.B)
            out[:] = newton.unit * fine.h
            bound, objective = fine.bound, fine.objective
        # no proof for the strongest: bound and objective are for the multiple found, not the targets
        bound_scale = (unit / scale) ** 2 if scale >= 1.0 and not strongest else math.nan
        result = pc.Result(
            iterations=outcome.steps,
            limited=outcome.saturated_count > 0 and limits.gain is not None,
            late=outcome.late,
            bound=bound * bound_scale,
            objective=objective * bound_scale,
            multipliers=None if strongest else workspace.y * (unit / scale),
            mu=mu,
            note=describe_saturation(outcome.saturated_count, N),
        )
        release(key, workspace, M * N)
        min_drive_fraction = NEARLY_FULL_DRIVE if warm is None else 0.0
        return result, not strongest or outcome.drive_fraction > min_drive_fraction

    def _start(
        self, arguments: SolveArguments, mu: float, workspace: Workspace
    ) -> tuple[float, float]:
        """Write the targets, in units of the gain limit, and the multipliers of the pseudo-inverse.

        Returns the factor that scales the targets into the range of single precision, and the unit [gain].
        """
        propagator, targets, limits, warm, _, out = arguments
        M, N = len(targets.amplitudes), len(out)
        w, phases = workspace, None if warm is None else warm.phases
        if M <= MAX_START and limits.gain is not None:
            first, steps = initial_phases(M, phases)
            scale = start(
                propagator.gram, targets.amplitudes, targets.phases, first, steps, mu, self.mu, limits.gain, w
            )  # fmt: skip
            return scale, limits.gain
        norm = choose_phases_into(propagator, targets, phases, w.p, w.free)
        y = propagator.factor(mu).solve(w.p)
        # without a gain limit, choose a unit so large that no gain reaches it, whatever the phases
        unit = limits.gain or 100.0 * float(np.abs(propagator.adjoint(y)).max()) or 1.0
        scale = scale_for_single(norm / unit, self.mu, mu, N)
        np.multiply(y, mu * scale / unit, out=w.y)
        w.p[:] *= scale / unit
        return scale, unit

    def _solve_constrained(
        self, arguments: SolveArguments, mu: float, phases: Floats | None = None
    ) -> pc.Result:
        """Write the gains under all limits; for `scale="max"`, free phases are optimised from `phases`, (M,) [rad]."""
        from pacinian_plugins.solvers.lagrange.constrained import Constrained  # slow to import

        limits, out, constrained = arguments.limits, arguments.out, Constrained.of(arguments, mu)
        if not arguments.strongest:
            found = constrained.solve_nearest(self.rounds)
        elif arguments.targets.regions is None:
            found = constrained.solve_strongest(phases)
        else:
            found = constrained.solve_strongest_uniform()
        answer, unit = found.answer, constrained.unit
        out[:] = unit * answer.h
        saturated_count = int((np.abs(answer.h) > AT_LIMIT).sum()) if limits.gain is not None else 0
        reached = math.sqrt(kernels.peak(out)) > 0.0
        return pc.Result(
            iterations=answer.steps,
            limited=reached and (saturated_count > 0 or limits.couples_gains),
            late=answer.late or arguments.budget.spent,
            bound=math.nan if arguments.strongest else unit**2 * found.bound,
            objective=math.nan if arguments.strongest else unit**2 * found.objective,
            mu=mu,
            note=describe_saturation(saturated_count, len(out)),
            unproven=found.unproven,
        )


def _choose_stronger(
    arguments: SolveArguments, before: tuple[pc.Gains, pc.Result], result: pc.Result
) -> pc.Result:
    """Return the result of the stronger gains, in proportion, and write them: those in `out`, or those `before`."""
    first, its_result = before
    for g in (first, arguments.out):
        enforce_limits(
            g, arguments.limits, arguments.targets.scale
        )  # compare both at full strength
    if arguments.rank(arguments.out) < arguments.rank(first):
        arguments.out[:] = first
        return its_result
    return result
