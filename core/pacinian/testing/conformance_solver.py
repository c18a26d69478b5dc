"""`check_solver`: checks that a solver fulfils the contract of `pacinian.Solver`."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import isnan
from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.acoustics.array import lattice
from pacinian.acoustics.propagation import Precision, matrix
from pacinian.plugins.solver import Result, Solver
from pacinian.session import AIR, Session
from pacinian.solving.budget import Budget
from pacinian.solving.limits import Limits
from pacinian.solving.propagator import Propagator
from pacinian.solving.region_phases import joint_phases
from pacinian.solving.solution_status import REGION_TOLERANCE, Status
from pacinian.testing.conformance import (
    call_with_limit,
    check_class,
    check_rules,
    require,
    require_kind,
)
from pacinian.testing.problems import (
    ConformanceProblem,
    make_problems,
    make_random_points,
    make_regions,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.solving.solution import Solution
    from pacinian.types import Complexes, Floats, Gains

LIMIT = 120.0  # duration of a call [s]
SINGLE = 1e-4  # error from single precision, relative to the strongest pressure
MAX_VIOLATION = 2e-3  # relative violation of a limit
# least |sum p exp(-j phi)| / sum |p| of a region whose phases are those of one wave
MIN_COHERENCE = 0.99
ASIDE = np.array([4e-4, 0.0, 0.0])  # motion of a hand in a tick [m]
MAX_BOUND_ERROR = 1e-3  # relative error of a bound


def check_solver(
    make: Callable[[], Solver], array: Array | None = None, *, limit: float = LIMIT
) -> None:
    """Check a solver against every rule of its interface, on small problems and in double precision.

    make: constructs the solver, as users do. array: array of at least 10 x 10 cm that faces +z; by default 100 ideal
    transducers. limit: time limit of each call [s]. Raises NotConforming, which lists the broken rules. To measure the
    quality of the answers, also on harder problems, use `pacinian stress --solvers NAME`.
    """
    kit = _Kit(make, array or lattice(0.09, 0.09), limit)
    check_rules(
        getattr(call_with_limit("make()", make, limit), "name", "a solver"),
        {
            "class": kit.its_class,
            "finite": kit.finite,
            "gain limit": kit.gain_limit,
            "deterministic": kit.deterministic,
            "holds nothing": kit.holds_nothing,
            "leaves its input alone": kit.leaves_input,
            "budget": kit.budget,
            "double precision": kit.double,
            "true pressures": kit.true_pressures,
            "bound": kit.bound,
            "linear": kit.linear,
            "quiet": kit.quiet,
            "exact": kit.exact,
            "regions": kit.regions,
        },
    )


class _Kit:
    """The trial of a solver."""

    def __init__(self, make: Callable[[], Solver], array: Array, limit: float) -> None:
        self.array, self._make, self._limit = array, make, limit

    # ------------------------------------------------------------------ building blocks of the rules

    def make(self) -> Solver:
        """Construct a new solver."""
        return call_with_limit("make()", self._make, self._limit)

    def problem(
        self, count: int, level: float, *, seed: int = 0, fixed: bool = False
    ) -> ConformanceProblem:
        """Make an ordinary problem for the kit's array."""
        return make_random_points(self.array, count, level, seed, fixed)

    def problems(self) -> list[tuple[str, ConformanceProblem]]:
        """Make all test problems."""
        return make_problems(self.array)

    def reference(self, q: Floats) -> Complexes:
        """Return B in double precision."""
        return matrix(self.array, q, AIR)

    def solve(
        self,
        solver: Solver,
        problem: ConformanceProblem,
        propagator: Propagator | None = None,
        warm: Solution | None = None,
        budget: Budget | None = None,
        precision: Precision = "single",
    ) -> tuple[Complexes, Result]:
        """Call the solver directly. Return its gains, (N,), and its result."""
        propagator = propagator or self.propagator(problem, precision)
        out = np.zeros(len(self.array), propagator.dtype)
        targets, limits, time, gains = (
            problem.targets, problem.limits, budget or Budget(), cast("Gains", out),
        )  # fmt: skip
        result = call_with_limit(
            "solve()",
            lambda: solver.solve(propagator, targets, limits, warm, time, gains),
            self._limit,
        )
        require_kind(Result, result, "what solve() returns")
        return out, result

    def propagator(
        self, problem: ConformanceProblem, precision: Precision = "single"
    ) -> Propagator:
        """Return a propagator to the points of a problem."""
        made = Propagator(self.array, AIR, precision)
        made.set_points(problem.q)
        return made

    def session(self, problem: ConformanceProblem) -> Solution:
        """Solve through a session, as users do."""
        session = Session(self.array, solver=self.make())
        return call_with_limit(
            "Session.solve()",
            lambda: session.solve(
                problem.q,
                problem.t,
                problem.phases,
                limits=problem.limits,
                regions=problem.regions,
            ),
            self._limit,
        )

    # ------------------------------------------------------------------ the rules

    def its_class(self) -> None:
        """It is a solver with a name and a docstring."""
        solver = self.make()
        check_class(Solver, solver)
        unknown = set(solver.keeps) - {"quiet", "exact"}
        require(not unknown, f"`keeps` holds {unknown}, but a solver may keep only quiet and exact")

    def finite(self) -> None:
        """Gains are finite for every problem."""
        for name, problem in self.problems():
            g, _ = self.solve(self.make(), problem)
            require(bool(np.isfinite(g).all()), f"gains are not finite for {name}")

    def gain_limit(self) -> None:
        """Gains are within the limit if small gains suffice, or if the solver reports `limited`."""
        for name, problem in self.problems():
            g, result = self.solve(self.make(), problem)
            limit, most = problem.limits.gain or np.inf, float(np.abs(g).max())
            B = self.reference(problem.q)
            weak = len(problem.q) < 5 and float(problem.t.sum()) < 0.2 * np.abs(B).sum(axis=1).min()
            reason = (
                "although it says that they are `limited`" if result.limited else "for so little"
            )
            within = most <= limit * (1.0 + 1e-5) or not (weak or result.limited)
            require(within, f"gains reach {most:.3g} {reason}: {name}")

    def deterministic(self) -> None:
        """The same problem has the same answer, bit for bit, because recordings are rendered again."""
        for name, problem in self.problems()[:8]:
            first, second = (self.solve(self.make(), problem)[0] for _ in range(2))
            require(np.array_equal(first, second), f"answers differ for {name}")

    def holds_nothing(self) -> None:
        """Earlier problems do not matter, because one object serves all sessions."""
        solver, one, other = self.make(), self.problem(4, 0.5), self.problem(7, 0.9, seed=1)
        first, _ = self.solve(solver, one)
        self.solve(solver, other)
        again, _ = self.solve(solver, one)
        require(np.array_equal(first, again), "another problem in between changes the answer")

    def leaves_input(self) -> None:
        """It does not write to its inputs, which are shared."""
        problem = replace(self.problem(4, 0.5), limits=Limits(power=1e3))
        warm = self.session(problem)
        propagator, targets = self.propagator(problem), problem.targets
        shared = {
            "B": propagator.B,
            "the Gram matrix": propagator.gram,
            "the points": propagator.points,
            "targets.amplitudes": targets.amplitudes,
            "targets.phases": targets.phases,
            "warm.gains": warm.gains,
            "warm.sound_pressure": warm.sound_pressure,
        }
        before = {name: np.array(value) for name, value in shared.items()}
        version, out = propagator.version, np.zeros(len(self.array), np.complex64)
        solver = self.make()
        call_with_limit(
            "solve()",
            lambda: solver.solve(propagator, targets, problem.limits, warm, Budget(), out),
            self._limit,
        )
        for name, value in shared.items():
            same = np.array_equal(before[name], value, equal_nan=True)
            require(same, f"it writes to {name}")
        require(propagator.version == version, "it moves the propagator's points")

    def budget(self) -> None:
        """With no time left it returns its best gains so far, which are finite."""
        for name, problem in self.problems()[:8]:
            spent = Budget(due=0.0, clock=lambda: 1.0)
            g, _ = self.solve(self.make(), problem, budget=spent)
            require(bool(np.isfinite(g).all()), f"gains are not finite without time: {name}")

    def double(self) -> None:
        """It also works in double precision, with nearly the same result."""
        problem = self.problem(4, 0.1, fixed=True)
        single, _ = self.solve(self.make(), problem)
        double, _ = self.solve(self.make(), problem, precision="double")
        B = self.reference(problem.q)
        a, b = np.abs(B @ single), np.abs(B @ double)
        off = float(np.linalg.norm(a - b)) / max(float(np.linalg.norm(b)), 1e-30)
        require(off < 0.05, f"pressures differ by {off:.2%} between single and double precision")

    def true_pressures(self) -> None:
        """The pressures that a session reports are those of the gains, in double precision."""
        for name, problem in self.problems()[:8]:
            solution = self.session(problem)
            p = self.reference(problem.q) @ solution.gains.astype(np.complex128)
            scale = float(np.abs(self.reference(problem.q)).sum(axis=1).max())
            off = float(np.abs(p - solution.sound_pressure).max())
            require(
                off <= SINGLE * scale,
                f"reported pressures are {off / scale:.2g} of full drive off for {name}",
            )
            met = float(np.linalg.norm(np.abs(p) - problem.t)) / float(np.linalg.norm(problem.t))
            require(
                solution.status is not Status.ok or met <= MAX_VIOLATION,
                f"status ok, with an error of {met:.2%} for {name}",
            )

    def bound(self) -> None:
        """A reported bound is below the optimum, and has multipliers as its proof."""
        for fixed in (False, True):
            problem = self.problem(4, 0.1, fixed=fixed)
            g, result = self.solve(self.make(), problem)
            if isnan(result.bound):
                continue
            require(result.multipliers is not None and result.mu > 0.0, "a bound without proof")
            B = self.reference(problem.q)
            p = problem.targets.complex(np.angle(B @ g))
            M = len(p)
            H = B @ B.conj().T + result.mu * np.eye(M)
            best = 0.5 * result.mu * float(np.vdot(p, np.linalg.solve(H, p)).real)  # without limits
            scale = 0.5 * float(np.vdot(p, p).real)
            require(
                result.bound <= best * (1.0 + MAX_BOUND_ERROR) + 1e-6 * scale,
                f"the bound, {result.bound:.4g}, is above the optimum, {best:.4g}",
            )

    def linear(self) -> None:
        """If it is `linear`, targets twice as strong give pressures twice as strong."""
        solver, problem = self.make(), self.problem(4, 0.1, fixed=True)
        if solver.linear:
            g, _ = self.solve(solver, problem)
            twice, _ = self.solve(solver, replace(problem, t=2.0 * problem.t))
            B = self.reference(problem.q)
            off = float(np.linalg.norm(B @ (twice - 2.0 * g)) / np.linalg.norm(2.0 * problem.t))
            require(off < 2e-3, f"it is `linear`, but pressures are {off:.2%} off")

    def quiet(self) -> None:
        """If it keeps quiet points, they are quiet where that is possible."""
        if "quiet" not in self.make().keeps:
            return
        problem = self.problem(3, 0.2)
        B = self.reference(problem.q)
        angle = np.linspace(0.0, 2.0 * np.pi, 36)
        ring = problem.q.mean(axis=0) + 0.08 * np.c_[np.cos(angle), np.sin(angle), 0.0 * angle]
        made = np.abs(self.reference(ring) @ (np.linalg.pinv(B) @ problem.t))
        ears = ring[made.argmax()][None]  # where it is loud without the limit
        E, loud = self.reference(ears), 0.1 * float(made.max())
        g = np.linalg.pinv(np.vstack([B, E])) @ np.r_[problem.t, 0.0]
        require(float(np.abs(g).max()) < 0.9, "the array is too small for this check")
        solution = self.session(replace(problem, limits=Limits(quiet=(ears, loud))))
        heard = float(np.abs(E @ solution.gains.astype(np.complex128)).max())
        require(
            heard <= loud * (1.0 + MAX_VIOLATION) + SINGLE * float(np.abs(E).sum()),
            f"{heard:.3g} Pa at a quiet point of {loud:.3g} Pa (status {solution.status.name})",
        )
        require(bool(solution.gains.any()), "it keeps a point quiet by silence")

    def exact(self) -> None:
        """If it keeps exact samples, they are exact where that is possible."""
        if "exact" not in self.make().keeps:
            return
        problem = replace(self.problem(3, 0.2), limits=Limits(exact=[1]))
        solution = self.session(problem)
        p = np.abs(self.reference(problem.q) @ solution.gains.astype(np.complex128))
        off = abs(float(p[1]) / float(problem.t[1]) - 1.0)
        require(
            off <= MAX_VIOLATION,
            f"an exact sample is {off:.2%} off (status {solution.status.name})",
        )

    def regions(self) -> None:
        """If a region has status `ok`, its samples meet their targets, in the phases of the one wave that was given.

        The problems are solved one after another, each also with its points moved a little, to show that leftovers of
        the last problem do not matter.
        """
        session = Session(self.array, solver=self.make())
        for name, problem in make_regions(self.array):
            for q in (problem.q, problem.q + ASIDE):
                solve = partial(session.solve, q, problem.t, regions=problem.regions)
                solution = call_with_limit("Session.solve()", solve, self._limit)
                if solution.status is Status.ok:
                    p = self.reference(q) @ solution.gains.astype(np.complex128)
                    self._is_one_wave(name, replace(problem, q=q), p)

    def _is_one_wave(self, name: str, problem: ConformanceProblem, p: Complexes) -> None:
        """Require that pressures p, (M,) [Pa], meet the targets, each region in the phases of one wave."""
        t, number = problem.t, problem.regions
        assert number is not None
        off = float(np.linalg.norm((np.abs(p) - t)[t > 0.0])) / float(np.linalg.norm(t))
        require(
            off <= REGION_TOLERANCE + SINGLE, f"status ok, with an error of {off:.1%} for {name}"
        )
        for own in (number == one for one in range(int(number.max()) + 1)):
            wave = joint_phases(self.array, problem.q[own], AIR, radiation_pressure=t[own] ** 2)
            alike = abs(complex(np.vdot(np.exp(1j * wave), p[own]))) / float(np.abs(p[own]).sum())
            require(
                alike > MIN_COHERENCE,
                f"the phases of a region are only {alike:.0%} alike, with status ok, for {name}",
            )
