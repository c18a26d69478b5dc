"""Corrections of the error that a solve for regions leaves, evaluated by B in double precision between samples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import pacinian as pc
from pacinian.solving.corrections import MAX_CORRECTION, correct_amplitudes

AIR, ARRAY = pc.Air(speed_of_sound=340.0, density=1.2), pc.autd(3, 3)
PLACE = np.array([*ARRAY.centre[:2], 0.2])


def plane(width: float, spacing: float, axes: Any) -> Any:
    """Return points of a square along two axes, (M, 3) [m]."""
    s = np.linspace(-width / 2.0, width / 2.0, round(width / spacing) + 1)
    X, Y = np.meshgrid(s, s)
    return PLACE + np.c_[X.ravel(), Y.ravel()] @ np.asarray(axes, float)


def bowl(spacing: float) -> Any:
    q = plane(0.03, spacing, [(1, 0, 0), (0, 1, 0)])
    q[:, 2] += 8.0 * ((q[:, 0] - PLACE[0]) ** 2 + (q[:, 1] - PLACE[1]) ** 2)
    return q


SHAPES = {
    "upright": lambda d: plane(0.024, d, [(1, 0, 0), (0, 0, 1)]),
    "flat": lambda d: plane(0.034, d, [(1, 0, 0), (0, 1, 0)]),
    "bowl": bowl,
}
each = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)


def solve(shape: Any, pressure: float, corrections: int, **how: Any) -> tuple[pc.Session, Any]:
    q, session = shape(0.003), pc.Session(ARRAY, AIR)
    session.corrections = corrections
    t = pc.sound_pressure(np.full(len(q), pressure), AIR)
    return session, session.solve(q, t, regions=np.zeros(len(q), int), **how)


def felt_rms(solution: Any, places: Any, pressure: float) -> float:
    p = pc.matrix(ARRAY, places, AIR) @ solution.gains.astype(complex)
    return float(np.sqrt(((pc.radiation_pressure(p, AIR) / pressure - 1.0) ** 2).mean()))


@each
def test_the_pressure_between_the_samples_is_more_even(shape: Any) -> None:
    pressure, places = 5.0, shape(0.00103)
    before, after = (felt_rms(solve(shape, pressure, n)[1], places, pressure) for n in (0, 2))
    assert after < max(0.7 * before, 0.009)


@each
@pytest.mark.parametrize("pressure", [5.0, 30.0])
def test_the_evidence_is_that_of_the_problem_that_was_asked(shape: Any, pressure: float) -> None:
    """Bound, phases and multipliers are from the first solve; the objective is that of the returned gains."""
    _, first = solve(shape, pressure, 0)
    session, solution = solve(shape, pressure, 2)
    assert solution.targets.amplitudes == pytest.approx(first.targets.amplitudes)
    assert solution.targets.all_free
    assert solution.bound == pytest.approx(first.bound, rel=1e-3)
    assert solution.error <= 1.0001 * first.error
    g = solution.gains.astype(complex)
    p = pc.matrix(ARRAY, solution.points, AIR) @ g
    rest = solution.targets.amplitudes * np.exp(1j * solution.asked_phases) - p
    objective = (np.vdot(rest, rest).real + solution.mu * np.vdot(g, g).real) / 2.0
    assert solution.objective == pytest.approx(objective, rel=1e-3)
    assert solution.bound <= solution.objective
    told = session.certify(solution.gains)
    assert told.status is session.measure_felt(solution).status
    assert told.sound_pressure == pytest.approx(solution.sound_pressure, rel=1e-3, abs=0.1)
    assert np.abs(solution.gains).max() <= 1.0


def test_the_next_solve_begins_from_the_corrected_gains() -> None:
    session, solution = solve(SHAPES["upright"], 5.0, 2)
    gains, solved = solution.gains.copy(), session.propagator.work.solved
    again = session.solve(solution.points, solution.targets.amplitudes, regions=np.zeros(81, int))
    assert session.propagator.work.solved == solved
    assert again.gains == pytest.approx(gains)
    half = session.solve(
        solution.points, solution.targets.amplitudes / 2, regions=np.zeros(81, int)
    )
    assert half.gains == pytest.approx(gains / 2, rel=1e-5)


@pytest.mark.parametrize(
    "how",
    [
        {"deadline": 1e6},
        {"scale": "max"},
        {"limits": pc.Limits(gain=1.0, power=100.0)},
        {"solver": pc.solver("gs-pat")},
    ],
    ids=["deadline", "max", "power", "no regularisation"],
)
def test_there_are_none_without_time_or_regularisation_or_with_other_limits(how: Any) -> None:
    gains = [solve(SHAPES["upright"], 5.0, n, **how)[1].gains for n in (0, 2)]
    assert np.array_equal(*gains)


def test_isolated_points_have_none() -> None:
    q = PLACE + np.array([[0.02, 0.0, 0.0], [-0.02, 0.0, 0.0], [0.0, 0.02, 0.0]])
    session = pc.Session(ARRAY, AIR)
    session.solve(q, np.full(3, 300.0))
    assert session.propagator.work.solved == 1


def test_what_contradicts_itself_stays_in_the_middle() -> None:
    """Two regions are at one place, one four times as strong. No correction favours either."""
    q = plane(0.02, 0.003, [(1, 0, 0), (0, 1, 0)])
    t = pc.sound_pressure(np.repeat([4.0, 16.0], len(q)), AIR)
    solution = pc.solve(ARRAY, np.r_[q, q], t, regions=np.repeat([0, 1], len(q)), medium=AIR)
    p = np.abs(
        pc.matrix(ARRAY, plane(0.014, 0.00103, [(1, 0, 0), (0, 1, 0)]), AIR) @ solution.gains
    )
    assert p.mean() == pytest.approx(0.75 * t[-1], rel=0.05)


amplitudes = arrays.arrays(np.float64, 5, elements=st.floats(0.0, 1e30, allow_subnormal=False))


@given(asked=amplitudes, t=amplitudes, p=amplitudes)
def test_corrected_amplitudes_stay_within_twice_and_half_the_target(
    asked: Any, t: Any, p: Any
) -> None:
    found = correct_amplitudes(asked, t, p.astype(complex))
    assert (found >= t / MAX_CORRECTION).all()
    assert (found <= MAX_CORRECTION * t).all()
