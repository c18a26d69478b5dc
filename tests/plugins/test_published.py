"""The published methods do what their papers say, against plain NumPy, brute force and CVXPY."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.solving.propagator import Propagator
from pacinian_plugins.solvers import greedy, lbfgs

from .problems import ARRAY, optimum

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

PUBLISHED = ["gs", "weighted-gs", "gs-pat", "greedy", "lbfgs"]
published = pytest.mark.parametrize("solver", PUBLISHED)


def problem(count: int, level: float, seed: int = 0, array: pc.Array = ARRAY) -> Any:
    """Points, amplitudes whose 2-norm is `level` times what one focus could reach, and B."""
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.06, 0.06, (count, 2)), np.full(count, 0.15)]
    B = pc.matrix(array, q, pc.Air())
    t = rng.uniform(0.3, 1.0, count)
    return q, t / np.linalg.norm(t) * level * np.abs(B).sum(axis=1).mean(), B


def unit(z: Complexes) -> Complexes:
    return np.asarray(z / np.abs(z))


def start(count: int) -> Complexes:
    return np.asarray(np.exp(1j * np.pi * np.arange(count) ** 2 / count))


def nearest(p: Complexes, t: Floats) -> float:
    """The multiple of |p| nearest to t."""
    return float(np.abs(p) @ t / (np.abs(p) @ np.abs(p)))


@given(count=st.integers(1, 9), steps=st.integers(1, 12), seed=st.integers(0, 99))
def test_gs_is_the_classical_iteration(count: int, steps: int, seed: int) -> None:
    q, t, B = problem(count, 0.4, seed)
    solver = pc.solver("gs", steps=steps, amplitudes=False)
    solution = pc.solve(ARRAY, q, t, solver=solver)

    def classical(B: Complexes) -> Complexes:
        p = t * start(count)
        d = (np.abs(B) ** 2).sum(axis=1)
        for _ in range(steps):
            g = unit(B.conj().T @ (t * unit(p) / d))
            p = B @ g
        return np.asarray(g * nearest(p, t))

    exact, noise = classical(B), np.random.default_rng(seed).normal(size=(8, 2, *B.shape))
    others = [
        classical(B * (1.0 + 1e-5 * (x + 1j * y))) for x, y in noise
    ]  # phases of 100 rad in single precision
    near = 3.0 * max(float(np.abs(other - exact).max()) for other in others)
    np.testing.assert_allclose(solution.gains, exact, rtol=0.0, atol=near)


def test_gs_climbs_to_a_fixed_point() -> None:
    """Each step raises sum of t |p| / d over phases of the gains, as alternating maximisation must."""
    q, t, B = problem(6, 0.4)
    d = (np.abs(B) ** 2).sum(axis=1)
    last = 0.0
    for steps in (1, 2, 5, 20, 100, 1000):
        g = pc.solve(ARRAY, q, t, solver=pc.solver("gs", steps=steps, amplitudes=False)).gains
        value = float((t / d * np.abs(B @ unit(g))).sum())
        assert value >= last * (1.0 - 1e-6)
        last = value
    again = unit(B.conj().T @ (t / d * unit(B @ g)))
    np.testing.assert_allclose(again, unit(g), atol=1e-3)


def test_gs_with_amplitudes_is_nearer_and_as_strong_as_asked() -> None:
    shares = []
    for seed in range(40):
        q, t, _ = problem(4, 0.5, seed)
        both = [pc.solve(ARRAY, q, t, solver=pc.solver("gs", amplitudes=a)) for a in (True, False)]
        shares.append(both[0].shape_error / both[1].shape_error)
        assert nearest(both[0].sound_pressure, t) == pytest.approx(1.0, abs=1e-3)
    assert np.median(shares) < 0.8


@given(count=st.integers(1, 9), steps=st.integers(1, 30), seed=st.integers(0, 99))
def test_gs_pat_is_the_paper_s(count: int, steps: int, seed: int) -> None:
    """With the M x N propagators of the paper, not the Gram matrix."""
    q, t, B = problem(count, 0.5, seed)
    solution = pc.solve(ARRAY, q, t, solver=pc.solver("gs-pat", steps=steps))
    back = B.conj().T / (np.abs(B) ** 2).sum(axis=1)
    z = t * start(count)
    for _ in range(steps):
        z = t * unit(B @ (back @ z))
    g = back @ (z * t / np.abs(B @ (back @ z)))
    g *= nearest(B @ g, t)
    g /= np.maximum(np.abs(g), 1.0)
    np.testing.assert_allclose(solution.gains, g, atol=2e-3)


@pytest.mark.parametrize("count", range(2, 9))
def test_weighted_gs_equalises(count: int) -> None:
    """Mostly: points that come too close stay wrong. All transducers are driven alike."""
    errors = []
    for seed in range(9):
        q, t, _ = problem(count, 0.5, seed, pc.autd())
        solution = pc.solve(pc.autd(), q, t, solver="weighted-gs")
        np.testing.assert_allclose(np.abs(solution.gains), np.abs(solution.gains[0]), rtol=1e-4)
        errors.append(solution.shape_error)
    assert np.median(errors) < 2e-4


def test_weighted_gs_swings_with_exponent_1_and_not_with_one_half() -> None:
    wrong = {1.0: 0, 0.5: 0}
    for seed in range(20):
        q, t, _ = problem(2, 0.5, seed, pc.autd())
        for exponent in wrong:
            solver = pc.solver("weighted-gs", exponent=exponent, hold=100)
            wrong[exponent] += pc.solve(pc.autd(), q, t, solver=solver).shape_error > 0.01
    assert wrong[1.0] >= 3
    assert wrong[0.5] == 0


@given(seed=st.integers(0, 99), count=st.integers(1, 3), levels=st.integers(2, 9))
def test_greedy_is_brute_force(seed: int, count: int, levels: int) -> None:
    rng = np.random.default_rng(seed)
    N = 7
    B = rng.normal(size=(count, N)) + 1j * rng.normal(size=(count, N))
    t = rng.uniform(0, 5, count)
    E = np.exp(2j * np.pi * np.arange(levels) / levels)
    columns = np.ascontiguousarray(np.stack([B.real.T, B.imag.T], axis=1), np.float32)
    h, p = np.zeros((2, N), np.float32), np.zeros((2, count), np.float32)
    plain = np.zeros(N, np.complex128)
    single = np.array([E.real, E.imag], np.float32)
    cost = np.inf
    for _ in range(3):
        order = rng.permutation(N)
        greedy.choose(columns, t.astype(np.float32), order, single, h, p)
        made = h[0] + 1j * h[1]
        for n in order:
            tried = []
            for e in E:
                plain[n] = e
                tried.append(float(((np.abs(B @ plain) - t) ** 2).sum()))
            plain[n] = made[n]  # of equals either may win
            assert tried[int(np.argmin(np.abs(E - made[n])))] <= min(tried) + 1e-4 * (
                1.0 + min(tried)
            )
        np.testing.assert_allclose(p[0] + 1j * p[1], B @ made, atol=1e-4)
        after = float(((np.abs(B @ made) - t) ** 2).sum())
        assert after <= cost * (1.0 + 1e-5) + 1e-5
        cost = after


def test_greedy_is_reproducible_by_its_seed() -> None:
    q, t, _ = problem(5, 0.5)
    a, b, c = (pc.solve(ARRAY, q, t, solver=pc.solver("greedy", seed=s)).gains for s in (1, 1, 2))
    np.testing.assert_array_equal(a, b)
    assert (a != c).any()


def test_more_passes_make_greedy_better() -> None:
    errors = [
        [pc.solve(ARRAY, q, t, solver=pc.solver("greedy", passes=k)).error for k in (1, 3)]
        for q, t, _ in (problem(8, 0.5, seed) for seed in range(6))
    ]
    assert np.median(errors, axis=0)[1] < 0.5 * np.median(errors, axis=0)[0]


@given(seed=st.integers(0, 99), fixed=st.booleans())
def test_the_gradient_of_lbfgs(seed: int, fixed: bool) -> None:
    """Against central differences in double precision."""
    q, t, _ = problem(4, 0.5, seed)
    rng = np.random.default_rng(seed)
    propagator = Propagator(ARRAY, pc.Air(), "double")
    propagator.set_points(q)
    phases = rng.uniform(-3, 3, 4) if fixed else np.array([np.nan, 1.0, np.nan, np.nan])
    f = lbfgs.Objective(propagator, t, phases, float(np.linalg.norm(t)))
    x, d = rng.normal(size=200), rng.normal(size=200)
    slope = f.value(x)[1] @ d
    step = 1e-6
    differences = (f.value(x + step * d)[0] - f.value(x - step * d)[0]) / (2.0 * step)
    assert slope == pytest.approx(differences, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("level", [0.9, 1.5])
@pytest.mark.parametrize("seed", range(2))
def test_lbfgs_is_the_optimum_where_phases_are_fixed(level: float, seed: int) -> None:
    """The problem is convex then: against CVXPY with Clarabel."""
    q, t, B = problem(5, level, seed)
    phases = np.random.default_rng(seed).uniform(-3, 3, 5)
    p = t * np.exp(1j * phases)
    g = cp.Variable(100, complex=True)
    cost = cp.norm(B @ g - p)
    best = optimum(cost, [cp.abs(g) <= 1.0]) / np.linalg.norm(t)
    solution = pc.solve(ARRAY, q, t, phases, solver="lbfgs")
    assert best - 1e-6 <= solution.error <= best * 1.002 + 2e-5


@pytest.mark.parametrize("count", [2, 8, 24])
def test_lbfgs_meets_what_can_be_met(count: int) -> None:
    q, t, _ = problem(count, 0.4)
    assert pc.solve(ARRAY, q, t, solver="lbfgs").error < 2e-5


def test_lbfgs_as_strong_as_possible_is_stronger_than_scaling() -> None:
    q, t, _ = problem(4, 1.0)
    strong, scaled = (
        pc.solve(ARRAY, q, t, solver=name, scale="max") for name in ("lbfgs", "pseudo-inverse")
    )
    assert strong.status is pc.Status.ok
    assert np.linalg.norm(strong.sound_pressure) > 1.2 * np.linalg.norm(scaled.sound_pressure)


@published
@pytest.mark.parametrize("scale", ["exact", "max"])
def test_strength_is_that_asked_or_the_most(solver: str, scale: str) -> None:
    q, t, _ = problem(4, 0.4)
    solution = pc.solve(ARRAY, q, t, solver=solver, scale=scale)
    assert solution.shape_error < 0.06
    if scale == "exact":
        assert nearest(solution.sound_pressure, t) == pytest.approx(1.0, abs=3e-3)
    else:
        assert np.abs(solution.gains).max() == pytest.approx(1.0, abs=1e-4)
        assert nearest(solution.sound_pressure, t) < 0.75


@published
def test_tiny_targets_are_large_ones_in_small(solver: str) -> None:
    q, t, _ = problem(5, 0.5)
    a, b = (pc.solve(ARRAY, q, t * 2.0**-k, solver=solver) for k in (20, 90))
    np.testing.assert_allclose(a.gains * 2.0**20, b.gains * 2.0**90, rtol=1e-4, atol=1e-6)


@published
def test_without_a_limit_any_strength_is_made(solver: str) -> None:
    q, t, _ = problem(3, 5.0)
    solution = pc.solve(ARRAY, q, t, solver=solver, limits=pc.Limits(gain=None))
    assert np.abs(solution.gains).max() > 2.0
    assert nearest(solution.sound_pressure, t) == pytest.approx(1.0, abs=3e-3)


@published
def test_beyond_reach_it_gives_what_there_is(solver: str) -> None:
    q, t, _ = problem(3, 1.0)
    far, further = (pc.solve(ARRAY, q, t * more, solver=solver) for more in (1e4, 1e25))
    for solution in (far, further):
        assert solution.status is pc.Status.limited
        assert np.abs(solution.gains).mean() > 0.95
    np.testing.assert_allclose(
        np.abs(far.sound_pressure), np.abs(further.sound_pressure), rtol=0.02
    )


@published
def test_fixed_phases_are_targets(solver: str) -> None:
    q, t, _ = problem(4, 0.3, 3)
    phases = np.array([0.5, np.nan, -2.0, 2.0])
    p = pc.solve(ARRAY, q, t, phases, solver=solver).sound_pressure
    off = np.angle(p * np.exp(-1j * phases))[~np.isnan(phases)]
    assert np.abs(off).max() < (1e-3 if solver == "lbfgs" else 0.05 if solver == "greedy" else 0.6)


@published
def test_silence_at_a_point(solver: str) -> None:
    q, t, _ = problem(4, 0.4)
    t[2] = 0.0
    p = np.abs(pc.solve(ARRAY, q, t, solver=solver).sound_pressure)
    silenced = {"lbfgs": 1e-4, "greedy": 0.01}.get(solver, 1.0)  # the others do not try
    assert p[2] < silenced * t.max()


@published
def test_the_time_is_kept_and_the_answer_is_usable(solver: str) -> None:
    q, t, _ = problem(400, 1.5)
    solution = pc.solve(ARRAY, q, t, solver=solver, deadline=0.0)
    assert solution.status is pc.Status.deadline
    assert solution.iterations <= 10
    assert solution.error < 1.0


@published
def test_the_last_solution_is_the_start(solver: str) -> None:
    q, t, _ = problem(8, 0.6)
    session = pc.Session(ARRAY, solver=solver)
    cold = session.solve(q, t)
    warm = session.solve(q + 1e-4, t)
    assert warm.error <= 1.5 * cold.error + 1e-3
    assert warm.iterations <= cold.iterations


@pytest.mark.parametrize(
    ("solver", "option", "bad"),
    [
        ("gs", "steps", 0), ("gs", "amplitudes", 1), ("gs-pat", "steps", 0.5),
        ("weighted-gs", "steps", 0), ("weighted-gs", "exponent", 1.1), ("weighted-gs", "hold", 0),
        ("greedy", "levels", 1), ("greedy", "passes", 0), ("greedy", "seed", -1),
        ("lbfgs", "steps", 0), ("lbfgs", "tolerance", 0.0), ("lbfgs", "memory", 0),
    ],
)  # fmt: skip
def test_settings_are_checked(solver: str, option: str, bad: float) -> None:
    with pytest.raises(pc.ArgumentError, match=option):
        pc.solver(solver, **{option: bad})
