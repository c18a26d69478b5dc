"""Points beside regions have a target of silence, with a small weight."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc

ARRAY, AIR = pc.autd(), pc.Air()
MIDDLE = ARRAY.centre + np.array([0.0, 0.0, 0.15])
QUIET = 0.02  # their weight, as documented


def disc_and_ring() -> tuple[Any, Any]:
    """Return points of a disc of 9 mm radius, 3 mm apart, and of a ring 4 to 12 mm beside it, 5 mm apart."""
    places = []
    for spacing in (0.003, 0.005):
        x = np.arange(-0.024, 0.0241, spacing)
        X, Y = np.meshgrid(x, x)
        places.append(np.column_stack([X.ravel(), Y.ravel(), np.zeros(X.size)]))
    r = [np.hypot(q[:, 0], q[:, 1]) for q in places]
    return MIDDLE + places[0][r[0] < 0.0091], MIDDLE + places[1][(r[1] > 0.013) & (r[1] < 0.021)]


DISC, RING = disc_and_ring()
POINTS = np.concatenate([DISC, RING])
REGIONS = np.repeat([0, -2], [len(DISC), len(RING)])
AMPLITUDES = np.where(REGIONS == 0, 300.0, 0.0)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("level", [1.0, 4.0])
def test_it_is_the_optimum_of_the_weighted_problem(level: float, precision: Any) -> None:
    """The objective is computed by hand, and the bound of the dual proves that no gains are better."""
    session = pc.Session(ARRAY, precision=precision)
    session.corrections = 0  # corrections would leave the optimum
    solution = session.solve(POINTS, level * AMPLITUDES, regions=REGIONS)
    w = np.where(REGIONS == 0, 1.0, QUIET)
    g = solution.gains.astype(complex)
    asked = level * AMPLITUDES * np.exp(1j * solution.asked_phases)
    rest = asked - pc.matrix(ARRAY, POINTS, AIR) @ g
    objective = ((w * np.abs(rest) ** 2).sum() + solution.mu * np.vdot(g, g).real) / 2.0
    assert solution.objective == pytest.approx(objective, rel=1e-3)
    assert solution.bound <= solution.objective <= 1.01 * solution.bound
    told = session.certify(solution.gains)
    assert told.objective == pytest.approx(objective, rel=1e-6)
    assert told.bound == pytest.approx(solution.bound, rel=1e-3)
    assert (solution.saturation > 0.0) == (level > 1.0)


def press(gains: Any, q: Any) -> Any:
    return pc.radiation_pressure(pc.matrix(ARRAY, q, AIR) @ gains.astype(complex), AIR)


def test_sound_keeps_away_and_the_region_stays_even() -> None:
    """The field is evaluated between all these points."""
    turn = 2.0 * np.pi * np.arange(60) / 60
    between = [
        MIDDLE + r * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
        for r in (0.015, 0.017, 0.019)
    ]
    ring, disc = np.concatenate(between), (DISC[1:] + DISC[:-1]) / 2.0
    disc = disc[np.linalg.norm(np.diff(DISC, axis=0), axis=1) < 0.0031]
    asked = float(pc.radiation_pressure(300.0, AIR))
    alone = pc.solve(ARRAY, DISC, AMPLITUDES[: len(DISC)], regions=np.zeros(len(DISC), int))
    around = pc.solve(ARRAY, POINTS, AMPLITUDES, regions=REGIONS)
    assert press(around.gains, ring).max() < 0.6 * press(alone.gains, ring).max()
    P = press(around.gains, disc)
    assert np.sqrt(((P - asked) ** 2).mean()) / asked < 0.08
    assert len(around.felt) == 1
    assert around.felt[0].force == pytest.approx(P.mean() / asked, abs=0.03)


def test_their_error_is_no_error() -> None:
    solution = pc.solve(ARRAY, POINTS, AMPLITUDES, regions=REGIONS)
    own = solution.targets.beside
    assert np.array_equal(own, REGIONS == -2)
    rest = np.abs(solution.sound_pressure) - AMPLITUDES
    of_region = np.linalg.norm(rest[~own]) / np.linalg.norm(AMPLITUDES)
    assert solution.error == pytest.approx(of_region, rel=1e-5)
    assert np.abs(rest[own]).max() > 0.0


@pytest.mark.parametrize(
    "solver", ["lagrange", "pseudo-inverse", "gs-pat", "weighted-gs", "gs", "greedy"]
)
def test_every_solver_takes_them(solver: str) -> None:
    solution = pc.solve(ARRAY, POINTS, AMPLITUDES, regions=REGIONS, solver=solver)
    assert np.isfinite(solution.gains).all()
    assert np.abs(solution.gains).max() <= 1.0
    assert pc.solver(solver).surrounds == (solver == "lagrange")


def test_only_beside_nothing_is_a_region_and_sound_is_refused_there() -> None:
    alone = pc.solve(ARRAY, RING, np.zeros(len(RING)), regions=np.full(len(RING), -2))
    assert alone.status is pc.Status.silent
    with pytest.raises(pc.ArgumentError, match="-2"):
        pc.solve(ARRAY, POINTS, AMPLITUDES + 1.0, regions=REGIONS)
    with pytest.raises(pc.ArgumentError, match="-2"):
        pc.solve(ARRAY, POINTS, AMPLITUDES, regions=REGIONS - 1)
    with pytest.raises(pc.ArgumentError, match="regions"):
        pc.solve(ARRAY, POINTS, AMPLITUDES, regions=REGIONS[1:])


def test_the_strongest_does_not_count_them() -> None:
    alone = pc.solve(
        ARRAY, DISC, AMPLITUDES[: len(DISC)], regions=np.zeros(len(DISC), int), scale="max"
    )
    around = pc.solve(ARRAY, POINTS, AMPLITUDES, regions=REGIONS, scale="max")
    own = REGIONS == 0
    ratio = np.linalg.norm(around.sound_pressure[own]) / np.linalg.norm(alone.sound_pressure)
    assert ratio == pytest.approx(1.0, abs=0.25)
