"""Meets the targets under the gain limit alone. Phases, multipliers and gains are found together.

People feel amplitude, not phase. So p = t exp(j phi) with phi free, and at the optimum of the dual (see
`convex.dual`), y = r exp(j phi) with r real. The stages run in this order until the error is small enough:

1. The regularised pseudo-inverse, for phases from Gerchberg-Saxton: y = mu (G + mu I)^-1 p.
2. Newton steps on Re(conj(u_m) (B h(B^H y) + y)_m) = t_m, where u = p / |p| of the pressures made. These are
   M real equations, so each step solves an M x M real system (`descend`). Two or three steps suffice while
   only some of the transducers are at their limit.
3. If stage 2 stalls: full drive. Weighted Gerchberg-Saxton steps find other phases that allow more pressure
   (`equalise`), and stage 2 runs again.
4. If the array cannot meet the targets: Newton steps on the gains, towards the nearest pressures (`nearest`).
5. If the caller allows the time: stages 3 and 4 from other phases.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native.solving import gather
from pacinian.solving.linalg import lapack
from pacinian_plugins.native.lagrange import (
    attempt,
    certify,
    deliver,
    equalise,
    evaluate,
    nearest,
)
from pacinian_plugins.solvers.lagrange.reference import Refined, refine_certified, solve_newton
from pacinian_plugins.solvers.lagrange.workspace import in_time

if TYPE_CHECKING:
    from collections.abc import Callable

    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats, Gains
    from pacinian_plugins.solvers.lagrange.workspace import Workspace

FRESH = np.array([np.inf, -1.0])  # `found[3:5]` before the first step
STOP_RESIDUAL = 2e-6  # ||F|| / ||p|| to stop at: single precision
MET = 1e-4  # relative error that always suffices
NEARLY = 1e-3  # relative error that suffices once the steps have converged
STEPS, EQUAL, LAST = 16, 24, 80  # maximum number of steps in stages 2, 3 and 4
ROUGH, FINISHED = 3e-4, 1e-5  # least relative saving of a step in stage 4: when probing, at the end
# samples up to which other starts are tried; full-drive probes for each; their phase increment [turns]
FEW_SAMPLES, LOOKS, GOLDEN = 16, 3, 0.6180339887
MAX_PHASE_ERROR = (
    0.2  # relative error from which continuing with the current phases is not worthwhile
)
# regularisation relative to trace(G) / M, in descending order; Newton steps with each
SOFT, STEPS_EACH = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3), 3
LARGE = 200_000_000  # M M N up to which stages 3 and 4 are tried: some seconds
TWICE = 1_000_000  # M M N up to which the nearest pressures are sought from two starting points
QUICK = 5_000_000  # M M N of the steps between two checks of the clock
# search for the strongest: steps of `equalise`; resolution and least share of full drive
MOST_EQUAL, SCALE_RESOLUTION, MIN_SCALE = 80, 0.004, 0.5
IN_PROPORTION = 5e-4  # relative error up to which proportions count as kept
BEYOND = 0.999  # multiple of the targets at full drive below which they cannot be met


class PhaseFreeResult(NamedTuple):
    """Outcome of the steps. The gains are in `room.h`, in units of the limit."""

    error: float  # ||targets - made|| / ||p||, where free phases are those made
    steps: int
    late: bool
    held: int  # transducers at their limit
    bound: float  # [Pa^2] for unit limits
    objective: float
    share: float = 0.0  # share of full drive that the strongest solution uses


@dataclass(eq=False)
class PhaseFreeSolve:
    """State of one problem: targets p, (M,) [Pa per unit limit], where their phase is free, and the progress.

    starts: additional starting phases to try if the given ones do not suffice. late: whether the time ran out before
    the first start had finished; additional starts do not count.
    """

    B: Complexes
    G: Complexes
    p: Complexes
    free: Flags
    mu: float
    room: Workspace
    budget: pc.Budget
    unit: float
    out: Gains
    starts: int = 0
    steps: int = 0
    late: bool = False

    def run(self) -> PhaseFreeResult:
        """Write the gains, starting from the multipliers in `room.y`."""
        error, converged = self._newton()
        if error > (NEARLY if converged else MET) and not self.budget.spent:
            error = self._harder(error)
            late = self.late or self.budget.spent
            if error > MET and not late and self._others:
                error = self._elsewhere(error)
            self._prove()
            self.late = late
        else:
            self.late |= self.budget.spent
        return self._make_result(error)

    def _prove(self) -> None:
        """Write the current gains, and the bound that the current multipliers prove."""
        room = self.room
        certify(self.p, self.free, self.mu, room.y, room.h, room.made, room.found[1], room.found)
        deliver(room.h, self.unit, self.out)

    def _make_result(self, error: float) -> PhaseFreeResult:
        """Return the current result with its bound and objective."""
        bound, objective, held = self.room.found[5:].tolist()
        return PhaseFreeResult(error, self.steps, self.late, int(held), bound, objective)

    def strongest(self) -> PhaseFreeResult:
        """Write gains for the largest multiple of the targets, whose phases are all free.

        Full drive gives the best phases and an estimate of the multiple. A bisection over shares of this estimate,
        with Newton steps for each, then finds the multiple.
        """
        room, p = self.room, self.p.copy()
        top = self._full()
        start, weak, strong, error = room.y.copy(), 0.0, 1.01, 1.0
        best: PhaseFreeResult | None = None
        y = start
        while top > 0.0 and strong - weak > SCALE_RESOLUTION and not (best and self.budget.spent):
            share = (weak + strong) / 2.0 if weak else strong - (1.01 - strong + SCALE_RESOLUTION)
            if share < MIN_SCALE:
                break
            self.p[:], room.y[:] = (share * top) * p, start
            error, _ = self._newton()
            if error > IN_PROPORTION:
                strong = share
                continue
            weak, best, y = share, self._make_result(error)._replace(share=share), room.y.copy()
            np.copyto(room.spare, room.h)
        self.late |= self.budget.spent
        if best is None:  # no share keeps the proportions: use the last attempt, or full drive
            self._prove()
            return self._make_result(error)
        np.copyto(room.h, room.spare)
        deliver(room.h, self.unit, self.out)
        room.y[:] = y
        return best._replace(steps=self.steps, late=self.late)

    def _full(self) -> float:
        """Drive fully from the phases, current or other, that give the weakest sample the most pressure.

        Returns the multiple of the targets that is nearest to the pressures made.
        """
        room, size = self.room, np.abs(self.p)
        top = self._equalise(MOST_EQUAL)
        y, most = room.y.copy(), float((np.hypot(*room.made) / size).min())
        looks = self._looks(lambda made: float((made / size).min()), self._others)
        found, k = max(looks, default=(0.0, 0))
        if found <= most:
            room.y[:] = y
            return top
        room.y[:] = self._phases(k)
        return self._equalise(MOST_EQUAL)

    def _newton(self, steps: int = STEPS, mu: float = 0.0) -> tuple[float, bool]:
        """Take Newton steps, in small batches if there is a deadline; return the error and whether they converged."""
        room, endless = self.room, self.budget.endless
        # without time for a step, only evaluate the current multipliers
        steps = steps if endless or self._affords() else 0
        chunk = steps if endless else max(1, min(steps, QUICK // (len(self.p) * self.B.size)))
        room.found[3:5] = FRESH
        for _ in range(0, max(1, steps), chunk):
            taken = attempt(
                self.B, self.G, self.p, self.free, mu or self.mu, min(chunk, steps), STOP_RESIDUAL, room.y, room.h,
                room.made, room.A, room.tile, room.V, room.which, room.found, self.unit, self.out,
            )  # fmt: skip
            self.steps += abs(taken)
            if taken >= 0 or room.found[4] > 1.0 or self.budget.spent:
                return float(room.found[0]), taken >= 0
        return float(room.found[0]), False

    def _affords(self) -> bool:
        """Return whether a Newton step would finish in time; if not, mark the result as late."""
        fits = in_time(self.budget, len(self.p) * self.B.size)
        self.late |= not fits
        return fits

    def _harder(self, error: float) -> float:
        """Continue after Newton steps have stalled at `error`; keep the best gains, with their residual as y."""
        room, work = self.room, len(self.p) * self.B.size
        np.copyto(room.spare, room.h)
        first = second = error
        np.copyto(room.other, room.h)
        if self.free.all():
            if error > MAX_PHASE_ERROR or work > LARGE:  # the array cannot resolve the samples
                first = self._solve_softened(error)
            if not self.budget.spent:
                second = self._full_drive()
                if second <= MET:
                    return second
                np.copyto(room.other, room.h)
        if first != second and work <= TWICE:  # probe both starting points
            np.copyto(room.h, room.spare)
            first = self._nearest(ROUGH)
            np.copyto(room.spare, room.h)
            np.copyto(room.h, room.other)
            second = self._nearest(ROUGH)
            np.copyto(room.other, room.h)
        np.copyto(room.h, room.spare if first <= second else room.other)
        error = self._nearest(FINISHED) if work <= LARGE else min(first, second)
        self._residual()
        return error

    @property
    def _others(self) -> int:
        """Number of additional starts: 0 for many samples or fixed phases."""
        M = len(self.p)
        return min(self.starts, 2 * M) if M <= FEW_SAMPLES and self.free.all() else 0

    def _elsewhere(self, error: float) -> float:
        """Try other starting phases; keep the best gains and return their error. error: of the current gains.

        Each start is probed at full drive. Only those nearest to the targets are continued.
        """
        room, best = self.room, error
        np.copyto(room.spare, room.h)
        asked = np.abs(self.p)
        looks = sorted(
            self._looks(lambda made: float(np.linalg.norm(made - asked)), LOOKS * self._others)
        )
        for _, k in looks[: self.starts]:
            if self.budget.spent or best <= MET:
                break
            room.y[:] = self._phases(k)
            self._equalise(EQUAL)
            found = self._nearest(ROUGH)
            if found < best:
                best = found
                np.copyto(room.spare, room.h)
        np.copyto(room.h, room.spare)
        if best < error:
            best = self._nearest(FINISHED)
        self._residual()
        return best

    def _looks(self, worth: Callable[[Floats], float], count: int) -> list[tuple[float, int]]:
        """Rate what full drive makes from each of `count` other phases; return (worth, number of the phases)."""
        looks = list[tuple[float, int]]()
        for k in range(count):
            if self.budget.spent:
                break
            self.room.y[:] = self._phases(k)
            self._equalise(EQUAL)
            looks.append((worth(np.hypot(self.room.made[0], self.room.made[1])), k))
        return looks

    def _phases(self, k: int) -> Complexes:
        """Return the targets, (M,), with the k-th set of phases. The sets differ widely; 0 is that of `weighted-gs`."""
        m = np.arange(len(self.p))
        turns = GOLDEN * k * m * (m + k) if k else 0.5 * m * m / len(m)
        return np.asarray(np.abs(self.p) * np.exp(2j * np.pi * turns), np.complex128)

    def _solve_softened(self, error: float) -> float:
        """Take Newton steps with increased regularisation, and reduce it while the error falls; return the least error.

        The best gains so far are in `room.spare`. error: theirs on entry.
        """
        if not self._affords():
            return error
        room, G, last = self.room, self.G, 1.0
        power = float(np.trace(G).real) / len(G)
        diagonal = np.arange(len(G))
        for share in SOFT:
            soft = share * power
            if share == SOFT[0]:
                shifted = np.array(G)
                shifted[diagonal, diagonal] += soft
                _, y, singular = lapack.zposv(shifted, self.p)
                if singular:
                    raise np.linalg.LinAlgError("the Gram matrix is not positive definite")
                room.y[:] = soft * y.reshape(-1)
            else:
                room.y[:] *= soft / last
            last = soft
            found, _ = self._newton(STEPS_EACH, soft)
            if found < error:
                error = found
                np.copyto(room.spare, room.h)
            elif share != SOFT[0] or self.budget.spent:
                break
        return error

    def _full_drive(self) -> float:
        """Restart the Newton steps from the phases of full drive; return the error."""
        if self._equalise(EQUAL) < BEYOND:
            self.room.y[:] *= 10.0  # hold more transducers at the limit
        return self._newton()[0]

    def _equalise(self, steps: int) -> float:
        """Take steps of `equalise`, then scale the multipliers so that half of the transducers are at their limit.

        Returns the multiple of the targets that is nearest to what full drive makes.
        """
        room = self.room
        chunk = steps if self.budget.endless else max(1, min(steps, QUICK // (8 * self.B.size)))
        for _ in range(0, steps, chunk):
            taken = equalise(
                self.B, self.p, chunk, room.y, room.h, room.made, room.tile, room.found
            )
            self.steps += abs(taken)
            if taken >= 0 or self.budget.spent:
                break
        multiple = float(room.found[0])
        reached = room.h[2][room.h[2] > 0.0]
        room.y[:] *= self.mu / (float(np.median(reached)) if len(reached) else 1.0)
        return multiple

    def _nearest(self, finished: float) -> float:
        """Take steps of `nearest` from the current gains; return the error."""
        room = self.room
        room.found[1], room.found[4] = 0.0, 0.0
        gather(self.B, room.h, room.made, room.tile)
        most = LAST if self._affords() else 0
        chunk = LAST if self.budget.endless else max(1, QUICK // (8 * len(self.p) * self.B.size))
        for _ in range(0, max(1, most), chunk):
            steps = nearest(
                self.B, self.p, self.free, self.mu, min(chunk, most), STOP_RESIDUAL,
                room.h, room.made, room.A, room.tile, room.V, room.W, room.held, room.found,
                finished,
            )  # fmt: skip
            self.steps += abs(steps)
            if steps >= 0 or self.budget.spent:
                break
        return float(room.found[0])

    def _residual(self) -> None:
        """Set the multipliers to the residual of the gains, which proves optimality at the nearest pressures."""
        room = self.room
        gather(self.B, room.h, room.made, room.tile)
        q = room.made[0] + 1j * room.made[1]
        t = np.where(self.free, np.abs(self.p) * np.exp(1j * np.angle(q)), self.p)
        room.y[:] = t - q
        y = np.zeros((2, room.tile.shape[1]), np.float32)
        y[:, : len(q)] = room.y.real, room.y.imag
        spent = np.empty_like(room.made)
        room.found[1] = evaluate(self.B, y, self.mu, room.other, spent, room.tile)

    def refine(self, B: Complexes) -> Refined:
        """Return the solution in double precision, for B in double precision; its multipliers are in `room.y`."""
        room = self.room
        h = room.h[0].astype(np.complex128) + 1j * room.h[1]
        rough = refine_certified(
            B, self.p, self.free, self.mu, room.y, h / np.maximum(np.abs(h), 1.0)
        )
        fine = solve_newton(B, self.G, self.p, self.free, self.mu, room.y, STEPS, self.budget)
        best = fine if fine.objective < rough.objective else rough
        room.y[:] = best.y
        return best
