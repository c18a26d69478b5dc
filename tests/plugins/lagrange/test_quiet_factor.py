"""Contacts finer than the array resolves do not press on the skin beside them; coarse ones are solved as before."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import pacinian as pc
from pacinian.region_numbers import BESIDE
from pacinian.testing import ManualClock
from pacinian_lab.regions.skin import measure_felt
from pacinian_plugins.native.lagrange import find_loudest
from pacinian_plugins.solvers.lagrange import quiet_factor, regions
from pacinian_plugins.solvers.lagrange.quiet_factor import (
    MAX_FACTOR,
    MIN_CHANGE,
    adapt_factor,
    find_last_factor,
    find_max_loudness,
)

AIR = pc.Air()
ONE, NINE = pc.autd(), pc.autd(3, 3)
TILT = (np.sin(np.pi / 8.0), 0.0, 0.0, np.cos(np.pi / 8.0))  # 45 degrees about x
SHAPES = {
    "plate": (pc.Box((0.004, 0.03, 0.03)), 0.015, (0.0, 0.0, 0.0, 1.0)),
    "edge": (pc.Box((0.035, 0.02, 0.02)), 0.01 * np.sqrt(2.0), TILT),
    "ball": (pc.Sphere(0.03), 0.03, (0.0, 0.0, 0.0, 1.0)),
}
"""Shape, height of its top above its centre [m], orientation."""


def press(array: Any, name: str, pressure: float, *, ticks: int = 16) -> tuple[Any, Any]:
    """Press a shape 3 mm into the palm; return what is felt over all touched skin, and the solution."""
    shape, top, orientation = SHAPES[name]
    x, y = array.centre[:2]
    pose = pc.Pose((x, y, 0.198 - top), orientation)
    item = pc.Volume(shape=shape, pose=pose, radiation_pressure=pressure, name="object")
    scene = pc.Scene((item,), hands=(pc.Hand.open("right", pc.Pose((x, y, 0.21))),))
    with pc.Renderer(array, scene, medium=AIR, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(ticks):
            renderer.tick(1e-3 * k)
        felt = measure_felt(array, AIR, scene, 1e-3 * ticks, renderer.cycle_gains)
        return felt, renderer.solution


@pytest.mark.parametrize("name", ["plate", "edge"])
def test_a_fine_contact_does_not_press_beside_it(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Measured on skin where no sample was."""
    felt, solution = press(NINE, name, 6.0)
    assert solution.quiet_weight > 0.04
    assert felt.force == pytest.approx(1.0, abs=0.1)
    with monkeypatch.context() as patch:
        patch.setattr(regions, "MAX_COLD_CHANGES", 0)
        patch.setattr(regions, "MAX_WARM_CHANGES", 0)
        before, _ = press(NINE, name, 6.0)
    assert felt.spill < 1.0
    assert before.spill > 2.0


def test_a_coarse_contact_is_solved_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    felt, solution = press(NINE, "ball", 6.0)
    monkeypatch.setattr(regions, "MAX_COLD_CHANGES", 0)
    monkeypatch.setattr(regions, "MAX_WARM_CHANGES", 0)
    before, alone = press(NINE, "ball", 6.0)
    assert felt == before
    assert np.array_equal(solution.gains, alone.gains)
    assert solution.quiet_weight == pytest.approx(0.02)


def find_bars(gap: float, shift: float = 0.0) -> tuple[Any, Any]:
    """Return samples and region numbers of two bars, and of silent lines between and beside them.

    gap: between the bars [m]. shift: of all samples [m].
    """
    x, y = ONE.centre[:2]
    along = np.arange(-0.015, 0.0151, 0.0025)
    bars = [-gap / 2.0 - 0.002, -gap / 2.0, gap / 2.0, gap / 2.0 + 0.002]
    silent = [0.0, -gap - 0.004, gap + 0.004]
    points = np.array([(x + shift + a, y + b, 0.2) for a in bars + silent for b in along])
    return points, np.repeat([0, BESIDE], [4 * len(along), 3 * len(along)])


def solve_bars(
    session: pc.Session, gap: float, shift: float = 0.0, pressure: float = 600.0
) -> pc.Solution:
    points, numbers = find_bars(gap, shift)
    return session.solve(points, np.where(numbers == 0, pressure, 0.0), regions=numbers)


@pytest.fixture
def session() -> pc.Session:
    made = pc.Session(ONE, AIR)
    made.corrections = 0  # corrections would leave the optimum
    return made


@pytest.mark.parametrize(("gap", "pressure"), [(0.010, 100.0), (0.009, 600.0), (0.010, 1500.0)])
def test_it_is_the_optimum_of_its_own_problem(
    session: pc.Session, gap: float, pressure: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One unit cannot resolve the gap. The objective is computed by hand, and the dual proves that it is least."""
    monkeypatch.setattr(quiet_factor, "MAX_LOUDNESS_AT_LIMIT", quiet_factor.MAX_LOUDNESS)
    solution = solve_bars(session, gap, pressure=pressure)
    factor = solution.quiet_weight / 0.02
    assert 2.0 < factor <= MAX_FACTOR
    points, numbers = find_bars(gap)
    B = pc.matrix(ONE, points, AIR)
    M = len(points)
    assert solution.mu == pytest.approx(factor * 0.005 * np.sum(np.abs(B) ** 2) / M, rel=1e-4)
    g = solution.gains.astype(complex)
    w = np.where(numbers == 0, 1.0, solution.quiet_weight)
    rest = np.where(numbers == 0, pressure, 0.0) * np.exp(1j * solution.asked_phases) - B @ g
    objective = ((w * np.abs(rest) ** 2).sum() + solution.mu * np.vdot(g, g).real) / 2.0
    assert solution.objective == pytest.approx(objective, rel=1e-3)
    assert solution.bound <= solution.objective <= 1.01 * solution.bound
    told = session.certify(solution.gains)
    assert told.objective == pytest.approx(objective, rel=1e-6)
    assert told.bound == pytest.approx(solution.bound, rel=1e-3)


def test_the_next_solve_continues_with_it_until_it_is_no_longer_needed(session: pc.Session) -> None:
    first = solve_bars(session, 0.010, pressure=100.0)
    assert first.quiet_weight > 0.04
    moved = solve_bars(session, 0.010, 2e-4, 100.0)
    assert moved.quiet_weight == pytest.approx(first.quiet_weight)
    assert moved.iterations <= 2
    for _ in range(3):
        apart = solve_bars(session, 0.018, pressure=100.0)
    assert apart.quiet_weight == pytest.approx(0.02)


def test_without_silent_samples_nothing_changes(session: pc.Session) -> None:
    points, numbers = find_bars(0.010)
    solution = session.solve(points[numbers == 0], 600.0, regions=numbers[numbers == 0])
    assert solution.quiet_weight == pytest.approx(0.02)
    assert find_last_factor(solution) == find_last_factor(None) == 1.0


@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.sampled_from([0.0, 0.004, 0.02, 1.0]))
def test_the_loudest_silent_sample(seed: int, M: int, near: float) -> None:
    """The kernel agrees with NumPy; isolated points (-1) count as neither."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.02, 0.02, (M, 3))
    numbers = rng.integers(-2, 3, M)
    p = np.where(numbers >= 0, rng.normal(size=M) + 1j * rng.normal(size=M), 0.0)
    made = rng.normal(size=(2, M))
    loudest = 0.0
    inside = numbers >= 0
    for m in np.flatnonzero(numbers == BESIDE):
        distance = np.where(inside, np.linalg.norm(points - points[m], axis=1), np.inf)
        nearest = int(distance.argmin())
        if near <= distance[nearest] < np.inf:
            mean = np.mean(np.abs(p[numbers == numbers[nearest]]) ** 2)
            loudest = max(loudest, float(np.sum(made[:, m] ** 2) / mean))
    assert_allclose(find_loudest(points, numbers, p, made, near), loudest, rtol=1e-12)


def test_regions_without_targets_are_no_measure() -> None:
    points = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]])
    numbers = np.array([0, BESIDE])
    assert find_loudest(points, numbers, np.zeros(2, complex), np.ones((2, 2)), 0.004) == 0.0


@given(st.floats(1.0, MAX_FACTOR), st.floats(0.0, 1e6), st.floats(0.0, 1.0))
def test_the_next_factor(factor: float, loudness: float, saturation: float) -> None:
    """It moves towards silence where that is too loud, towards 1 where it is quiet, and else stays."""
    changed, limit = adapt_factor(factor, loudness, saturation), find_max_loudness(saturation)
    assert 1.0 <= changed <= MAX_FACTOR
    if changed > factor:
        assert loudness > limit
    elif changed < factor:
        assert loudness < limit
    if changed != factor:
        assert max(changed / factor, factor / changed) > MIN_CHANGE
    assert adapt_factor(factor, limit, saturation) == factor


def test_it_has_limits() -> None:
    assert adapt_factor(1.0, 1e9, 0.0) == MAX_FACTOR
    assert adapt_factor(MAX_FACTOR, 0.0, 0.0) == 1.0


def test_an_array_at_its_limit_may_be_louder() -> None:
    assert (
        find_max_loudness(0.0)
        < find_max_loudness(0.03)
        < find_max_loudness(0.1)
        == find_max_loudness(1.0)
    )
    assert adapt_factor(1.0, 1.0, 0.0) > adapt_factor(1.0, 1.0, 0.1) == 1.0
