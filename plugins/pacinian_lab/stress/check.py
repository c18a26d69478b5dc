"""Check whether one solver keeps its guarantees on one problem."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.errors import UnsupportedLimit
from pacinian.solving.solution_status import Status
from pacinian_lab.stress.answer_checks import find_broken_guarantees, measure_excess
from pacinian_lab.stress.case import DEFAULT_DEADLINE
from pacinian_lab.stress.guarantees import SILENCE, get_guarantee
from pacinian_lab.stress.reference import CLOSED, Reference

if TYPE_CHECKING:
    from pacinian.plugins.solver import Solver
    from pacinian.solving.solution import Solution
    from pacinian_lab.stress.case import Case
    from pacinian_lab.stress.guarantees import Guarantee, Near


@dataclass(frozen=True)
class Evidence:
    """The behaviour of one solver on one problem.

    broken: broken guarantees, from name to figure. excess: the largest |g_n| - limits.gain. ratio: the residual over
    what `Near` allows with a factor of 1; NaN if not guaranteed. seconds: run time [s].
    """

    case: str
    solver: str
    broken: dict[str, str]
    excess: float = math.nan
    ratio: float = math.nan
    seconds: float = math.nan


def check(case: Case, solver: Solver) -> Evidence:
    """Solve `case` and check the answer against the guarantees."""
    name = solver.name
    begin = case.clock()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            solution = case.solve(solver)
    except UnsupportedLimit as refusal:
        findings = {} if case.limits.solver_limits - solver.keeps else {"raises": str(refusal)}
        return Evidence(case.name, name, findings)
    except Exception as error:  # any error of a solver is a finding
        right = case.refused is not None and isinstance(error, case.refused)
        findings = {} if right else {"raises": f"{type(error).__name__}: {error}"}
        return Evidence(case.name, name, findings)
    seconds = case.clock() - begin
    if case.refused is not None:
        return Evidence(case.name, name, {"raises": f"no {case.refused.__name__}"})
    broken = dict(find_broken_guarantees(case, solution, seconds))
    guarantee = get_guarantee(name)
    ratio = math.nan
    if len(case.points) <= guarantee.samples:
        if guarantee.answers and (missing := _check_answer(case, guarantee, solution, seconds)):
            broken["answers"] = missing
        if guarantee.near and not broken and _is_comparable(case, guarantee.near, solution):
            ratio = compute_ratio(case, guarantee.near, solution)
            if ratio > guarantee.near.factor:
                broken["near"] = f"{ratio:.3g} > {guarantee.near.factor:g}"
    return Evidence(case.name, name, broken, measure_excess(case, solution), ratio, seconds)


def _check_answer(case: Case, guarantee: Guarantee, solution: Solution, seconds: float) -> str:
    if solution.status is Status.failed:
        return "failed"
    if case.deadline >= DEFAULT_DEADLINE and seconds >= case.deadline * (1 + len(case.history)):
        return f"not done in {case.deadline:g} s"
    reached = (np.abs(case.B) > case.rounding).any(axis=1) & (case.targets.amplitudes > 0.0)
    if solution.gains.any() or not reached.any():
        return ""
    ratio = compute_ratio(case, guarantee.near or SILENCE, solution)  # is silence near the best?
    return f"all gains are zero: {ratio:.3g}" if ratio > SILENCE.factor else ""


def _is_comparable(case: Case, near: Near, solution: Solution) -> bool:
    """Return whether `compute_ratio` applies to this problem."""
    plain = case.limits.power is None and not case.limits.solver_limits and case.scale == "exact"
    given = solution.asked_phases is not None or not case.targets.free.any()
    phases = near.free or given or len(case.points) == 1
    done = solution.status is not Status.deadline and not solution.late
    return bool(plain and phases and done and case.targets.amplitudes.any())


def compute_ratio(case: Case, guaranteed: Near, solution: Solution) -> float:
    """Return the residual over what `guaranteed` allows with a factor of 1, for the solver's phases."""
    weights = np.sqrt(solution.weights)
    p = weights * case.ask(solution)
    scale = float(np.abs(p).max())  # keeps squares from underflow and overflow
    p, g = p / scale, solution.gains.astype(np.complex128) / scale
    B, reference = case.B, case.reference
    if (weights != 1.0).any():
        B = weights[:, None] * B
        reference = Reference.of(B)
    made = B @ g
    if not guaranteed.limited and (power := float(np.vdot(made, made).real)):
        made *= max(0.0, float(np.vdot(made, p).real) / power)
    mu, enough = guaranteed.mu, 0.0
    if case.targets.regions is not None:
        mu, enough = guaranteed.mu_regions, guaranteed.enough
    mu *= float(np.linalg.norm(case.B)) ** 2 / len(case.B)
    limited = guaranteed.limited and case.limits.gain is not None
    limit = (case.limits.gain or 0.0) / scale if limited else math.inf
    best = reference.best(p, mu, case.blur**2, limit, g)
    if limited:
        best = max(best, max(CLOSED, enough**2) * float(np.vdot(p, p).real))
    residual = float(np.linalg.norm(p - made))
    return residual / math.sqrt(best) if best > 0.0 else (math.inf if residual else 0.0)
