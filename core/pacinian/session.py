"""Solve for gains: `Session`, which the render loop uses, and the one-shot `solve`."""

from __future__ import annotations

import dataclasses
import math
import threading
import time
from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.argument_checks import (
    MAX_LENGTH,
    check_kind,
    check_near,
    check_numbers,
    refuse_masked,
)
from pacinian.errors import ArgumentError, PluginError, UnsupportedLimit, shorten
from pacinian.native import solving as kernels
from pacinian.plugins import registry
from pacinian.plugins.solver import Result, Solver
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.corrections import MAX_CORRECTIONS, MAX_ERROR_RATIO, correct_amplitudes
from pacinian.solving.error_lower_bound import MAX_POINTS
from pacinian.solving.gain_evaluation import certify, measure_felt
from pacinian.solving.limit_enforcement import (
    MAX_CLIPPED_EXCESS,
    enforce_joined_limits,
    enforce_limits,
)
from pacinian.solving.problem import Budget, Limits, Targets, number_regions
from pacinian.solving.propagator import Propagator
from pacinian.solving.quiet_subspace import Preparation, evaluate
from pacinian.solving.region_phases import settle_phases
from pacinian.solving.solution import Solution
from pacinian.solving.solution_check import (
    determine_status,
    measure_pressures,
    measure_violations,
    relative_error,
)
from pacinian.solving.solution_status import Status
from pacinian.solving.warm_start import carry_over

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.propagation import Precision
    from pacinian.types import ArrayLike, Complexes, Floats, Gains

AIR = Air()
FULL_DRIVE = Limits()
ENDLESS = Budget()
SILENCE = Result()
PREPARING_ZONES = Result(late=True, note="silent: the quiet zones are being prepared")
# Smallest force that the phases of one wave make, relative to the target, for which solves with a deadline keep them,
# and largest number of points for which they relax them.
MIN_FORCE_OF_WAVE, MAX_RELAXED_IN_TIME = 0.85, 200
MAX_MULTIPLE = 1e6  # largest factor by which a solution is scaled instead of solved again


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
        self.note: Callable[[Callable[[], float]], float] = evaluate
        """Returns what a function returns. Replace it to record decisions that depend on time."""
        self.tilt = 0.0
        """Sideways shift of the regions' waves, relative to the array's radius. Vary it to get frames that differ."""
        self.refines = True
        """Whether solves for regions relax the phases on skin, and make corrections.

        Without a deadline, they do both. With one, they relax the phases if those of one wave need more than the array
        can make.
        """
        self.corrections = MAX_CORRECTIONS
        """Most solves that correct what a solve for regions has left missing; 0 for its optimum in least squares."""
        self.last: Solution | None = None
        self._solving = threading.Lock()
        self._zones = Preparation()
        self._work = np.zeros(len(array), dtype=self.propagator.dtype)
        # whether the next solve relaxes the phases on skin although it has a deadline
        self._relaxes = False
        self.unsettled = False
        """Whether another solve for the same problem may come nearer to the targets, because it relaxes the phases."""
        self._base: Solution | None = None  # solved by a solver; its gains are in _work
        self._solved_with: tuple[Solver, Limits, int, float, bool] | None = None
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
        deadline: time from now [s]; the solver then returns its best result so far. With a deadline, regions are less
        exact and take half the time: there are no corrections, and on skin they keep the phases of a wave, unless an
        earlier solve for the same contact has needed more than the array can make.
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
            return self._solve(
                points, amplitudes, phases, regions, facing, limits, scale, deadline, solver, out
            )
        finally:
            self._solving.release()

    def _solve(
        self, points: ArrayLike, amplitudes: ArrayLike, phases: ArrayLike | None, regions: ArrayLike | None,
        facing: SkinFacing | None, limits: Limits | None, scale: str, deadline: float | None,
        solver: Solver | None, out: Complexes | None,
    ) -> Solution:  # fmt: skip
        start = self.clock()
        budget = ENDLESS if deadline is None else Budget.until(deadline, self.clock)
        if limits is None:
            limits = FULL_DRIVE
        check_kind("limits", limits, Limits)
        if facing is not None:
            check_kind("facing", facing, SkinFacing)
        if solver is None:
            solver = self._solver  # other threads may set another one at any time
        check_kind("solver", solver, Solver)
        q, targets = self._problem(points, amplitudes, phases, scale, regions)
        out = self._check_out_array(out)
        warm, self.last = self.last, None
        ready = self._place(q, facing, limits, budget, solver)
        if (
            not self.unsettled
            and warm is not None
            and not (self._hurried and budget.endless)
            and (c := self._find_multiple(targets, limits, solver)) == c
        ):
            self.last = self._scale_last(c, targets, out, start)
            return self.last
        if warm is not None:
            warm = carry_over(self.propagator, targets, warm)
        made = self._solve_anew(targets, limits, warm, budget, out, start, ready, solver)
        if targets.regions is not None and budget.endless:
            made = self._correct_regions(made, limits, start, solver)
        self.last = self._base = made
        self._hurried = targets.regions is not None and not budget.endless
        self._choose_phases(made, budget)
        self._solved_with = solver, limits, self.propagator.version, self.tilt, self.refines
        return self.last

    def forget(self) -> None:
        """Discard the last solution and all caches, so that the next solve is a cold start."""
        self.last = self._base = self._solved_with = None
        self._relaxes = self.unsettled = False
        self.propagator.forget()

    def certify(self, gains: ArrayLike, *, over_phases: bool = False) -> Solution:
        """Evaluate the last solution for other gains, for example as rounded by a device.

        Computes pressures, residual, objective, dual bound and violated limits again in double precision.
        gains: as emitted, shape (N,). over_phases: also compute `Solution.least_error`, which takes seconds; only for
        at most 16 points and `scale="exact"`. Raises ArgumentError.
        """
        last, with_ = self.last, self._solved_with
        if last is None or with_ is None:
            raise ArgumentError("gains", "cannot be certified: nothing has been solved yet")
        limits, N = with_[1], len(self.array)
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
        return measure_felt(self.propagator, solution)

    def _problem(
        self, points: ArrayLike, amplitudes: ArrayLike, phases: ArrayLike | None, scale: str,
        regions: ArrayLike | None,
    ) -> tuple[Floats, Targets]:  # fmt: skip
        """Check the arguments and return the points, (M, 3), and their targets; arrays take a fast path."""
        plain = phases is None and type(scale) is str and scale == "exact"
        if plain and isinstance(points, np.ndarray) and isinstance(amplitudes, np.ndarray):
            q, t = cast("Floats", points), cast("Floats", amplitudes)
            if (
                q.dtype == t.dtype == np.float64
                and t.ndim == 1
                and q.shape == (len(t), 3)
                and q.flags.c_contiguous
                and t.flags.c_contiguous
                and kernels.furthest(q, self.propagator.origin, t) <= MAX_LENGTH * MAX_LENGTH
            ):
                return q, Targets.make_unchecked(t, number_regions(len(t), regions))
        q = check_numbers("points", _as_rows(points), (None, 3))
        check_near("points", q, self.propagator.origin)
        return q, Targets.make_checked(len(q), amplitudes, phases, scale, regions)

    def _place(
        self, q: Floats, facing: SkinFacing | None, limits: Limits, budget: Budget, solver: Solver
    ) -> bool:
        """Pass the points and the quiet points (which are in the free field) to the propagators.

        Returns whether the quiet zones are prepared.
        """
        if limits.solver_limits and (unkept := limits.solver_limits - solver.keeps):
            raise UnsupportedLimit(solver.name, min(unkept))
        if limits.exact is not None:
            limits.exact_mask(len(q))
        propagator = self.propagator
        quiet = None if limits.quiet is None else np.asarray(limits.quiet[0], np.float64)
        if quiet is not None:
            check_near("limits.quiet[0]", quiet, propagator.origin)
        nulls = None
        if limits.zones:
            rms = limits.rms(len(self.array))
            nulls = self._zones.nulls(self.array, self.medium, limits.zones, rms, budget, self.note)
        propagator.keep_quiet(nulls)
        propagator.set_points(q, facing)
        if quiet is None:
            propagator.quiet = None
        else:
            if propagator.quiet is None:
                propagator.quiet = Propagator(self.array, self.medium, propagator.precision)
            propagator.quiet.keep_quiet(None if nulls is None else nulls.of_quiet_points)
            if propagator.quiet.set_points(quiet):
                propagator.version += 1
        return nulls is not None or not limits.zones

    def _find_multiple(self, targets: Targets, limits: Limits, solver: Solver) -> float:
        """Return the c for which c times the last solved gains are the solution; NaN if there is none."""
        base = self._base
        now = solver, limits, self.propagator.version, self.tilt, self.refines
        if base is None or self._solved_with != now:
            return math.nan
        c = targets.multiple(base.targets)
        if c == 1.0:
            return c if not base.late and base.status is not Status.failed else math.nan
        met = base.status in (Status.ok, Status.approximate) and targets.scale == "exact"
        met = met and not (base.late and base.targets.regions is not None)
        if (
            not (met and solver.linear)
            or limits.solver_limits
            or limits.power is not None
            or (limits.zones and c > 1.0)  # the residual sound in the zones would be louder, too
            or not c > 0.0
        ):
            return math.nan
        top = _top(limits) * (1.0 - MAX_CLIPPED_EXCESS)
        strongest = math.sqrt(kernels.peak(self._work))
        held = strongest >= top or c * strongest >= top
        return c if not held and 1.0 / MAX_MULTIPLE < c < MAX_MULTIPLE else math.nan

    def _choose_phases(self, made: Solution, budget: Budget) -> None:
        """Decide from the last solution whether the next solves with a deadline relax the phases on skin.

        They do once the array makes much less than the target with the phases of one wave, until there is no contact
        with skin. Not if there are so many points that it would take too long.
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

    def _scale_last(self, c: float, targets: Targets, out: Complexes, start: float) -> Solution:
        """Return the last solved solution, scaled by c."""
        base, work = self._base, self.propagator.work
        assert base is not None  # `_find_multiple` has checked it
        work.solutions_kept += c == 1.0
        work.solutions_scaled += c != 1.0
        np.multiply(self._work, c, out=out, casting="unsafe")
        y = base.multipliers
        return Solution(
            out, self.array, self.medium, base.points, targets, base.limits,
            c * base.sound_pressure, base.status, base.solver, 0,
            c * c * base.bound, c * c * base.objective, None if y is None else c * y, base.mu,
            base.violations, self.clock() - start, base.note, base.gain_limit,
            asked_phases=base.asked_phases, quiet_weight=base.quiet_weight, facing=base.facing,
        )  # fmt: skip

    def _solve_anew(
        self, targets: Targets, limits: Limits, warm: Solution | None, budget: Budget,
        out: Complexes, start: float, ready: bool, solver: Solver,
    ) -> Solution:  # fmt: skip
        """Return a new solution; zero gains if the quiet zones are not ready."""
        propagator = self.propagator
        if targets.scale == "max" and limits.gain is None and limits.power is None:
            raise ArgumentError("scale", '"max" needs a limit: give limits.gain or limits.power')
        g = self._work  # not `out`, which may hold the gains of `warm`
        g[:] = 0.0
        version, result, asked = propagator.version, SILENCE if ready else PREPARING_ZONES, targets
        propagator.work.solved += 1
        if targets.norm and ready:
            if targets.regions is not None:
                relax, keep = self.refines and (budget.endless or self._relaxes), False
                before = self._solved_with
                if warm is not None and warm.asked_phases is not None and self._base and before:
                    # `carry_over` keeps the multipliers of samples that have not moved, or moved as one
                    same = warm.multipliers is not None
                    same = same and warm.multipliers is self._base.multipliers
                    keep = same and before[3] == self.tilt and not budget.endless
                asked = settle_phases(propagator, targets, warm, self.tilt, relax=relax, keep=keep)
            with limit_blas_threads(len(targets.amplitudes) * len(g)):
                result = solver.solve(propagator, asked, limits, warm, budget, cast("Gains", g))
        check_kind(f"{solver.name}.solve(...)", result, Result)
        result.check(solver.name, len(targets.amplitudes))
        if propagator.version != version:
            raise PluginError(f"solver {solver.name!r} has moved the points")
        points = propagator.points.copy()
        points.flags.writeable = False
        finite, scaled = enforce_limits(
            g, limits, "exact" if limits.solver_limits else targets.scale
        )
        held = enforce_joined_limits(g, limits, propagator, budget, result.late)
        p = measure_pressures(propagator, g)
        out[:] = g
        miss, bound, objective = relative_error(targets, p), result.bound, result.objective
        if result.mu != result.mu:
            bound = objective = math.nan  # nothing to check them with
        elif targets.scale == "exact" and limits.exact is None:
            missed = miss if asked is targets else None
            objective = _compute_objective(asked, p, g, result.mu, result.quiet_weight, missed)
            bound = min(bound, objective)  # any excess is rounding
        hard = limits.solver_limits or limits.zones
        broken = measure_violations(propagator, limits, targets, p, g) if hard else {}
        if propagator.nulls is not None and (above := propagator.nulls.find_violation(g)):
            broken["zones"] = max(above, broken.get("zones", above))
        status = Status.failed
        if finite:
            status = determine_status(
                propagator, targets, miss,
                broken=bool(broken), late=result.late, scaled=scaled, limited=result.limited or held,
                unproven=result.unproven,
            )  # fmt: skip
        return Solution(
            out, self.array, self.medium, points, targets, limits,
            p, status, shorten(result.solver or solver.name), result.iterations,
            bound, objective, result.multipliers, result.mu, broken,
            self.clock() - start, shorten(result.note), _top(limits), late=result.late,
            asked_phases=None if asked is targets else asked.phases,
            quiet_weight=result.quiet_weight,
            facing=propagator.facing,
        )  # fmt: skip

    def _correct_regions(
        self, first: Solution, limits: Limits, start: float, solver: Solver
    ) -> Solution:
        """Return `first` with gains that make up for what the regularisation leaves missing in regions (decision 69).

        The phases, the multipliers and the bound are those of `first`. Its gains stay if no correction comes clearly
        nearer to the targets.
        """
        targets = first.targets
        plain = targets.scale == "exact" and not (limits.solver_limits or limits.zones)
        if not plain or limits.power is not None or first.mu != first.mu or first.late:
            return first
        assert first.asked_phases is not None
        asked, best, error = targets.amplitudes, first, first.error
        iterations = first.iterations
        for _ in range(self.corrections if self.refines else 0):
            asked = correct_amplitudes(asked, targets.amplitudes, best.sound_pressure)
            kept, gains = self._work.copy(), np.empty_like(first.gains)
            made = self._solve_anew(
                dataclasses.replace(targets, amplitudes=asked, phases=first.asked_phases),
                limits, best, ENDLESS, gains, start, True, solver,
            )  # fmt: skip
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
                broken=False, late=best.late, scaled=best.status is Status.scaled,
                limited=best.status is Status.limited,
            ),
            iterations=iterations,
            objective=_compute_objective(weighed, p, self._work, first.mu, first.quiet_weight),
            seconds=self.clock() - start,
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


def _compute_objective(
    asked: Targets,
    p: Complexes,
    g: Complexes,
    mu: float,
    quiet_weight: float,
    miss: float | None = None,
) -> float:
    """Return 1/2 sum_m w_m |t_m - p_m|^2 + mu/2 ||g||^2 for targets t of fixed phases [Pa^2].

    miss: relative error of p, if known.
    """
    rest = (asked.relative_error(p) if miss is None else miss) * asked.norm
    quiet = p[asked.beside]
    rest = rest * rest + quiet_weight * float(np.vdot(quiet, quiet).real)
    return float(rest + mu * kernels.power(cast("Gains", g))) / 2.0


def _as_rows(points: ArrayLike) -> ArrayLike:
    """Return one point of shape (3,) as an array of shape (1, 3), and anything else as it is."""
    refuse_masked("points", points)
    try:
        given = np.asarray(points)
    except ValueError:  # ragged, which the caller refuses
        return points
    return given[None] if given.shape == (3,) else points


def _top(limits: Limits) -> float:
    return math.inf if limits.gain is None else limits.gain


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
