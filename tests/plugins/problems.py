"""What the tests of solvers share: problems, and the optimum by a solver that is not ours."""

from __future__ import annotations

import warnings
from typing import Any

import cvxpy as cp
import numpy as np

import pacinian as pc

ARRAY = pc.lattice(0.09, 0.09)  # 100 ideal transducers


def points(count: int, seed: int = 0, width: float = 0.12, height: float = 0.15) -> Any:
    """Points at random in a square above the array."""
    rng = np.random.default_rng(seed)
    return np.c_[rng.uniform(-width / 2, width / 2, (count, 2)), np.full(count, height)]


def reachable(q: Any, level: float, seed: int = 0, array: pc.Array = ARRAY) -> Any:
    """Amplitudes whose 2-norm is `level` times what one focus could reach."""
    t = np.random.default_rng(seed).uniform(0.3, 1.0, len(q))
    return t / np.linalg.norm(t) * level * np.abs(pc.matrix(array, q, pc.Air())).sum(axis=1).mean()


def optimum(cost: Any, limits: list[Any]) -> float:
    """The least cost under the limits, by CVXPY with Clarabel; infinity where they contradict."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return float(cp.Problem(cp.Minimize(cost), limits).solve(solver=cp.CLARABEL))
