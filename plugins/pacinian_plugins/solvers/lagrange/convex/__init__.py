"""Convex problems of `lagrange`: fixed phases, any combination of its limits, and a certificate for each solution.

least_squares.py    `least_squares`: near, exact and quiet rows under limits on gain and power
max_scale.py        `maximise_scale`: strongest pressures of given proportions
answer.py           `Answer`: gains and their certificate (bound)
constraints.py      which rows are near, exact or quiet
dual.py             the dual problem: its value, gains and residuals for multipliers
dual_ascent.py      Newton ascent until the duality gap is closed, with less smoothing from step to step
newton_step.py      one Newton step, line search, power limit
starting_points.py  regularised pseudo-inverses to start from
kernels.hpp         products with A, discs: called by dual.py, dual_ascent.py, newton_step.py, starting_points.py
"""

from __future__ import annotations

from pacinian_plugins.solvers.lagrange.convex.answer import Answer
from pacinian_plugins.solvers.lagrange.convex.least_squares import least_squares
from pacinian_plugins.solvers.lagrange.convex.max_scale import maximise_scale

__all__ = ["Answer", "least_squares", "maximise_scale"]
