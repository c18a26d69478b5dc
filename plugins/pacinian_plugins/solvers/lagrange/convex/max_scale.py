"""The strongest pressures of given proportions within the limits."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.errors import ArgumentError
from pacinian.solving.propagator import gram_matrix as product
from pacinian.solving.propagator import mean_square
from pacinian_plugins.solvers.lagrange.convex.constraints import Constraints
from pacinian_plugins.solvers.lagrange.convex.dual import Dual
from pacinian_plugins.solvers.lagrange.convex.dual_ascent import ascend_dual
from pacinian_plugins.solvers.lagrange.convex.newton_step import Newton
from pacinian_plugins.solvers.lagrange.convex.starting_points import begin_strongest

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats
    from pacinian_plugins.solvers.lagrange.convex.answer import Answer

MIN_SMOOTHING = 1e-12  # smoothing weight of the gains at the start [Pa^2]


def maximise_scale(
    A: Complexes,
    c: Complexes,
    *,
    gram: Complexes | None = None,
    quiet: Floats | None = None,
    gain: bool = True,
    power: float | None = None,
    start: Complexes | None = None,
    budget: pc.Budget | None = None,
    tolerance: float = 1e-4,
    steps: int = 60,
) -> Answer:
    """Find gains that make s c in M samples with the largest s. Gains or power must be limited.

    The dual minimises sum_n |x_n| + sum_k q_k |y_k|, x = A^H y, subject to Re(y^H c) = 1, an upper bound of s.
    Both terms are smoothed, and less so as the gap closes. If the proportions cannot be made at all, s is 0.
    Arguments as for `least_squares`; c: (M,), not all 0.
    Raises ArgumentError if neither gains nor power are limited.
    """
    if not gain and power is None:
        raise ArgumentError(
            "gain",
            "must be limited unless `power` is: without a limit there is no strongest solution",
        )
    gram = product(A) if gram is None else gram
    size = float(np.linalg.norm(c)) / (mean_square(gram) ** 0.5 or 1.0)
    along = np.concatenate([c / size, np.zeros(len(A) - len(c))]).astype(np.complex128)
    rows = Constraints.of(along[: len(c)], np.ones(len(c), np.bool_), quiet)
    rows = replace(rows, p=np.zeros_like(along))
    dual = replace(Dual.of(A, rows, MIN_SMOOTHING, gain, power), along=along)
    newton = Newton.of(A, gram, mean_square(gram))
    budget = budget or pc.Budget()
    state = begin_strongest(dual, gram, start, budget)
    answer = ascend_dual(newton, dual, state, budget, tolerance, steps)
    return answer._replace(
        y=answer.y / size, objective=answer.objective / size, bound=answer.bound / size,
        strength=answer.strength / size,
    )  # fmt: skip
