"""The common evaluator, on cases whose answer is known."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian_lab.solvers.problems import AIR, BenchmarkProblem, matrix
from pacinian_lab.solvers.score import eight_bit, score

PROBLEM = BenchmarkProblem.make(1, 5, 0.2, 0)
B = matrix(PROBLEM.positions, PROBLEM.points)
ASK = (PROBLEM.positions, PROBLEM.points, PROBLEM.targets)
EXACT = np.linalg.pinv(B) @ PROBLEM.targets  # far from the limit


def test_exact_gains_have_no_error_and_a_scale_of_one() -> None:
    assert np.abs(EXACT).max() < 0.5
    found = score(*ASK, EXACT)
    assert found.error < 1e-12
    assert found.best_multiple == pytest.approx(1.0, rel=1e-12)
    assert found.mean_pressure == pytest.approx(PROBLEM.targets.mean(), rel=1e-12)


@given(scale=st.floats(1e-3, 2.0), phase=st.floats(-9.0, 9.0))
def test_strength_is_scale_and_phase_is_nothing(scale: float, phase: float) -> None:
    found = score(*ASK, scale * np.exp(1j * phase) * EXACT)
    assert found.error < 1e-11
    assert found.best_multiple == pytest.approx(scale, rel=1e-9)


@given(seed=st.integers(0, 10_000))
def test_the_multiple_is_the_best_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    g = (rng.normal(size=249) + 1j * rng.normal(size=249)) / 5
    found = score(*ASK, g)
    p = np.abs(B @ (g / np.maximum(1.0, np.abs(g))))
    best = np.linalg.lstsq(PROBLEM.targets[:, None], p, rcond=None)
    assert found.best_multiple == pytest.approx(best[0][0], rel=1e-9)
    assert found.error * found.best_multiple * np.linalg.norm(PROBLEM.targets) == pytest.approx(
        math.sqrt(best[1][0]), rel=1e-6
    )


def test_gains_are_clipped_each_by_itself() -> None:
    g = np.full(249, 0.5 + 0.0j)
    g[7] = -3.0j
    clipped = g.copy()
    clipped[7] = -1.0j
    assert score(*ASK, g) == score(*ASK, clipped)


def test_silence_has_no_error() -> None:
    found = score(*ASK, np.zeros(249))
    assert math.isnan(found.error)
    assert (found.best_multiple, found.mean_pressure) == (0.0, 0.0)


def test_a_known_solver_is_judged_as_it_judges_itself() -> None:
    array = pc.Array(PROBLEM.positions, transducer=pc.Transducer(pressure=4.386))
    points, targets = PROBLEM.points, PROBLEM.targets
    solution = pc.solve(array, points, targets, solver="pseudo-inverse", medium=AIR)
    found = score(*ASK, solution.gains)
    assert found.error == pytest.approx(solution.shape_error, abs=1e-4)
    assert found.error < 1e-4
    assert found.best_multiple == pytest.approx(1.0, abs=1e-3)


@given(seed=st.integers(0, 10_000))
def test_eight_bits_are_the_nearest_levels(seed: int) -> None:
    rng = np.random.default_rng(seed)
    g = rng.uniform(0, 1, 50) * np.exp(1j * rng.uniform(-4, 4, 50))
    rounded = eight_bit(g)
    assert (np.abs(np.abs(rounded) - np.abs(g)) <= 0.5 / 255 + 1e-12).all()
    turned = np.angle(rounded * g.conj())[np.abs(rounded) > 0]
    assert (np.abs(turned) <= np.pi / 256 + 1e-9).all()
    np.testing.assert_allclose(eight_bit(rounded), rounded, atol=1e-12)
    levels = np.abs(rounded) * 255
    np.testing.assert_allclose(levels, np.rint(levels), atol=1e-9)


def test_eight_bits_stop_at_full_drive() -> None:
    np.testing.assert_allclose(eight_bit(np.array([3.0 + 0.0j, 1.0, 0.0])), [1.0, 1.0, 0.0])
