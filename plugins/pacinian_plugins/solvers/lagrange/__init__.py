"""Least squares under |g_n| <= limit by its Lagrange dual (the end of the paper's section 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, cast

import numpy as np
from scipy import linalg

import pacinian as pc
from pacinian.checks import integer, number
from pacinian.solving.factor import Factor
from pacinian.solving.phases import choose, choose_into
from pacinian.solving.propagator import gram
from pacinian.solving.rooms import give, take
from pacinian_plugins.solvers.lagrange.dual import Dual, Point
from pacinian_plugins.solvers.lagrange.polish import Polish, Room, deliver

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes

AT_LIMIT = 1.0 - 1e-5  # |h| from which a transducer counts as held
MET = 1e-4  # relative error at which free phases need not be chosen anew
IN_PROPORTION = 1e-3  # relative error up to which `scale="max"` counts proportions as kept
GAIN = 0.02  # a round of new phases that lowers the error by less is the last


@dataclass(frozen=True)
class Lagrange(pc.Solver):
    """min 1/2 ||p - B g||^2 + mu/2 ||g||^2 subject to |g_n| <= limit, by semismooth Newton on the dual.

    mu: regularisation, relative to trace(B B^H) / M. steps: Newton steps for one choice of phases,
    before gradient steps on the primal bring it near and as many more are tried.
    rounds: how often free phases are chosen anew where the limit keeps targets from being met.

    Where no limit is reached it is the regularised pseudo-inverse, without a Newton step. More samples
    than transducers: reduced to N equations by a QR decomposition first. `scale="max"`: the largest
    multiple whose proportions are kept within 0.1 %, found by bisection to 1 %.
    """

    name: ClassVar[str] = "lagrange"

    mu: float = 1e-6
    steps: int = 10
    rounds: int = 20

    def __post_init__(self) -> None:
        object.__setattr__(self, "mu", number("mu", self.mu, low=0.0, high=1.0, above=True))
        object.__setattr__(self, "steps", integer("steps", self.steps, low=1))
        object.__setattr__(self, "rounds", integer("rounds", self.rounds, low=1))

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
        mu = self.mu * propagator.power
        if not mu:
            return pc.Result(note="no transducer reaches the points")
        M, N = propagator.B.shape
        if M <= N and (targets.scale == "exact" or targets.all_free):
            return self._polished(propagator, targets, limits, warm, budget, out, mu)
        p = choose(propagator, targets, None if warm is None else warm.phases)
        problem = Problem.of(propagator, mu)
        unit = limits.gain or problem.peak(p)  # one unit of h [gain]
        run = Run(self, problem, targets, budget)
        if targets.scale == "max":
            end = run.strongest(p / unit, propagator)
        else:
            end = run.nearest(p / unit, None if warm is None else warm.sound_pressure / unit)
        out[:] = end.point.h * unit
        held = float((np.abs(end.point.h) > AT_LIMIT).mean())
        return pc.Result(
            iterations=end.steps,
            limited=held > 0.0 and limits.gain is not None,
            late=end.late,
            bound=unit**2 * (end.point.value + end.lost),
            objective=unit**2 * (problem.dual.primal(end.point, problem.down(end.p)) + end.lost),
            mu=mu,
            note=f"{held:.0%} of the transducers at their limit" if held else "",
        )

    def _polished(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, budget: pc.Budget, out: pc.Gains, mu: float,
    ) -> pc.Result:  # fmt: skip
        """Write the gains where there is no limit but that of the gains."""
        M, N = len(targets.amplitudes), len(out)
        room = take(Room.of, M, N)
        p, start = room.p, None if warm is None else warm.phases
        norm = choose_into(propagator, targets, start, p, room.free)
        y = propagator.factor(mu).solve(p)
        unit = limits.gain or 2.0 * float(np.abs(propagator.adjoint(y)).max())
        size, root = norm / unit, math.sqrt(mu / self.mu)
        # up to the first nothing reaches its limit, and beyond the second the answer hardly changes
        within = min(max(size, math.sqrt(self.mu) * root), 1e3 * N * root)
        share = within / size
        y *= mu * share / unit
        p *= share / unit
        polish = Polish(propagator.single, propagator.gram, p, room.free, mu, room, budget)
        strongest = targets.scale == "max" and room.free.all()
        end = polish.strongest(y) if strongest else polish.run(y)
        bound, objective, scale = end.bound, end.objective, unit / max(share, 1.0)
        if out.dtype == np.complex64:
            deliver(room.h, scale, out)
        else:
            fine = polish.refined(propagator.B)
            out[:] = scale * fine.h
            bound, objective = fine.bound, fine.objective
        proven = (unit / share) ** 2 if share >= 1.0 else math.nan
        result = pc.Result(
            iterations=end.steps,
            limited=end.held > 0 and limits.gain is not None,
            late=end.late,
            bound=bound * proven,
            objective=objective * proven,
            multipliers=room.y * (unit / share),
            mu=mu,
            note=f"{end.held / N:.0%} of the transducers at their limit" if end.held else "",
        )
        give(Room.of, M, N, room)
        return result


@dataclass(frozen=True, eq=False)
class Problem:
    """The dual in at most N equations: of B itself, or of R where B = Q R has more rows than columns."""

    B: Complexes
    Q: Complexes | None
    dual: Dual

    @classmethod
    def of(cls, propagator: pc.Propagator, mu: float) -> Problem:
        """The problem for where the points are now."""
        B = propagator.B
        if len(B) <= B.shape[1]:
            return cls(B, None, Dual(B, propagator.gram, propagator.factor(mu), mu))
        Q, R = cast(
            "tuple[Complexes, Complexes]", linalg.qr(B.astype(np.complex128), mode="economic")
        )
        G = gram(R)
        return cls(B, Q, Dual(R, G, Factor.of(G, mu), mu))

    def down(self, p: Complexes) -> Complexes:
        """Targets (M,) in the dual's equations."""
        return p if self.Q is None else self.Q.conj().T @ p

    def whole(self, point: Point) -> Complexes:
        """The sound pressures that a point makes, (M,) [Pa]."""
        return point.made if self.Q is None else (self.B @ point.h).astype(np.complex128)

    def peak(self, p: Complexes) -> float:
        """The largest gain if there is no limit, with a margin."""
        y = self.dual.unlimited(self.down(p))
        return (
            1.1
            * float(np.abs(self.dual.B.conj().T @ y.astype(self.dual.B.dtype)).max())
            / self.dual.mu
        )


class End(NamedTuple):
    """Where a run ended, in units of the limit."""

    point: Point
    p: Complexes  # (M,) the targets with the phases found
    made: Complexes  # (M,)
    error: float  # ||p - made|| / ||p||
    lost: float  # 1/2 of the squared error that no gains can mend
    steps: int
    late: bool


@dataclass(frozen=True, eq=False)
class Run:
    """One call of the solver, in units of the limit."""

    settings: Lagrange
    problem: Problem
    targets: pc.Targets
    budget: pc.Budget

    def nearest(self, p: Complexes, made: Complexes | None = None) -> End:
        """The gains nearest to the targets p; free phases are chosen anew while that helps.

        made: what was made of similar targets before, (M,), to start from.
        """
        free, steps = self.targets.free, 0
        best: End | None = None
        for _ in range(self.settings.rounds):
            end = self._once(p, made)
            steps += end.steps
            improved = best is None or end.error < (1.0 - GAIN) * best.error
            if best is None or end.error < best.error:
                best = end
            if not improved or end.late or end.error <= MET or not free.any():
                break
            made = end.made
            p = np.where(free, np.abs(p) * np.exp(1j * np.angle(made)), p)
        assert best is not None  # rounds >= 1
        return best._replace(steps=steps)

    def _once(self, p: Complexes, before: Complexes | None) -> End:
        """The gains nearest to p, its phases as given; p - before is a multiplier to start from."""
        dual, q = self.problem.dual, self.problem.down(p)
        start = dual.at(dual.unlimited(q), q)
        if before is not None and (start.size > dual.mu).any():
            warm = dual.at(self.problem.down(p - before), q)
            start = warm if warm.value > start.value else start
        climb = dual.top(start, q, self.settings.steps, self.budget)
        point = climb.point
        made = self.problem.whole(point)
        error = self._error(p, made)
        lost = (
            0.0 if self.problem.Q is None else float(np.vdot(p, p).real - np.vdot(q, q).real) / 2.0
        )
        return End(point, p, made, error, lost, climb.steps, climb.late)

    def _error(self, p: Complexes, made: Complexes) -> float:
        """||p - made|| / ||p||, free phases being as made."""
        if self.targets.all_free:
            rest = np.abs(p) - np.abs(made)
        else:
            rest = np.where(self.targets.free, np.abs(p) - np.abs(made), np.abs(p - made))
        return float(np.linalg.norm(rest) / np.linalg.norm(p))

    def strongest(self, p: Complexes, propagator: pc.Propagator) -> End:
        """The gains for the largest multiple of p whose proportions are kept."""
        t, asked = np.abs(p), np.abs(p) > 0.0
        weak = 1.0 / self.problem.peak(p)  # at this multiple nothing reaches the limit
        alone = (
            np.abs(propagator.B[asked]).sum(axis=1) / t[asked]
        )  # at this one a single focus does
        strong = max(weak, float(alone.min()))
        best = self._once(weak * p, None)
        steps = best.steps
        while strong > 1.01 * weak and not (best.late or self.budget.spent):
            middle = float(np.sqrt(weak * strong))
            end = self.nearest(middle * p)
            steps += end.steps
            if end.error <= IN_PROPORTION:
                weak, best, p = middle, end, end.p / middle
            else:
                strong = middle
        return best._replace(steps=steps)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [Lagrange]
