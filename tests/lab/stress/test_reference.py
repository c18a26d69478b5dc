"""The suite's own reference, against high precision (mpmath) and convex optimisation (Clarabel)."""

import warnings
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from mpmath import mp

import pacinian as pc
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.problem_parts import SMALL_ARRAY, row, scatter_points
from pacinian_lab.stress.reference import Reference

mp.dps = 60
NINE = SMALL_ARRAY.remove_transducers(range(9, 36))
AIR = pc.Air()


def exact(array: pc.Array, q: Any) -> Any:
    """B of an omnidirectional array in 60 digits."""
    k = 2 * mp.pi * mp.mpf(array.transducer.frequency) / mp.mpf(AIR.speed_of_sound)
    B = mp.matrix(len(q), len(array))
    for m in range(len(q)):
        for i, r in enumerate(array.positions):
            d = mp.norm(mp.matrix(q[m]) - mp.matrix(r))
            B[m, i] = mp.exp(-1j * k * d) / d
    return B


def least(B: Any, p: Any, mu: Any, rounding: Any) -> float:
    """||p - B g||^2 + rounding ||g||^2 for the g of the least ||p - B g||^2 + (mu + rounding) ||g||^2."""
    G = B * B.H
    for m in range(B.rows):
        G[m, m] += mu + rounding
    g = B.H * mp.lu_solve(G, mp.matrix(p))
    rest = mp.matrix(p) - B * g
    return float(mp.norm(rest) ** 2 + rounding * mp.norm(g) ** 2)


@pytest.mark.parametrize("condition", [1e1, 1e4, 1e8, 1e12, 1e15])
@pytest.mark.parametrize(("mu", "rounding"), [(1e-5, 0.0), (0.0, 1e-10), (1e-5, 1e-3)])
def test_the_best_without_a_limit_is_that_of_60_digits(
    condition: float, mu: float, rounding: float
) -> None:
    q, p = row(condition), np.exp(1j * np.arange(5.0) ** 2)
    best = Reference.of(pc.matrix(NINE, q, pc.Air())).best(p, mu, rounding, np.inf, np.zeros(9))
    assert best == pytest.approx(least(exact(NINE, q), p, mp.mpf(mu), mp.mpf(rounding)), rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("level", [0.5, 1.2, 30.0])
def test_the_best_within_a_limit_is_that_of_clarabel(seed: int, level: float) -> None:
    rng = np.random.default_rng(seed)
    q = scatter_points(4, seed)
    q[1] = q[0] + rng.choice([0.0, 1e-9, 1e-4])
    B = pc.matrix(NINE, q, pc.Air())
    p = rng.normal(size=4) + 1j * rng.normal(size=4)
    p *= level * np.abs(B).sum(axis=1).mean() / np.linalg.norm(p)
    mu = 1e-4 * np.linalg.norm(B) ** 2 / 4
    found = Reference.of(B).best(p, mu, 0.0, 1.0, np.zeros(9))
    g = cp.Variable(9, complex=True)
    cost = cp.sum_squares(B @ g - p) + mu * cp.sum_squares(g)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cp.Problem(cp.Minimize(cost), [cp.abs(g) <= 1.0]).solve(solver=cp.CLARABEL)
    best = float(cost.value)
    if np.abs(g.value).max() < 1.0 - 1e-6:
        best -= mu * float(np.vdot(g.value, g.value).real)
    assert 0.985 * best <= found <= best * (1.0 + 1e-5)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("offset", [0.0, 1000.0, 1e6])
@pytest.mark.parametrize("place", ["far", "near", "coincident", "distant"])
def test_b_is_within_its_rounding_of_60_digits(place: str, offset: float, precision: Any) -> None:
    q = scatter_points(3)
    if place == "near":
        q[0] = NINE.positions[4] + [0.0, 0.0, 1.1e-6]
    elif place == "coincident":
        q[1] = q[0] + [1e-9, 0.0, 0.0]
    elif place == "distant":
        q[2] = [1.0, -2.0, 9.0]
    pose = pc.Pose((offset, -offset, offset))
    array, q = NINE.transform(pose), np.asarray(pose.points(q))
    case = Case("", array, q, np.ones(3), precision=precision)
    propagator = pc.Propagator(array, AIR, precision)
    propagator.set_points(q)
    B = np.array(exact(array, q).tolist(), dtype=np.complex128)
    assert (np.abs(propagator.B - B) <= case.rounding).all()
    assert (np.abs(case.B - B) <= Case("", array, q, np.ones(3), precision="double").rounding).all()


def test_the_condition_number_is_the_one_asked_for() -> None:
    for wanted in (1e2, 1e5, 1e9, 1e13):
        s = np.linalg.svd(pc.matrix(SMALL_ARRAY, row(wanted), pc.Air()), compute_uv=False)
        assert s[0] / s[-1] == pytest.approx(wanted, rel=0.02)
