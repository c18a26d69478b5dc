"""From points and pressures to gains: the session that the loop uses, and the one-shot `solve`."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.checks import kind, near, numbers
from pacinian.errors import ArgumentError, PluginError, UnsupportedLimit
from pacinian.plugins import registry
from pacinian.plugins.solver import Result, Solver
from pacinian.solving.blas import one_thread
from pacinian.solving.problem import Budget, Limits, Targets
from pacinian.solving.propagator import Propagator
from pacinian.solving.solution import Solution, Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.propagation import Precision
    from pacinian.types import ArrayLike, Complexes, Gains

TOLERANCE = 1e-3  # relative error up to which targets count as met
ROUNDING = 1e-5  # a gain this little over the limit is shortened, the others left as they are


class Session:
    """Solves again and again for one array: keeps the propagator's caches and the last solution.

    array, medium (`Air()` unless given). solver: a name or a `Solver`; may be replaced at any time.
    precision: "single", or "double" for studies of ill-conditioned problems. clock: [s], for deadlines.
    Raises ArgumentError, UnknownPlugin, PluginError. Not for several threads at once.
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
        kind("array", array, Array)
        self.array, self.medium = array, Air() if medium is None else medium
        kind("medium", self.medium, Air)
        self.propagator = Propagator(array, self.medium, precision)
        self.solver = solver
        self._clock = clock
        self.last: Solution | None = None
        self._work = np.zeros(len(array), dtype=np.complex64)

    @property
    def solver(self) -> Solver:
        """The solver in use; set it by name or by object, from the next solve on."""
        return self._solver

    @solver.setter
    def solver(self, solver: str | Solver) -> None:
        made = registry.solver(solver) if isinstance(solver, str) else solver
        kind("solver", made, Solver)
        self._solver = made

    def solve(
        self,
        points: ArrayLike,
        amplitudes: ArrayLike,
        phases: ArrayLike | None = None,
        *,
        limits: Limits | None = None,
        scale: str = "exact",
        deadline: float | None = None,
        out: Gains | None = None,
    ) -> Solution:
        """Find gains that make `amplitudes` at `points`.

        points: [m], shape (M, 3). amplitudes: peak sound pressure [Pa], real, not negative, shape (M,).
        phases: None where free, else [rad], broadcast to (M,), NaN where free.
        limits: `Limits(gain=1.0)` unless given. scale: "exact" (the asked pressures) or "max" (as
        strong as the solver can, in these proportions). deadline: seconds from now; then the best so far.
        out: complex64, shape (N,), contiguous, to write the gains to.

        The result's evidence (pressures, residual, status) is measured here, on the gains as
        returned, whatever the solver says. Gains are finite and |g| <= limits.gain, in every case.
        Raises ArgumentError; PointOnTransducer; UnsupportedLimit; what a solver plug-in raises.
        """
        start = self._clock()
        budget = Budget.until(deadline, self._clock)
        limits = Limits() if limits is None else limits
        kind("limits", limits, Limits)
        solver, propagator = self._solver, self.propagator
        q = numbers("points", points, (None, 3))
        near("points", q, propagator.origin)
        targets = Targets.checked(len(q), amplitudes, phases, scale)
        out = self._checked(out)
        if unkept := limits.asked - solver.keeps:
            raise UnsupportedLimit(solver.name, min(unkept))
        if targets.scale == "max" and limits.gain is None and limits.power is None:
            raise ArgumentError("scale", '"max" needs a limit: give limits.gain or limits.power')
        warm, self.last = self.last, None
        if warm is not None and len(warm.sound_pressure) != len(q):
            warm = None
        g = self._work  # apart from `out`, which may hold the gains of `warm`
        g[:] = 0.0
        propagator.place(q)
        version = propagator.version
        result = Result()
        if targets.amplitudes.any():
            with one_thread(len(q) * len(g)):
                result = solver.solve(propagator, targets, limits, warm, budget, g)
        kind(f"{solver.name}.solve(...)", result, Result)
        if propagator.version != version:
            raise PluginError(f"solver {solver.name!r} has moved the points")
        finite, scaled = keep(g, limits, targets.scale)
        p = propagator.apply(g).astype(np.complex128)
        out[:] = g
        self.last = Solution(
            gains=out,
            targets=targets,
            sound_pressure=p,
            status=self._judge(targets, p, result, scaled) if finite else Status.failed,
            solver=result.solver or solver.name,
            iterations=result.iterations,
            bound=result.bound,
            objective=result.objective,
            seconds=self._clock() - start,
            note=result.note,
        )
        return self.last

    def _checked(self, out: Gains | None) -> Gains:
        N = len(self.array)
        if out is None:
            return np.empty(N, dtype=np.complex64)
        kind("out", out, np.ndarray)
        fits = out.shape == (N,) and out.dtype == np.complex64
        if not (fits and out.flags.c_contiguous and out.flags.writeable):
            raise ArgumentError("out", f"must be complex64, contiguous, writable, of shape ({N},)")
        return out

    def _judge(self, targets: Targets, p: Complexes, result: Result, scaled: bool) -> Status:
        """How it ended, from the evidence: the pressures achieved, (M,) [Pa]."""
        if not targets.amplitudes.any():
            return Status.silent
        if targets.scale == "max":
            scaled = False
            reached = float(np.linalg.norm(p) / np.linalg.norm(targets.amplitudes))
            p = p / (reached or 1.0)
        if targets.miss(p) <= TOLERANCE:
            return Status.ok
        asked = targets.amplitudes > 0.0
        if not self.propagator.B[asked].any(axis=1).all():
            return Status.unreachable
        if result.late:
            return Status.deadline
        if scaled:
            return Status.scaled
        return Status.limited if result.limited else Status.approximate


def keep(g: Gains, limits: Limits, scale: str) -> tuple[bool, bool]:
    """Scale gains (N,) as a whole, in place, down to the limits, or for "max" up to them too.

    Returns whether they were finite (if not, they are zero now) and whether they were over. Rounding
    cannot leave a gain above the limit, in exact arithmetic.
    """
    from pacinian.solving import kernels

    strongest = math.sqrt(kernels.peak(g))
    if math.isnan(strongest):
        g[:] = 0.0
        return False, False
    if not strongest:
        return True, False
    factor = math.inf if scale == "max" else 1.0
    if limits.gain is not None:
        factor = min(factor, limits.gain / strongest)
    if limits.power is not None:
        share = np.abs(g) / strongest  # 0..1, so that squares neither vanish nor overflow
        root = strongest * math.sqrt(float((share.astype(np.float64) ** 2).sum()))
        factor = min(factor, math.sqrt(limits.power) * (1.0 - 2.0**-21) / root)
    over = factor < 1.0 - ROUNDING
    if not over and scale != "max":
        factor = 1.0
    # what rounding to complex64 cannot push over
    highest = math.inf if limits.gain is None else limits.gain * (1.0 - 2.0**-21)
    kernels.restrain(g, factor, highest)
    return True, over


def solve(
    array: Array,
    points: ArrayLike,
    amplitudes: ArrayLike,
    phases: ArrayLike | None = None,
    *,
    solver: str | Solver = "auto",
    limits: Limits | None = None,
    scale: str = "exact",
    medium: Air | None = None,
    deadline: float | None = None,
    out: Gains | None = None,
    precision: Precision = "single",
) -> Solution:
    """Find gains that make `amplitudes` at `points`: a session of one solve, with no state kept.

    Arguments and errors as in `Session` and `Session.solve`.
    """
    session = Session(array, medium, solver, precision=precision)
    return session.solve(
        points, amplitudes, phases, limits=limits, scale=scale, deadline=deadline, out=out
    )
