"""Least squares under limits on gains, on their power and on sound pressures."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

import pacinian as pc
from pacinian.solving.propagator import gram_matrix as product
from pacinian_plugins.solvers.lagrange.convex.constraints import Constraints
from pacinian_plugins.solvers.lagrange.convex.dual import Dual
from pacinian_plugins.solvers.lagrange.convex.dual_ascent import ascend_dual
from pacinian_plugins.solvers.lagrange.convex.newton_step import Newton
from pacinian_plugins.solvers.lagrange.convex.starting_points import begin

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Complexes, Flags, Floats
    from pacinian_plugins.solvers.lagrange.convex.answer import Answer


def least_squares(
    A: Complexes,
    p: Complexes,
    *,
    mu: float,
    gram: Complexes | None = None,
    exact: Flags | None = None,
    quiet: Floats | None = None,
    gain: bool = True,
    power: float | None = None,
    start: Complexes | None = None,
    budget: pc.Budget | None = None,
    tolerance: float = 1e-5,
    steps: int = 60,
) -> Answer:
    """Minimise ||p - A h||^2 / 2 + mu/2 ||h||^2 over gains h within the limits.

    A: rows of the M samples, then of K quiet points, (M + K, N) [Pa], complex64 or complex128.
    p: (M,) [Pa]. mu: above 0 [Pa^2]. gram: A A^H, complex128, if known.
    exact: samples to be met exactly, (M,). quiet: limits of |A h| at the quiet points, (K,) [Pa].
    gain: whether |h_n| <= 1. power: limit of ||h||^2. start: multipliers y, (M + K,), of a similar
    problem. tolerance: relative gap to stop at. steps: maximum number of steps.

    If exact rows cannot be met within the other limits, they are treated as near rows, and `kept` is
    false. If there are more samples than transducers, a QR decomposition, one pass over A, reduces them to N.
    """
    budget = budget or pc.Budget()
    soft = np.ones(len(p), np.bool_) if exact is None else ~np.asarray(exact, np.bool_)
    if soft.sum() > A.shape[1]:
        solve = functools.partial(
            least_squares, mu=mu, quiet=quiet, gain=gain, power=power, budget=budget,
            tolerance=tolerance, steps=steps,
        )  # fmt: skip
        return _solve_reduced(solve, A, p, soft, start)
    gram = product(A) if gram is None else gram
    rows = Constraints.of(p, exact, quiet)
    dual = Dual.of(A, rows, mu, gain, power)
    newton = Newton.of(A, gram, mu)
    answer = ascend_dual(newton, dual, begin(dual, gram, start, budget), budget, tolerance, steps)
    if answer.kept or answer.late or soft.all():
        return answer
    near = replace(dual, rows=rows.relax())
    second = ascend_dual(newton, near, begin(near, gram, start, budget), budget, tolerance, steps)
    violation = rows.violation(rows.p - second.made)
    return second._replace(
        violation=violation, kept=False, impossible=answer.impossible,
        steps=answer.steps + second.steps,
    )  # fmt: skip


def _solve_reduced(
    solve: Callable[..., Answer], A: Complexes, p: Complexes, soft: Flags, start: Complexes | None
) -> Answer:
    """Solve with R in place of the rows A = Q R that have no limit."""
    M, N = len(p), A.shape[1]
    near = np.append(soft, np.zeros(len(A) - M, np.bool_))
    B = A[near].astype(np.complex128)
    Q, R = cast("tuple[Complexes, Complexes]", np.linalg.qr(B))
    down = Q.conj().T @ p[soft]
    exact = np.append(np.zeros(N, np.bool_), np.ones(M - int(soft.sum()), np.bool_))
    if start is not None:
        start = np.append(Q.conj().T @ start[near], start[~near])
    A_small = np.ascontiguousarray(np.concatenate([R, A[~near]]))
    small = solve(A_small, np.append(down, p[~soft]), exact=exact, start=start)
    lost = (float(np.vdot(p, p).real) - float(np.vdot(p[~soft], p[~soft]).real)) / 2.0
    lost = max(lost - float(np.vdot(down, down).real) / 2.0, 0.0)
    made, y, violation = (
        np.empty(len(A), np.complex128),
        np.empty(len(A), np.complex128),
        np.zeros(len(A)),
    )
    made[near], made[~near] = B @ small.h, small.made[N:]
    y[near], y[~near] = p[soft] - made[near], small.y[N:]
    violation[~near] = small.violation[N:]
    return small._replace(
        y=y, made=made, objective=small.objective + lost, bound=small.bound + lost, violation=violation,
    )  # fmt: skip
