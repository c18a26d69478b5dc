"""Any combination of limits, or more samples than transducers: one convex problem per choice of phases."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.solving.least_squares import Reduced
from pacinian.solving.phases import choose_phases
from pacinian.solving.propagator import gram_matrix, mean_square
from pacinian_plugins.solvers.lagrange.convex import Answer, least_squares, maximise_scale
from pacinian_plugins.solvers.lagrange.lbfgs_phases import optimise_free_phases
from pacinian_plugins.solvers.lagrange.strongest_uniform import find_strongest_uniform

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats
    from pacinian_plugins.solvers.lagrange.solve_arguments import SolveArguments

MAX_MET_ERROR = 1e-4  # relative error at which free phases are not chosen again
SEARCH_GAP = 1e-3  # relative gap that suffices while searching for the strongest even distribution
# Relative gap up to which the strongest solution for given phases counts as proven.
MAX_PROVEN_GAP = 0.01
# Least relative decrease of the error in one round of new phases; less ends the rounds.
MIN_IMPROVEMENT = 0.02


class Found(NamedTuple):
    """Solution for one choice of phases, in units of the limit."""

    answer: Answer
    made: Complexes  # (M,)
    error: float  # ||p - made|| / ||p||, where free phases are those made
    bound: float = math.nan  # for the phases made
    objective: float = math.nan
    unproven: bool = False  # for `scale="max"`: a stronger solution may exist for these phases


@dataclass(frozen=True, eq=False)
class Constrained:
    """Least squares, or the largest multiple, under all of `limits`, for fixed points.

    A: B, or R of B = Q R if B has more rows than columns; the rows of the quiet points are appended.
    unit: one unit of gain [-].
    """

    arguments: SolveArguments
    mu: float
    unit: float
    A: Complexes
    gram: Complexes
    reduced: Reduced | None

    @classmethod
    def of(cls, arguments: SolveArguments, mu: float) -> Constrained:
        """Set up the problem for the current positions of the points."""
        propagator, limits = arguments.propagator, arguments.limits
        B = propagator.B
        M, N = B.shape
        reduced = Reduced.of(B) if M > N and limits.exact is None else None
        parts = [B if reduced is None else reduced.R]
        if propagator.quiet is not None:
            parts.append(propagator.quiet.B)
        A = np.ascontiguousarray(np.concatenate(parts))
        G = propagator.gram if reduced is None and len(parts) == 1 else gram_matrix(A)
        return cls(arguments, mu, limits.gain or 1.0, A, G, reduced)

    def solve_nearest(self, rounds: int) -> Found:
        """Find the nearest pressures within the limits; choose free phases again while that lowers the error."""
        propagator, targets, limits, _, budget, _ = self.arguments
        p = choose_phases(propagator, targets, None) / self.unit
        exact = limits.make_exact_mask(len(p)) if limits.exact is not None else None
        best: Found | None = None
        start: Complexes | None = None
        for _ in range(rounds):
            down = self._reduce(p)
            answer = least_squares(
                self.A, down, mu=self.mu,
                gram=self.gram, exact=exact, quiet=self._quiet, gain=limits.gain is not None,
                power=self._power, start=start, budget=budget,
            )  # fmt: skip
            found = self._restate_bound(self._evaluate(answer), p, down, exact)
            improved = best is None or found.error < (1.0 - MIN_IMPROVEMENT) * best.error
            better = best is None or (answer.kept, -found.error) > (best.answer.kept, -best.error)
            best = found if better else best
            if (
                not improved
                or answer.late
                or found.error <= MAX_MET_ERROR
                or not targets.free.any()
            ):
                break
            p, start = targets.complex(np.angle(found.made)) / self.unit, answer.y
        assert best is not None  # rounds >= 1
        return best

    def solve_strongest(self, phases: Floats | None = None) -> Found:
        """Find the largest multiple of the targets within the limits; free phases start from `phases`, (M,) [rad].

        If the proportions cannot be made at all, find the nearest pressures of any strength.
        """
        propagator, targets, limits, _, budget, _ = self.arguments
        quiet, power = self._quiet, self._power
        p = choose_phases(propagator, targets, None) if phases is None else targets.complex(phases)
        p = p / self.unit
        limited = limits.gain is not None

        def solve(c: Complexes, start: Complexes | None) -> Answer:
            return maximise_scale(
                self.A, c, gram=self.gram, quiet=quiet, gain=limited, power=power, start=start,
                budget=budget,
            )  # fmt: skip

        unproven = False
        if self.reduced is None:
            answer = optimise_free_phases(solve, p, targets.free, budget)
            if answer.strength > 0.0:
                return self._evaluate(answer)._replace(unproven=answer.gap > MAX_PROVEN_GAP)
            most = -answer.bound * float(np.linalg.norm(p)) / math.sqrt(mean_square(self.gram))
            unproven = most > MAX_PROVEN_GAP  # relative to the pressure of one transducer
        some = None if quiet is None else np.zeros_like(quiet)  # the strength is free
        nearest = least_squares(
            self.A, self._reduce(p), mu=self.mu, gram=self.gram, quiet=some, gain=False,
            budget=budget,
        )  # fmt: skip
        return self._evaluate(nearest)._replace(unproven=unproven)

    def solve_strongest_uniform(self) -> Found:
        """Find the largest even multiple of a region's targets within the limits; see `find_strongest_uniform`."""
        _, targets, limits, _, budget, _ = self.arguments
        answers = list[Answer]()
        p = targets.complex(targets.phases) / self.unit
        reach = self.arguments.compute_reach() / self.unit

        def attempt(some: Complexes) -> Complexes:
            answer = least_squares(
                self.A, self._reduce(some), mu=self.mu, gram=self.gram, quiet=self._quiet,
                gain=limits.gain is not None, power=self._power, tolerance=SEARCH_GAP,
                start=answers[-1].y if answers else None, budget=budget,
            )  # fmt: skip
            answers[:] = [answer]
            return self._compute_made(answer)

        reach[targets.beside] = 0.0
        find_strongest_uniform(p, reach, attempt, budget)
        return self._evaluate(answers[-1])

    def _restate_bound(
        self, found: Found, p: Complexes, down: Complexes, exact: Flags | None
    ) -> Found:
        """Restate bound and objective for the phases made instead of those of p: the dual is linear in p."""
        answer = found.answer
        soft = ~exact if exact is not None and answer.kept else slice(None)
        asked = self.arguments.targets.complex(np.angle(found.made)) / self.unit
        turned = self._reduce(asked)
        moved = float(np.vdot(answer.y[: len(down)], turned - down).real)
        before, after = (float(np.linalg.norm((a - found.made)[soft])) ** 2 for a in (p, asked))
        return found._replace(
            bound=answer.bound + moved + _compute_loss(asked, turned),
            objective=answer.objective + _compute_loss(p, down) + (after - before) / 2.0,
        )

    def _reduce(self, p: Complexes) -> Complexes:
        """Return targets, (M,), in the rows of A."""
        return p if self.reduced is None else self.reduced.down(p)

    @property
    def _quiet(self) -> Floats | None:
        quiet = self.arguments.limits.quiet
        return None if quiet is None else np.asarray(quiet[1], np.float64) / self.unit

    @property
    def _power(self) -> float | None:
        power = self.arguments.limits.power
        return None if power is None else power / self.unit**2

    def _evaluate(self, answer: Answer) -> Found:
        made = self._compute_made(answer)
        return Found(answer, made, self.arguments.targets.relative_error(made * self.unit))

    def _compute_made(self, answer: Answer) -> Complexes:
        M = len(self.arguments.targets.amplitudes)
        return answer.made[:M] if self.reduced is None else self.arguments.propagator.B @ answer.h


def _compute_loss(p: Complexes, down: Complexes) -> float:
    """Return 1/2 of the squared part of targets p, (M,), that no gains can make [Pa^2]."""
    return max(float(np.vdot(p, p).real - np.vdot(down, down).real), 0.0) / 2.0
