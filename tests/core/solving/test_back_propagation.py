"""With too little time for the Gram matrix, solvers give what a few products with B can give."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.propagation import matrix
from pacinian.session import Session
from pacinian.solving.back_propagation import (
    MAX_STEPS,
    MIN_ROWS,
    NO_GRAM_MATRIX,
    TRIAL_COLUMNS,
    TRIAL_ROWS,
    affords_gram,
    back_propagate,
)
from pacinian.solving.propagator import Propagator
from pacinian.solving.targets import Targets

AIR, UNIT, FOUR = pc.Air(), pc.autd(1, 1), pc.autd(2, 2)
M = MIN_ROWS
DENSE = "lagrange", "gs-pat", "pseudo-inverse", "auto"


def place(count: int, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.column_stack(
        [
            rng.uniform(0.03, 0.15, count),
            rng.uniform(0.01, 0.13, count),
            rng.uniform(0.15, 0.25, count),
        ]
    )


def relative_error(array: pc.Array, gains: np.ndarray, t: np.ndarray, q: np.ndarray) -> float:
    made = np.abs(matrix(array, q, AIR) @ gains.astype(np.complex128))
    return float(np.linalg.norm(made - t) / np.linalg.norm(t))


@pytest.mark.parametrize("solver", DENSE)
@pytest.mark.parametrize("scale", ["exact", "max"])
def test_no_gram_matrix_is_computed_if_its_time_is_too_long(solver: str, scale: str) -> None:
    q, t = place(M), np.full(M, 20.0)
    session = Session(FOUR, AIR, solver)
    solution = session.solve(q, t, scale=scale, deadline=0.0)
    assert session.propagator.work.grams_built == 0
    assert solution.late
    assert np.abs(solution.gains).max() <= 1.0
    if scale == "exact":
        assert relative_error(FOUR, solution.gains, t, q) < 0.8
    else:
        assert np.abs(solution.gains).max() == pytest.approx(1.0)
    assert session.solve(place(M, 2), t).status.name != "DEADLINE", "there is time again"


@pytest.mark.parametrize("solver", DENSE)
def test_points_that_stay_are_solved_exactly_in_the_end(solver: str) -> None:
    """Else a still scene would keep its first, rough solution."""
    q, t = place(M), np.full(M, 2.0)
    session = Session(FOUR, AIR, solver)
    for _ in range(8):
        session.solve(q, t, deadline=0.0)
    assert session.propagator.work.grams_built == 1
    assert session.solve(q, t, deadline=30.0).error < (0.4 if solver == "gs-pat" else 0.2)


def test_exact_samples_are_exact_all_the_same() -> None:
    q, t = place(M), np.full(M, 5.0)
    exact = np.arange(M) < 3
    solution = Session(FOUR, AIR, "lagrange").solve(
        q, t, limits=pc.Limits(exact=exact), deadline=0.02
    )
    assert np.abs(np.abs(solution.sound_pressure[:3]) - 5.0).max() < 1e-2


def test_few_points_are_solved_as_ever() -> None:
    few = MIN_ROWS - 1
    session = Session(FOUR, AIR, "lagrange")
    session.solve(place(few), 5.0, deadline=0.0)
    assert session.propagator.work.grams_built == 1


def test_the_time_of_the_matrix_is_that_of_a_part_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    propagator = Propagator(FOUR, AIR)
    propagator.set_points(place(M))
    multiple = (M / TRIAL_ROWS) ** 2 * len(FOUR) / TRIAL_COLUMNS  # all of B B^H over the part
    for seconds, affords, read in (
        (multiple + 2.1, True, 3),
        (multiple + 5.1, True, 3),
        (multiple + 1.9, False, 6),
    ):
        # each reading of the clock is a second after the last one: a trial takes a second, and the third is "now"
        readings = itertools.count()
        budget = pc.Budget(seconds, lambda readings=readings: float(next(readings)))
        assert affords_gram(propagator, budget) is affords
        assert next(readings) == read
    _ = propagator.gram
    assert affords_gram(propagator, pc.Budget(0.0)), "it is there already"


def test_a_part_that_took_long_by_chance_is_tried_again() -> None:
    propagator = Propagator(FOUR, AIR)
    propagator.set_points(place(M))
    readings = iter([0.0, 9.0, 9.0, 9.0, 9.0, 9.0])
    assert affords_gram(propagator, pc.Budget(10.0, lambda: next(readings)))


def test_more_steps_are_better_and_are_those_of_gerchberg_and_saxton() -> None:
    q, t = place(24, 3), np.linspace(40.0, 80.0, 24)
    propagator = Propagator(UNIT, AIR)
    propagator.set_points(q)
    B = matrix(UNIT, q, AIR)
    errors = []
    for steps in (1, 2, 5, MAX_STEPS):
        readings = itertools.count()
        budget = pc.Budget(steps - 0.5, lambda readings=readings: float(next(readings) + 1))
        out = np.empty(len(UNIT), np.complex64)
        assert (
            back_propagate(propagator, Targets.make_unchecked(t), pc.Limits(), None, budget, out)
            == steps
        )
        errors.append(relative_error(UNIT, out, t, q))
        expected = alternate(B, t, steps)
        assert np.linalg.norm(out - expected) < 1e-3 * np.linalg.norm(expected)
    assert errors[-1] < 0.6 * errors[0]


def alternate(B: np.ndarray, t: np.ndarray, steps: int) -> np.ndarray:
    """Take weighted Gerchberg-Saxton steps with dense matrices in double precision."""
    back = B.conj().T / (np.abs(B) ** 2).sum(axis=1)
    m, w = np.arange(len(t)), np.ones(len(t))
    p = t * np.exp(1j * np.pi * m * m / len(t))
    for step in range(steps):
        g = back @ (w * p)
        made = B @ g
        p = t * made / np.abs(made)
        if step < steps - 1:
            w *= np.sqrt(t / np.abs(made))
    g = g * (np.vdot(made, p) / np.vdot(made, made).real)
    return g / np.maximum(1.0, np.abs(g))


def test_points_that_are_not_asked_for_get_nothing() -> None:
    propagator = Propagator(UNIT, AIR)
    propagator.set_points(place(4))
    out = np.ones(len(UNIT), np.complex64)
    silent = Targets.make_unchecked(np.zeros(4))
    assert back_propagate(propagator, silent, pc.Limits(), None, pc.Budget(), out) == 0
    assert not out.any()


def test_the_note_says_why() -> None:
    solution = Session(FOUR, AIR, "lagrange").solve(place(M), 20.0, deadline=0.0)
    assert NO_GRAM_MATRIX in solution.note
