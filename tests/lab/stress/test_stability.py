"""Every installed solver keeps its guarantees on hard problems (pacinian_lab.stress, docs/stability.md)."""

import math
from dataclasses import replace
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_lab.stress import guarantees
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.cases import FAMILIES
from pacinian_lab.stress.problem_parts import (
    NO_LIMIT,
    SMALL_ARRAY,
    compute_asked,
    half,
    scatter_points,
)
from pacinian_lab.stress.run import run, solvers

from ...plugins.problems import optimum

SOLVERS = solvers()
KEEPING = [name for name in SOLVERS if pc.solver(name).keeps >= {"quiet", "exact"}]
TURNED = pc.Array(
    SMALL_ARRAY.positions[::4], np.where(np.arange(9)[:, None] % 3, [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]),
    pc.T4010A1,
)  # fmt: skip
ARRAYS = {
    "small": SMALL_ARRAY,
    "nine": SMALL_ARRAY.remove_transducers(range(9, 36)),
    "turned": TURNED,
}


class Looks(ManualClock):
    """Time that passes only where somebody looks: deadlines come after as many steps on any machine."""

    def now(self) -> float:
        self.advance(1e-3)
        return self.time


def require_guarantees(case: Case, *names: str) -> None:
    """Require that the solvers keep all guarantees but that of time, which needs a real clock."""
    broken = [
        (evidence.solver, name, figure)
        for evidence in run(names, [replace(case, clock=Looks().now)])
        for name, figure in evidence.broken.items()
        if name != "late"
    ]
    assert not broken, f"{broken} in {case.name}"


@pytest.mark.parametrize("family", FAMILIES)
def test_guarantees_are_kept(family: str) -> None:
    quick = [case for case in FAMILIES[family]() if not case.slow]
    for case in quick[::7]:  # families are made by loops of 2 to 6: all their values are met
        require_guarantees(case, *SOLVERS)


@st.composite
def problems(draw: Any) -> Case:
    """A random problem: coincident points, extreme targets, phases given or not, limits, history."""
    kind = draw(st.sampled_from(sorted(ARRAYS)))
    array = ARRAYS[kind]
    M, seed = draw(st.integers(1, 8)), draw(st.integers(0, 99))
    q = scatter_points(M, seed, height=draw(st.sampled_from([0.1, 0.02, 1.0])))
    spacings = draw(st.lists(st.sampled_from([0.0, 1e-9, 1e-6, 1e-4, 1e-3]), max_size=2))
    for i, spacing in enumerate(spacings):
        q[i % M] = q[-1 - i % M] + np.array([spacing, 0.0, 0.0])
    shares = np.array(draw(st.lists(st.floats(0.1, 1.0), min_size=M, max_size=M)))
    level = draw(st.sampled_from([1e-6, 0.1, 0.7, 1.0, 3.0, 1e3]))
    spread = draw(st.sampled_from([0, 0, 6, 30]))  # orders of magnitude between the targets
    t = compute_asked(array, q, level, shares * np.logspace(0, -spread, M))
    phases = draw(st.sampled_from(["free", "fixed", "half", "mixed"]))
    limits = draw(st.sampled_from([pc.Limits(), pc.Limits(gain=0.3, power=2.0), NO_LIMIT]))
    precision = draw(st.sampled_from(["single", "single", "double"]))
    before = [(q + np.array([0.001, 0.0, 0.0]), t), (q, np.ones(M))]
    history = before if draw(st.booleans()) else []
    return Case(
        f"random: {kind} array, seed {seed}, level {level:g}, {phases}, {limits.gain},"
        f" {limits.power}, {precision}, shares {shares.tolist()}, {spread} decades, {spacings} m apart,"
        f" {len(history)} before",
        array,
        q,
        t,
        {"free": None, "fixed": 0.0, "half": half(M), "mixed": np.arange(M) ** 2}[phases],
        limits,
        precision=precision,
        history=history,
    )


@pytest.mark.parametrize("solver", SOLVERS)
@settings(max_examples=40)
@given(case=problems())
def test_guarantees_are_kept_on_random_problems(solver: str, case: Case) -> None:
    require_guarantees(case, solver)


def test_what_is_guaranteed_of_lagrange_is_no_less_than_its_own_regularisation() -> None:
    near = guarantees.GUARANTEES["lagrange"].near
    assert near is not None
    assert near.mu >= getattr(pc.solver("lagrange"), "mu", near.mu)


def clarabel(case: Case) -> float:
    """The least ||p - B g|| under all limits, phases given; infinity where they contradict."""
    p, limits = case.targets.complex(np.zeros(len(case.points))), case.limits
    g = cp.Variable(len(case.array), complex=True)
    keep = [] if limits.gain is None else [cp.abs(g) <= limits.gain]
    if limits.power is not None:
        keep.append(cp.sum_squares(g) <= limits.power)
    if limits.quiet is not None:
        where, most = limits.quiet
        keep.append(cp.abs(pc.matrix(case.array, where, pc.Air()) @ g) <= most)
    exactly = limits.make_exact_mask(len(p))
    if exactly.any():
        keep.append(case.B[exactly] @ g == p[exactly])
    scale = float(np.abs(p).max())
    return scale * optimum(cp.norm(case.B @ g - p) / scale, keep)


@pytest.mark.parametrize(
    "solver", [s for s in SOLVERS if guarantees.get_guarantee(s) is guarantees.LAGRANGE]
)
@pytest.mark.parametrize("level", [0.4, 1.2, 4.0])
@pytest.mark.parametrize("spacing", [0.0, 1e-9, 1e-4, 1e-2])
def test_the_residual_is_that_of_clarabel(solver: str, spacing: float, level: float) -> None:
    q = scatter_points(4)
    q[2:] = q[:2] + np.array([spacing, 0.0, 0.0])
    phases = np.array([0.0, 1.0, 2.0, 3.0])
    case = Case("clarabel: pairs", SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, level), phases)
    best = clarabel(case)
    found = float(np.linalg.norm(case.solve(solver).residual))
    assert found <= 1.05 * best + 3e-3 * np.linalg.norm(case.amplitudes)


@pytest.mark.parametrize("solver", KEEPING)
@pytest.mark.parametrize("level", [0.4, 1.2])
@pytest.mark.parametrize(
    "limits",
    [
        {"quiet": ([[0.0, 0.0, 0.07], [0.01, 0.0, 0.07]], 5.0)},
        {"quiet": ([[0.0, 0.0, 0.07]], 0.0), "gain": 0.8},
        {"exact": [1]},
        {"exact": [0, 1, 2, 3]},
        {"exact": [2], "quiet": ([[0.0, 0.0, 0.07]], 3.0), "power": 12.0},
        {"exact": [0, 3], "gain": 0.05},
    ],
)
def test_limits_are_kept_at_the_price_of_clarabel(solver: str, limits: Any, level: float) -> None:
    q = scatter_points(4)
    t, phases = compute_asked(SMALL_ARRAY, q, level, [1, 2, 3, 4]), np.array([0.0, 1.0, 2.0, 3.0])
    case = Case("clarabel: limits", SMALL_ARRAY, q, t, phases, pc.Limits(**limits))
    require_guarantees(case, solver)
    best = clarabel(case)
    solution = case.solve(solver)
    assert (solution.status is pc.Status.infeasible) == math.isinf(best)
    if math.isfinite(best):
        found = float(np.linalg.norm(solution.residual))
        assert found <= 1.05 * best + 3e-3 * np.linalg.norm(t)
