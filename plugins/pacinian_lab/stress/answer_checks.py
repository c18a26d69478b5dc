"""Measure the guarantees of every answer (`guarantees.EVERY`) on one answer."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import matrix
from pacinian.solving.solution_status import Status
from pacinian_lab.stress.guarantees import (
    MAX_WORK,
    TOLERANCE_MET,
    TOLERANCE_PROVEN,
    TOLERANCE_REACHED,
    TOLERANCE_TIME,
)
from pacinian_lab.stress.region_checks import find_split_regions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.solving.solution import Solution
    from pacinian.types import Complexes
    from pacinian_lab.stress.case import Case

ROUNDING = 1e-4  # allowance at quiet points for single precision of B, relative to sum |B| |g|


def measure_excess(case: Case, solution: Solution) -> float:
    """Return the largest |g_n| - limits.gain, in extended precision, or NaN without a limit."""
    if case.limits.gain is None:
        return math.nan
    g = solution.gains.astype(np.clongdouble)
    return float(np.sqrt(g.real**2 + g.imag**2).max() - case.limits.gain)


def find_broken_guarantees(
    case: Case, solution: Solution, seconds: float
) -> Iterator[tuple[str, str]]:
    """Yield each broken guarantee and its figure. seconds: run time [s]."""
    g, limits = solution.gains.astype(np.complex128), case.limits
    figures = [solution.error, solution.shape_error, np.abs(solution.residual).max(initial=0.0)]
    if not (np.isfinite(g).all() and np.isfinite(figures).all()) or np.isinf(solution.gap):
        yield "finite", f"{np.isnan(g).sum()} gains are NaN, error {solution.error:g}"
        return
    yield from _proof(case, solution, g)
    if (over := measure_excess(case, solution)) > 0.0:
        yield "gain", f"{over:.2g} over"
    power = math.fsum(np.concatenate([g.real**2, g.imag**2]).tolist())
    if limits.power is not None and power > limits.power:
        yield "power", f"{power - limits.power:.2g} over"
    allowed = case.rounding + max(case.B.shape) * case.eps * np.abs(case.B)
    off = np.abs(case.B @ g - solution.sound_pressure) - allowed @ np.abs(g)
    if (off > 1e-30 * np.abs(case.B).sum(axis=1)).any():
        yield "true", f"{off.max():.2g} Pa off"
    nothing = not case.targets.amplitudes.any()
    if (nothing and g.any()) or nothing != (solution.status is Status.silent):
        yield "silent", f"status {solution.status.name}, largest gain {np.abs(g).max():.2g}"
    if case.scale == "max" and g.any():
        reached = [np.abs(g).max() / limits.gain] if limits.gain else []
        reached += [math.sqrt(power / limits.power)] if limits.power else []
        if max(reached) < 1.0 - TOLERANCE_REACHED:
            yield "strong", f"{max(reached):.5f} of the limit"
    yield from _check_points(case, solution, g)
    yield from find_split_regions(case, solution, g)
    late = seconds - case.deadline * (1 + len(case.history)) - TOLERANCE_TIME
    if late > 0.0 and late > MAX_WORK * case.work:
        yield "late", f"{seconds:.2f} s of {case.deadline:g} s"


def _proof(case: Case, solution: Solution, g: Complexes) -> Iterator[tuple[str, str]]:
    """Check objective and bound, if they refer to the targets themselves."""
    if math.isnan(solution.gap) or case.scale == "max":
        return
    made = case.B @ g
    phases = np.angle(made) if solution.asked_phases is None else solution.asked_phases
    missed = case.targets.complex(phases) - made
    rest = float(np.linalg.norm(np.sqrt(solution.weights) * missed))  # [Pa]
    true = 0.5 * rest**2 + 0.5 * solution.mu * float(np.vdot(g, g).real)
    if math.isnan(true):  # the solution does not tell its mu
        true = solution.objective
    off = case.blur * float(np.linalg.norm(g))  # [Pa]
    rounding = off * (rest + off) + TOLERANCE_PROVEN * max(true, case.targets.norm**2)
    if solution.bound > true + rounding or abs(solution.objective - true) > rounding:
        text = f"bound {solution.bound:.4g}, objective {solution.objective:.4g}"
        yield "bound", f"{text}, but {true:.4g} in double precision"


def _check_points(case: Case, solution: Solution, g: Complexes) -> Iterator[tuple[str, str]]:
    """Check quiet points and exact samples. Silence keeps every quiet point, so quiet points are never infeasible."""
    infeasible = solution.status.name == "infeasible"
    if case.limits.quiet is not None and not (infeasible and case.limits.exact is not None):
        where, limit = case.limits.quiet
        B, most = matrix(case.array, where, case.medium), np.asarray(limit, dtype=np.float64)
        allowed = (1.0 + TOLERANCE_MET) * most + ROUNDING * (np.abs(B) @ np.abs(g))  # (K,) [Pa]
        loud = np.abs(B @ g) - allowed
        if infeasible or (loud > 0.0).any():
            yield "quiet", f"{loud.max():.2g} Pa too loud, status {solution.status.name}"
    if case.limits.exact is not None and not infeasible:
        some = case.limits.make_exact_mask(len(case.points))
        asked = float(np.linalg.norm(case.targets.amplitudes[some]))
        missed = float(np.linalg.norm(solution.residual[some])) / (asked or 1.0)
        if missed > TOLERANCE_MET:
            yield "exact", f"missed by {missed:.2g}"
