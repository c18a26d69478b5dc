"""Solve for gains: `Session`, which the render loop uses, and the one-shot `solve`."""

from __future__ import annotations

import dataclasses
import math
import threading
import time
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.argument_checks import (
    check_kind,
    check_near,
    refuse_masked,
)
from pacinian.errors import ArgumentError, PluginError, UnsupportedLimit, shorten
from pacinian.plugins import registry
from pacinian.plugins.solver import Result, Solver
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.budget import Budget
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.corrections import MAX_CORRECTIONS, MAX_ERROR_RATIO, correct_amplitudes
from pacinian.solving.error_lower_bound import MAX_POINTS
from pacinian.solving.gain_evaluation import add_felt, certify
from pacinian.solving.limit_enforcement import enforce_limits, enforce_pressure_limits
from pacinian.solving.limits import Limits
from pacinian.solving.problem_check import check_problem
from pacinian.solving.propagator import Propagator
from pacinian.solving.quiet_subspace import Preparation, call_unrecorded
from pacinian.solving.region_phases import settle_phases
from pacinian.solving.solution import Solution
from pacinian.solving.solution_check import (
    compute_objective,
    measure_pressures,
    measure_violations,
    relative_error,
)
from pacinian.solving.solution_reuse import find_multiple, scale_solution
from pacinian.solving.solution_status import Status, determine_status
from pacinian.solving.warm_start import carry_over

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.propagation import Precision
    from pacinian.solving.targets import Targets
    from pacinian.types import ArrayLike, Complexes, Floats, Gains

AIR = Air()
FULL_DRIVE = Limits()
SILENCE = Result()
PREPARING_ZONES = Result(late=True, note="silent: the quiet zones are being prepared")
# A solve with a deadline keeps the phases of one wave while these make at least this share of the target's force. It
# relaxes them for at most MAX_RELAXED_IN_TIME points.
MIN_FORCE_OF_WAVE, MAX_RELAXED_IN_TIME = 0.85, 200


class _SolveConditions(NamedTuple):
    """What, besides the targets, a solution depends on: if it has changed, the solution is not reused.

    version: of the propagator's points. tilt, refines: of the session.
    """

    solver: Solver
    limits: Limits
    version: int
    tilt: float
    refines: bool


class _Request(NamedTuple):
    """What one solve was asked for, with checked arguments.

    budget: the time that it has. out: array for the gains, (N,). start: clock reading at its beginning [s].
    """

    targets: Targets
    limits: Limits
    solver: Solver
    budget: Budget
    out: Complexes
    start: float


class Session:
    """Solve repeatedly for one array; keeps the propagator's caches and the last solution between solves.

    array: the array. medium: `Air()` by default. solver: a name or a `Solver`; it can be replaced at any time.
    precision: "single", or "double" for studies of ill-conditioned problems. clock: returns the time [s] for deadlines.
    Raises ArgumentError, UnknownPlugin, PluginError. Belongs to one thread at a time.
    """

    def __init__(
        self,
        array: Array,
        medium: Air | None = None,
        solver: str | Solver = "auto",
        *,
        precision: Precision = "single",
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        if precision not in ("single", "double"):
            raise ArgumentError("precision", f'must be "single" or "double", not {precision!r}')
        check_kind("array", array, Array)
        self.array, self.medium = array, AIR if medium is None else medium
        check_kind("medium", self.medium, Air)
        self.propagator = Propagator(array, self.medium, precision)
        self.solver = solver
        self.clock = clock
        self.record_decision: Callable[[Callable[[], float]], float] = call_unrecorded
        """Returns what a function returns. Replace it to record decisions that depend on time."""
        self.is_cancelled: Callable[[], bool] = lambda: False
        """Returns whether a solve without a deadline is to end at once, because nobody needs its result any more."""
        self.tilt = 0.0
        """Tilt of the regions' waves: sideways shift of their foci, relative to the array's radius times d'/d (see
        `settle_phases`). Vary it to get frames that differ."""
        self.refines = True
        """Whether solves for regions may relax the phases on skin and make corrections. A solve without a deadline does
        both. One with a deadline only relaxes, and only if the phases of one wave need more than the array can make."""
        self.corrections = MAX_CORRECTIONS
        """Most solves that correct what a solve for regions has left missing; 0 for its optimum in least squares."""
        self.last: Solution | None = None
        self._solving = threading.Lock()
        self._zones = Preparation()
        self._work = np.zeros(len(array), dtype=self.propagator.dtype)
        self._solver_gains = np.zeros_like(self._work)  # to which solvers write theirs
        # whether the next solve relaxes the phases on skin although it has a deadline
        self._relaxes = False
        self.unsettled = False
        """Whether another solve for the same problem may come nearer to the targets, because it relaxes the phases."""
        self._base: Solution | None = None  # solved by a solver; its gains are in _work
        self._base_conditions: _SolveConditions | None = None
        self._hurried = False  # whether the base is for regions and had a deadline

    @property
    def solver(self) -> Solver:
        """The solver. Set it to a name or a `Solver`; the next solve uses it."""
        return self._solver

    @solver.setter
    def solver(self, solver: str | Solver) -> None:
        made = registry.solver(solver) if isinstance(solver, str) else solver
        check_kind("solver", made, Solver)
        self._solver = made

    def solve(
        self,
        points: ArrayLike,
        amplitudes: ArrayLike,
        phases: ArrayLike | None = None,
        *,
        regions: ArrayLike | None = None,
        facing: SkinFacing | None = None,
        limits: Limits | None = None,
        scale: str = "exact",
        deadline: float | None = None,
        solver: Solver | None = None,
        out: Complexes | None = None,
    ) -> Solution:
        """Find gains that produce `amplitudes` at `points`.

        points: [m], shape (M, 3); (3,) for one point. amplitudes: peak sound pressures [Pa], not negative, (M,); one
        number for all points.
        phases: [rad], broadcast to (M,), NaN where free; None if all are free.
        regions: integers, shape (M,): equal for the points of one surface; -1 for an isolated point; -2 for a point
        beside the surfaces, with amplitude 0, where the sound should stay low. Solvers with `Solver.surrounds` give
        these points a small weight; for others they are ordinary points. The free phases of a region are set to those
        of a single wave (`joint_phases`), so that the field also meets the target between the region's points, if they
        are at most half a wavelength apart.
        facing: the skin at the points. Target and achieved pressures are then those that press along its normals,
        from the sound that reaches the point. If no sound reaches it, the status is `unreachable`.
        limits: `Limits(gain=1.0)` by default. scale: "exact" (these pressures) or "max" (as strong as the solver can
        make them, in these proportions).
        deadline: time from now [s]; the solver then returns its best result so far. With a deadline, solves for regions
        make no corrections, take half the time and are less exact. On skin they keep the phases of one wave, unless an
        earlier solve for this contact needed more than the array can make.
        solver: for this solve, in place of the session's. out: array to write the gains to: contiguous, complex64
        (complex128 in double precision), shape (N,).

        The session measures the evidence in the result (pressures, residual, status) on the returned gains and does
        not rely on the solver's report. Gains are always finite, and |g| <= limits.gain always holds.
        Raises ArgumentError, PointOnTransducer, UnsupportedLimit, RuntimeError if another thread solves in this
        session, and any exception of a solver plug-in.
        """
        if not self._solving.acquire(blocking=False):
            raise RuntimeError(
                "another thread solves in this session: make a Session for each thread"
            )
        try:
            start = self.clock()
            if deadline is None:
                budget = Budget(clock=self.clock, is_cancelled=self.is_cancelled)
            else:
                budget = Budget.until(deadline, self.clock)
            if limits is None:
                limits = FULL_DRIVE
            else:
                check_kind("limits", limits, Limits)
            if facing is not None:
                check_kind("facing", facing, SkinFacing)
            if solver is None:
                solver = self._solver  # other threads may set another one at any time
            else:
                check_kind("solver", solver, Solver)
            q, targets = check_problem(
                points, amplitudes, phases, scale, regions, self.propagator.origin
            )
            out = self._check_out_array(out)
            return self._solve(_Request(targets, limits, solver, budget, out, start), q, facing)
        finally:
            self._solving.release()

    def _solve(self, request: _Request, q: Floats, facing: SkinFacing | None) -> Solution:
        """Return the solution for the points q, (M, 3) [m]: that of the last solve if possible, else a new one."""
        warm, self.last = self.last, None
        ready = self._place(q, facing, request)
        if warm is not None:
            self.last = self._reuse(request)
            if self.last is not None:
                return self.last
            warm = carry_over(self.propagator, request.targets, warm)
        made = self._solve_anew(request, warm, ready)
        in_regions, endless = request.targets.regions is not None, request.budget.endless
        if in_regions and endless:
            made = self._correct_regions(request, made)
        self.last = self._base = made
        self._hurried = in_regions and not endless
        self._choose_phases(made, request.budget)
        self._base_conditions = self._make_conditions(request)
        return self.last

    def forget(self) -> None:
        """Discard the last solution and all caches, so that the next solve is a cold start."""
        self.last = self._base = self._base_conditions = None
        self._relaxes = self.unsettled = False
        self.propagator.forget()

    def certify(self, gains: ArrayLike, *, over_phases: bool = False) -> Solution:
        """Evaluate the last solution for other gains, for example as rounded by a device.

        Computes pressures, residual, objective, dual bound and violated limits again in double precision.
        gains: as emitted, shape (N,). over_phases: also compute `Solution.least_error`, which takes seconds; only for
        at most 16 points and `scale="exact"`. Raises ArgumentError.
        """
        last, conditions = self.last, self._base_conditions
        if last is None or conditions is None:
            raise ArgumentError("gains", "cannot be certified: nothing has been solved yet")
        limits, N = conditions.limits, len(self.array)
        refuse_masked("gains", gains)
        g = np.asarray(gains)
        if g.shape != (N,) or g.dtype.kind not in "iufc" or not np.isfinite(g).all():
            raise ArgumentError("gains", f"must be {N} finite numbers")
        if over_phases and (len(last.sound_pressure) > MAX_POINTS or last.targets.scale == "max"):
            raise ArgumentError(
                "over_phases", f'is for at most {MAX_POINTS} points and scale="exact"'
            )
        return certify(self.propagator, last, limits, g.astype(np.complex128), over_phases)

    def measure_felt(self, solution: Solution) -> Solution:
        """Return `solution`, the last one, with `felt` filled in and a status that also holds between the points."""
        return add_felt(self.propagator, solution)

    def _place(self, q: Floats, facing: SkinFacing | None, request: _Request) -> bool:
        """Pass the points and the quiet points (which are in the free field) to the propagators.

        Returns whether the quiet zones are prepared.
        """
        limits, solver = request.limits, request.solver
        if limits.solver_limits and (unkept := limits.solver_limits - solver.keeps):
            raise UnsupportedLimit(solver.name, min(unkept))
        if limits.exact is not None:
            limits.make_exact_mask(len(q))
        propagator = self.propagator
        quiet = None if limits.quiet is None else np.asarray(limits.quiet[0], np.float64)
        if quiet is not None:
            check_near("limits.quiet[0]", quiet, propagator.origin)
        quiet_subspace = None
        if limits.zones:
            rms = limits.compute_max_rms(len(self.array))
            quiet_subspace = self._zones.get(
                self.array, self.medium, limits.zones, rms, request.budget, self.record_decision
            )
        propagator.keep_quiet(quiet_subspace)
        propagator.set_points(q, facing)
        if quiet is None:
            propagator.quiet = None
        else:
            if propagator.quiet is None:
                propagator.quiet = Propagator(self.array, self.medium, propagator.precision)
            propagator.quiet.keep_quiet(
                None if quiet_subspace is None else quiet_subspace.of_quiet_points
            )
            if propagator.quiet.set_points(quiet):
                propagator.version += 1
        return quiet_subspace is not None or not limits.zones

    def _make_conditions(self, request: _Request) -> _SolveConditions:
        version = self.propagator.version
        return _SolveConditions(request.solver, request.limits, version, self.tilt, self.refines)

    def _reuse(self, request: _Request) -> Solution | None:
        """Return the last solved solution, scaled; None if it must be solved again."""
        base, work = self._base, self.propagator.work
        if base is None or self.unsettled or (self._hurried and request.budget.endless):
            return None
        if self._base_conditions != self._make_conditions(request):
            return None
        targets, out, linear = request.targets, request.out, request.solver.linear
        c = find_multiple(base, self._work, targets, request.limits, linear=linear)
        if c is None:
            return None
        work.solutions_kept += c == 1.0
        work.solutions_scaled += c != 1.0
        np.multiply(self._work, c, out=out, casting="unsafe")
        return scale_solution(base, c, out, targets, self.clock() - request.start)

    def _choose_phases(self, made: Solution, budget: Budget) -> None:
        """Decide from the last solution whether the next solves with a deadline relax the phases on skin.

        These solves begin to relax them when the array makes much less than the target with the phases of one wave.
        They continue until there is no contact with skin. They never do if there are so many points that relaxing
        would take too long.
        """
        before, few = self._relaxes, len(made.targets.amplitudes) <= MAX_RELAXED_IN_TIME
        on_skin = made.facing is not None and made.targets.regions is not None
        if not (few and on_skin) or made.status is Status.silent:
            self._relaxes = False
        elif made.status is Status.limited and self.refines and not budget.endless:
            force = float((np.abs(made.sound_pressure) ** 2)[~made.targets.beside].sum())
            asked = float((made.targets.amplitudes**2).sum())
            self._relaxes = self._relaxes or force < MIN_FORCE_OF_WAVE * asked
        self.unsettled = self._relaxes and not before

    def _solve_anew(self, request: _Request, warm: Solution | None, ready: bool) -> Solution:
        """Return a new solution; zero gains if the quiet zones are not ready. warm: a solution to start from."""
        targets, limits, solver, budget, out, start = request
        propagator = self.propagator
        if targets.scale == "max" and limits.gain is None and limits.power is None:
            raise ArgumentError("scale", '"max" needs a limit: give limits.gain or limits.power')
        g = self._work  # not `out`, which may hold the gains of `warm`
        version, result, asked = propagator.version, SILENCE if ready else PREPARING_ZONES, targets
        propagator.work.solved += 1
        # not `g`: a plug-in may keep what it gets, and change its flags
        solver_gains = cast("Gains", self._solver_gains.view())
        solver_gains[:] = 0.0
        if targets.norm and ready:
            if targets.regions is not None:
                relax, keep = self.refines and (budget.endless or self._relaxes), False
                before = self._base_conditions
                if warm is not None and warm.asked_phases is not None and self._base and before:
                    # `carry_over` keeps the multipliers of samples that have not moved, or moved as one
                    same = warm.multipliers is not None
                    same = same and warm.multipliers is self._base.multipliers
                    keep = same and before.tilt == self.tilt and not budget.endless
                asked = settle_phases(propagator, targets, warm, self.tilt, relax=relax, keep=keep)
            with limit_blas_threads(len(targets.amplitudes) * len(g)):
                result = solver.solve(propagator, asked, limits, warm, budget, solver_gains)
        check_kind(f"{solver.name}.solve(...)", result, Result)
        result = result.check(solver.name, len(targets.amplitudes))
        if propagator.version != version:
            raise PluginError(f"solver {solver.name!r} has moved the points")
        if solver_gains.shape != g.shape or solver_gains.dtype != g.dtype:
            raise PluginError(f"solver {solver.name!r} has changed the shape or type of its output")
        g[:] = solver_gains
        points = propagator.points.copy()
        points.flags.writeable = False
        finite, scaled = enforce_limits(
            g, limits, "exact" if limits.solver_limits else targets.scale
        )
        held = enforce_pressure_limits(g, limits, propagator, budget, result.late)
        p = measure_pressures(propagator, g)
        out[:] = g
        miss, bound, objective = relative_error(targets, p), result.bound, result.objective
        if math.isnan(result.mu):
            bound = objective = math.nan  # nothing to check them with
        elif targets.scale == "exact" and limits.exact is None:
            missed = miss if asked is targets else None
            objective = compute_objective(asked, p, g, result.mu, result.quiet_weight, missed)
            bound = min(bound, objective)  # any excess is rounding
        broken: dict[str, float] = {}
        if limits.solver_limits or limits.zones:  # gain and power are kept by now
            broken = measure_violations(propagator, limits, targets, p, g)
        if propagator.quiet_subspace is not None and (
            above := propagator.quiet_subspace.find_violation(g)
        ):
            broken["zones"] = max(above, broken.get("zones", above))
        status = Status.failed
        if finite:
            status = determine_status(
                propagator, targets, miss,
                limit_violated=bool(broken), deadline_passed=result.late, scaled=scaled,
                limited=result.limited or held, maybe_suboptimal=result.unproven,
            )  # fmt: skip
        return Solution(
            out, self.array, self.medium, points, targets, limits,
            p, status, shorten(result.solver or solver.name), result.iterations,
            bound, objective, result.multipliers, result.mu, broken,
            self.clock() - start, shorten(result.note), limits.top_gain, late=result.late,
            asked_phases=None if asked is targets else asked.phases,
            quiet_weight=result.quiet_weight,
            facing=propagator.facing,
        )  # fmt: skip

    def _correct_regions(self, request: _Request, first: Solution) -> Solution:
        """Return `first` with gains that make up for what the regularisation leaves missing in regions (decision 69).

        The phases, the multipliers and the bound are those of `first`. Its gains stay if no correction comes clearly
        nearer to the targets.
        """
        targets, limits = request.targets, request.limits
        free = targets.scale == "exact" and not (limits.couples_gains or limits.zones)
        if not free or math.isnan(first.mu) or first.late:
            return first
        assert first.asked_phases is not None
        asked, best, error = targets.amplitudes, first, first.error
        iterations = first.iterations
        for _ in range(self.corrections if self.refines else 0):
            if request.budget.is_cancelled():
                break
            asked = correct_amplitudes(asked, targets.amplitudes, best.sound_pressure)
            kept, gains = self._work.copy(), np.empty_like(first.gains)
            corrected = dataclasses.replace(targets, amplitudes=asked, phases=first.asked_phases)
            again = request._replace(targets=corrected, out=gains)
            made = self._solve_anew(again, best, ready=True)
            iterations += made.iterations
            miss = targets.relative_error(made.sound_pressure)
            if not miss < MAX_ERROR_RATIO * error:
                self._work[:] = kept
                break
            best, error = made, miss
        if best is first:
            return first
        first.gains[:] = best.gains
        p = best.sound_pressure
        weighed = targets.with_phases(first.asked_phases)
        return dataclasses.replace(
            first,
            sound_pressure=p,
            status=determine_status(
                self.propagator, targets, error,
                limit_violated=False, deadline_passed=best.late, scaled=best.status is Status.scaled,
                limited=best.status is Status.limited,
            ),
            iterations=iterations,
            objective=compute_objective(weighed, p, self._work, first.mu, first.quiet_weight),
            seconds=self.clock() - request.start,
        )  # fmt: skip

    def _check_out_array(self, out: Complexes | None) -> Complexes:
        N, dtype = len(self.array), self.propagator.dtype
        if out is None:
            return np.empty(N, dtype=dtype)
        check_kind("out", out, np.ndarray)
        fits = out.shape == (N,) and out.dtype == dtype
        if not (fits and out.flags.c_contiguous and out.flags.writeable):
            raise ArgumentError("out", f"must be {dtype}, contiguous, writable, of shape ({N},)")
        return out


def solve(
    array: Array,
    points: ArrayLike,
    amplitudes: ArrayLike,
    phases: ArrayLike | None = None,
    *,
    solver: str | Solver = "auto",
    regions: ArrayLike | None = None,
    facing: SkinFacing | None = None,
    limits: Limits | None = None,
    scale: str = "exact",
    medium: Air | None = None,
    deadline: float | None = None,
    out: Complexes | None = None,
    precision: Precision = "single",
) -> Solution:
    """Find gains that produce `amplitudes` at `points`, by a session that solves once.

    No result is kept between calls, but the workspace of small problems is reused. Arguments and errors are those of
    `Session` and `Session.solve`.
    """
    check_kind("array", array, Array)
    medium = AIR if medium is None else medium
    check_kind("medium", medium, Air)
    key = array, medium, str(precision)
    session = acquire(key, lambda: Session(array, medium, solver, precision=precision))
    session.solver = solver
    solution = session.solve(
        points, amplitudes, phases,
        regions=regions, facing=facing, limits=limits, scale=scale, deadline=deadline, out=out,
    )  # fmt: skip
    solution = session.measure_felt(solution)
    session.forget()
    release(key, session, len(solution.sound_pressure) * len(array))
    return solution
