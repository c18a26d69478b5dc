"""Newton steps under the gain limit alone. Phases, multipliers and gains are found together.

People feel amplitude, not phase. So p = t exp(j phi) with phi free, and at the optimum of the dual (see
`convex.dual`), y = r exp(j phi) with r real. The stages run in this order until the error is small enough:

1. The regularised pseudo-inverse, for phases from Gerchberg-Saxton: y = mu (G + mu I)^-1 p.
2. Newton steps on Re(conj(u_m) (B h(B^H y) + y)_m) = t_m, where u = p / |p| of the pressures made. These are
   M real equations, so each step solves an M x M real system (`solve_dual`). Two or three steps suffice
   while only some of the transducers are at their limit.
3. If stage 2 stalls: full drive. Weighted Gerchberg-Saxton steps find other phases that allow more pressure
   (`equalise`), and stage 2 runs again.
4. If the array cannot meet the targets: Newton steps on the gains, towards the nearest pressures
   (`solve_primal`).
5. If the caller allows the time: stages 3 and 4 from other phases.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native.solving import apply_planar
from pacinian.solving.linalg import lapack
from pacinian.solving.propagator import mean_square
from pacinian_plugins.native.lagrange import (
    certify,
    equalise,
    evaluate,
    solve_dual,
    solve_primal,
    write_gains,
)
from pacinian_plugins.solvers.lagrange.multistart import (
    CANDIDATES_PER_START,
    count_other_starts,
    make_start,
    rate_starts,
)
from pacinian_plugins.solvers.lagrange.newton_time import affords_newton_step
from pacinian_plugins.solvers.lagrange.reference import Refined, refine_certified, solve_newton

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Complexes, Floats, Gains, Singles
    from pacinian_plugins.native.lagrange import Workspace

STOP_RESIDUAL = 2e-6  # ||F|| / ||p|| to stop at: single precision
MAX_MET_ERROR = 1e-4  # relative error that always suffices
CONVERGED_ERROR = 1e-3  # relative error that suffices once the steps have converged
MAX_DUAL_STEPS = 16  # Newton steps on the multipliers, in stage 2
MAX_EQUALISE_STEPS = 24  # weighted Gerchberg-Saxton steps, in stage 3
MAX_PRIMAL_STEPS = 80  # Newton steps on the gains, in stage 4
ROUGH_SAVING = 3e-4  # least relative saving of a step in stage 4, when starts are compared
FINAL_SAVING = 1e-5  # the same, for the final steps
# relative error from which continuing with the current phases is not worthwhile
MAX_PHASE_ERROR = 0.2
SOFTENED_MU_FACTORS = 1e-1, 3e-2, 1e-2, 3e-3, 1e-3  # increased mu, relative to trace(G) / M
MAX_SOFTENED_STEPS = 3  # Newton steps with each increased mu
MAX_STAGE_3_4_WORK = 200_000_000  # M M N up to which stages 3 and 4 are tried: some seconds
# M M N up to which the nearest pressures are sought from two starting points.
MAX_TWO_START_WORK = 1_000_000
MAX_UNCHECKED_WORK = 5_000_000  # M M N of the steps between two checks of the clock
MAX_STRONGEST_STEPS = 80  # weighted steps in the search for the strongest solution
DRIVE_RESOLUTION = 0.004  # resolution of the fraction of full drive in that search
MIN_DRIVE_FRACTION = 0.5  # smallest fraction of full drive that the search tries
MAX_PROPORTION_ERROR = 5e-4  # relative error up to which proportions count as kept
MIN_MET_SCALE = 0.999  # multiple of the targets at full drive below which they cannot be met


class NewtonResult(NamedTuple):
    """Outcome of the steps. The gains are in `workspace.h`, in units of the limit."""

    error: float  # ||targets - made|| / ||p||, where free phases are those made
    steps: int
    late: bool
    saturated_count: int  # number of transducers at their limit
    bound: float  # [Pa^2] for unit limits
    objective: float
    drive_fraction: float = 0.0  # fraction of full drive that the strongest solution uses


class Candidate(NamedTuple):
    """Gains h, (3, N), that are kept while others are tried, and their error."""

    error: float
    h: Singles

    @classmethod
    def of(cls, error: float, workspace: Workspace) -> Candidate:
        """Copy the current gains."""
        return cls(error, workspace.h.copy())


@dataclass(eq=False)
class GainLimitedNewton:
    """One problem and its progress. workspace: has the targets, and the multipliers to start from.

    starts: number of additional starting phases to try if the given ones do not suffice. If the time runs out only
    while they are tried, the result is not late. late: whether a step was left out because it would have been too late.
    """

    B: Complexes
    G: Complexes
    mu: float
    workspace: Workspace
    budget: pc.Budget
    unit: float
    out: Gains
    starts: int = 0
    steps: int = 0
    late: bool = False

    def run(self) -> NewtonResult:
        """Write the gains that are nearest to the targets, starting from the multipliers in the workspace."""
        error, converged = self._take_dual_steps()
        missed = error > (CONVERGED_ERROR if converged else MAX_MET_ERROR)
        if not missed or self.budget.spent:
            return self._make_result(error, late=self.budget.spent or self.late)
        error = self._continue_after_stall(error)
        late = self.late or self.budget.spent
        if error > MAX_MET_ERROR and not late and self._other_starts:
            error = self._try_other_starts(error)
        self._certify_and_write()
        return self._make_result(error, late=late)

    def _certify_and_write(self) -> None:
        """Write the current gains, and the bound that the current multipliers prove."""
        certify(self.mu, self.workspace)
        write_gains(self.workspace.h, self.unit, self.out)

    def _make_result(self, error: float, *, late: bool) -> NewtonResult:
        """Return the current result with its bound and objective."""
        w = self.workspace
        return NewtonResult(error, self.steps, late, w.held, w.bound, w.objective)

    def solve_strongest(self) -> NewtonResult:
        """Write gains for the largest multiple of the targets, whose phases are all free.

        Full drive gives the best phases and an estimate of the multiple. A bisection over fractions of this
        estimate, with Newton steps for each, then finds the multiple.
        """
        w, p = self.workspace, self.workspace.p.copy()
        top = self._equalise_from_best_start()
        start, kept, missed, error = w.y.copy(), 0.0, 1.01, 1.0  # kept, missed: fractions
        best: NewtonResult | None = None
        y, h = start, w.h
        while top > 0.0 and missed - kept > DRIVE_RESOLUTION and not (best and self.budget.spent):
            fraction = (
                (kept + missed) / 2.0 if kept else missed - (1.01 - missed + DRIVE_RESOLUTION)
            )
            if fraction < MIN_DRIVE_FRACTION:
                break
            w.p[:], w.y[:] = (fraction * top) * p, start
            error, _ = self._take_dual_steps()
            if error > MAX_PROPORTION_ERROR:
                missed = fraction
                continue
            kept = fraction
            best = self._make_result(error, late=self.late)._replace(drive_fraction=fraction)
            y, h = w.y.copy(), w.h.copy()
        late = self.budget.spent or self.late
        if best is None:  # no fraction keeps the proportions: use the last attempt, or full drive
            self._certify_and_write()
            return self._make_result(error, late=late)
        w.h[:], w.y[:] = h, y
        write_gains(w.h, self.unit, self.out)
        return best._replace(steps=self.steps, late=late)

    def _equalise_from_best_start(self) -> float:
        """Drive fully from the phases, current or other, that give the weakest sample the most pressure.

        Returns the multiple of the targets that is nearest to the pressures made.
        """
        w, asked = self.workspace, np.abs(self.workspace.p)
        top = self._equalise(MAX_STRONGEST_STEPS)
        y, most = w.y.copy(), float((np.hypot(*w.made) / asked).min())

        def measure_weakest(start: Complexes) -> float:
            return float((self._measure_full_drive(start) / asked).min())

        rated = rate_starts(asked, self._other_starts, measure_weakest, self.budget)
        found, k = max(rated, default=(0.0, 0))
        if found <= most:
            w.y[:] = y
            return top
        w.y[:] = make_start(asked, k)
        return self._equalise(MAX_STRONGEST_STEPS)

    def _take_dual_steps(self, steps: int = MAX_DUAL_STEPS, mu: float = 0.0) -> tuple[float, bool]:
        """Take Newton steps on the multipliers; return the error and whether they converged.

        If there is a deadline, the steps are taken in small batches.
        """
        w, endless = self.workspace, self.budget.endless
        # without time for a step, only evaluate the current multipliers
        steps = steps if endless or self._affords_step() else 0
        chunk = steps if endless else max(1, min(steps, MAX_UNCHECKED_WORK // self._work))
        w.restart_dual()
        for _ in range(0, max(1, steps), chunk):
            taken = solve_dual(
                self.B,
                self.G,
                mu or self.mu,
                min(chunk, steps),
                STOP_RESIDUAL,
                w,
                self.unit,
                self.out,
            )
            self.steps += abs(taken)
            if taken >= 0 or w.stalled > 1 or self.budget.spent:
                return w.error, taken >= 0
        return w.error, False

    @property
    def _work(self) -> int:
        """M M N, which a Newton step takes time in proportion to."""
        return len(self.B) * self.B.size

    def _affords_step(self) -> bool:
        """Return whether a Newton step would finish in time; if not, mark the result as late."""
        fits = affords_newton_step(self.budget, self._work)
        self.late |= not fits
        return fits

    def _continue_after_stall(self, error: float) -> float:
        """Continue after Newton steps have stalled at `error`; keep the best gains, with their residual as y."""
        w = self.workspace
        first = second = Candidate.of(error, w)
        if w.free.all():
            # the array cannot resolve the samples
            if error > MAX_PHASE_ERROR or self._work > MAX_STAGE_3_4_WORK:
                first = self._solve_softened(first)
            if not self.budget.spent:
                error = self._restart_from_full_drive()
                if error <= MAX_MET_ERROR:
                    return error
                second = Candidate.of(error, w)
        if first.error != second.error and self._work <= MAX_TWO_START_WORK:
            first, second = self._probe(first), self._probe(second)
        best = first if first.error <= second.error else second
        w.h[:] = best.h
        error = best.error
        if self._work <= MAX_STAGE_3_4_WORK:
            error = self._take_primal_steps(FINAL_SAVING)
        self._set_residual()
        return error

    def _probe(self, start: Candidate) -> Candidate:
        """Take rough steps on the gains from those of `start`."""
        self.workspace.h[:] = start.h
        return Candidate.of(self._take_primal_steps(ROUGH_SAVING), self.workspace)

    @property
    def _other_starts(self) -> int:
        """Number of additional starts: 0 for many samples or fixed phases."""
        return count_other_starts(self.starts, self.workspace.free)

    def _try_other_starts(self, error: float) -> float:
        """Try other starting phases; keep the best gains and return their error. error: of the current gains.

        Each start is probed at full drive. Only those nearest to the targets are continued.
        """
        w, best = self.workspace, Candidate.of(error, self.workspace)
        asked = np.abs(w.p)

        def measure_miss(start: Complexes) -> float:
            return float(np.linalg.norm(self._measure_full_drive(start) - asked))

        count = CANDIDATES_PER_START * self._other_starts
        rated = sorted(rate_starts(asked, count, measure_miss, self.budget))
        for _, k in rated[: self.starts]:
            if self.budget.spent or best.error <= MAX_MET_ERROR:
                break
            w.y[:] = make_start(asked, k)
            self._equalise(MAX_EQUALISE_STEPS)
            found = self._take_primal_steps(ROUGH_SAVING)
            if found < best.error:
                best = Candidate.of(found, w)
        w.h[:] = best.h
        reached = self._take_primal_steps(FINAL_SAVING) if best.error < error else best.error
        self._set_residual()
        return reached

    def _measure_full_drive(self, start: Complexes) -> Floats:
        """Return the pressure amplitudes, (M,), that full drive makes from the phases of `start`, (M,)."""
        self.workspace.y[:] = start
        self._take_equalising_steps(MAX_EQUALISE_STEPS)
        return np.asarray(np.hypot(*self.workspace.made))

    def _solve_softened(self, best: Candidate) -> Candidate:
        """Take Newton steps with increased regularisation, and reduce it while the error falls; return the best gains.

        best: the current gains.
        """
        if not self._affords_step():
            return best
        w, G, last = self.workspace, self.G, 1.0
        power = mean_square(G)
        diagonal = np.arange(len(G))
        for softness in SOFTENED_MU_FACTORS:
            soft = softness * power
            if softness == SOFTENED_MU_FACTORS[0]:
                shifted = np.array(G)
                shifted[diagonal, diagonal] += soft
                _, y, singular = lapack.zposv(shifted, w.p)
                if singular:
                    raise np.linalg.LinAlgError("the Gram matrix is not positive definite")
                w.y[:] = soft * y.reshape(-1)
            else:
                w.y[:] *= soft / last
            last = soft
            error, _ = self._take_dual_steps(MAX_SOFTENED_STEPS, soft)
            if error < best.error:
                best = Candidate.of(error, w)
            elif softness != SOFTENED_MU_FACTORS[0] or self.budget.spent:
                break
        return best

    def _restart_from_full_drive(self) -> float:
        """Restart the Newton steps from the phases of full drive; return the error."""
        if self._equalise(MAX_EQUALISE_STEPS) < MIN_MET_SCALE:
            self.workspace.y[:] *= 10.0  # hold more transducers at the limit
        return self._take_dual_steps()[0]

    def _equalise(self, steps: int) -> float:
        """Take steps of `equalise`, then scale the multipliers so that half of the transducers are at their limit.

        Returns the multiple of the targets that is nearest to what full drive makes.
        """
        w = self.workspace
        self._take_equalising_steps(steps)
        reached = w.h[2][w.h[2] > 0.0]
        w.y[:] *= self.mu / (float(np.median(reached)) if len(reached) else 1.0)
        return w.multiple

    def _take_equalising_steps(self, steps: int) -> None:
        """Take steps of `equalise`, in small batches if there is a deadline."""
        w = self.workspace
        chunk = (
            steps
            if self.budget.endless
            else max(1, min(steps, MAX_UNCHECKED_WORK // (8 * self.B.size)))
        )
        for _ in range(0, steps, chunk):
            taken = equalise(self.B, chunk, w)
            self.steps += abs(taken)
            if taken >= 0 or self.budget.spent:
                break

    def _take_primal_steps(self, finished: float) -> float:
        """Take Newton steps on the gains, from the current ones; return the error."""
        w = self.workspace
        w.restart_primal()
        apply_planar(self.B, w.h, w.made, w.tile)
        most = MAX_PRIMAL_STEPS if self._affords_step() else 0
        chunk = (
            MAX_PRIMAL_STEPS
            if self.budget.endless
            else max(1, MAX_UNCHECKED_WORK // (8 * self._work))
        )
        for _ in range(0, max(1, most), chunk):
            steps = solve_primal(self.B, self.mu, min(chunk, most), STOP_RESIDUAL, finished, w)
            self.steps += abs(steps)
            if steps >= 0 or self.budget.spent:
                break
        return w.error

    def _set_residual(self) -> None:
        """Set the multipliers to the residual of the gains, which proves optimality at the nearest pressures."""
        w = self.workspace
        apply_planar(self.B, w.h, w.made, w.tile)
        q = w.made[0] + 1j * w.made[1]
        # a pressure of 0 has no phase: the target keeps its own, as in `certify`
        turned = w.free & (q != 0.0)
        w.y[:] = np.where(turned, np.abs(w.p) * np.exp(1j * np.angle(q)), w.p) - q
        y = np.zeros((2, w.tile.shape[1]), np.float32)
        y[:, : len(q)] = w.y.real, w.y.imag
        h, made = np.empty_like(w.h), np.empty_like(w.made)  # only the cost is needed
        w.cost = evaluate(self.B, y, self.mu, h, made, w.tile)

    def refine(self, B: Complexes) -> Refined:
        """Return the solution in double precision, for B in double precision; its multipliers are in the workspace."""
        w = self.workspace
        h = w.h[0].astype(np.complex128) + 1j * w.h[1]
        rough = refine_certified(B, w.p, w.free, self.mu, w.y, h / np.maximum(np.abs(h), 1.0))
        fine = solve_newton(B, self.G, w.p, w.free, self.mu, w.y, MAX_DUAL_STEPS, self.budget)
        best = fine if fine.objective < rough.objective else rough
        w.y[:] = best.y
        return best
