"""Solving for skin: the pressure along the normals meets the targets, from whichever side this needs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.intensity import intensity, normal_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.plugins.registry import discover_plugins
from pacinian.scene.hands.capsules import find_closest, make_capsules
from pacinian.scene.hands.hand import Hand

SOLVERS = [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
EXACT = ["auto", "lagrange", "lbfgs"]
AIR = pc.Air()
BELOW = pc.lattice(0.09, 0.09)
ARRAY = BELOW + BELOW.transform(pc.Pose((0.0, 0.0, 0.3)).rotate("x", math.pi))
WALL = [[-1.0, 0.0, 0.15, 1.0, 0.0, 0.15, 0.02, 0.02]]  # between the halves


def skin(count: int, seed: int = 0) -> tuple[Any, SkinFacing]:
    """Return points on the wall, some facing up and some down."""
    rng = np.random.default_rng(seed)
    side = np.where(rng.uniform(size=count) < 0.5, -1.0, 1.0)
    tilt = rng.uniform(-0.5, 0.5, count)
    n = np.c_[np.zeros(count), np.sin(tilt), side * np.cos(tilt)]
    x = rng.uniform(-0.05, 0.05, count)
    return np.c_[x, np.zeros(count), np.full(count, 0.15)] + 0.02 * n, SkinFacing(n, WALL)


def weighted(q: Any, facing: SkinFacing) -> Any:
    return pc.matrix(ARRAY, q, pc.Air()) * facing.weights(q, ARRAY.positions)


@pytest.mark.parametrize("solver", SOLVERS)
@given(
    count=st.integers(0, 8),
    seed=st.integers(0, 1000),
    level=st.sampled_from([1e-3, 1.0, 30.0, 1e6]),
    hidden=st.booleans(),
)
@settings(max_examples=20)
def test_gains_are_within_the_limit_and_the_evidence_is_theirs(
    solver: str, count: int, seed: int, level: float, hidden: bool
) -> None:
    q, facing = skin(count, seed)
    n = facing.normals.copy()
    if hidden:
        n[:1] *= -1.0  # faces into the wall
    facing = SkinFacing(n, WALL)
    t = np.random.default_rng(seed).uniform(0.1, 1.0, count) * level
    solution = pc.solve(ARRAY, q, t, solver=solver, facing=facing)
    g = solution.gains.astype(np.complex128)
    assert np.isfinite(g).all()
    assert (g.real**2 + g.imag**2 <= 1.0).all()
    B = weighted(q, facing)
    np.testing.assert_allclose(
        solution.sound_pressure,
        B @ g,
        atol=1e-4 * np.abs(pc.matrix(ARRAY, q, pc.Air())).sum() + 1e-30,
    )
    assert (B.any(axis=1) == (np.arange(count) > 0) | (not hidden)).all()
    if count and hidden:
        assert solution.status is pc.Status.unreachable
        assert solution.error > 0.0


@pytest.mark.parametrize("solver", EXACT)
@pytest.mark.parametrize("precision", ["single", "double"])
def test_what_is_asked_presses_along_the_normals(
    solver: str, precision: pc.acoustics.propagation.Precision
) -> None:
    q, facing = skin(5)
    P = np.array([0.3, 0.1, 0.2, 0.4, 0.2]) * 1e-3  # [Pa]
    solution = pc.solve(
        ARRAY, q, pc.sound_pressure(P, AIR), solver=solver, facing=facing, precision=precision
    )
    assert solution.status is pc.Status.ok
    np.testing.assert_allclose(
        normal_pressure(ARRAY, solution.gains, q, facing, medium=pc.Air()), P, rtol=5e-3
    )


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_no_sound_reaches_is_said_and_the_rest_is_served(solver: str) -> None:
    q = np.array([[0.0, 0.0, 0.13], [0.0, 0.0, 0.17]])
    facing = SkinFacing([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], WALL)
    one = pc.solve(BELOW, q, [20.0, 20.0], solver=solver, facing=facing)
    assert one.status is pc.Status.unreachable
    assert np.isfinite(one.gains).all()
    assert abs(one.sound_pressure[1]) == 0.0
    assert one.error >= np.sqrt(0.5) - 1e-3
    nothing = pc.solve(BELOW, q[1:], [20.0], solver=solver, facing=facing.only(slice(1, 2)))
    assert nothing.status is pc.Status.unreachable
    assert nothing.error == pytest.approx(1.0)


def test_a_session_keeps_what_has_not_changed() -> None:
    q, facing = skin(6)
    t = np.full(6, 5.0)
    session = pc.Session(ARRAY)
    work = session.propagator.work
    first = session.solve(q, t, facing=facing)
    session.solve(q, t, facing=SkinFacing(facing.normals, WALL))
    assert (work.solutions_kept, work.rows_built) == (1, 6)
    session.solve(q, 0.5 * t, facing=facing)
    assert work.solutions_scaled == 1
    free = session.solve(q, t)
    assert work.rows_built == 12
    np.testing.assert_allclose(np.abs(pc.matrix(ARRAY, q, pc.Air()) @ free.gains), t, rtol=2e-3)
    again = session.solve(q, t, facing=facing)
    assert work.rows_built == 18
    assert again.error == pytest.approx(first.error, abs=1e-3)
    turned = SkinFacing(-facing.normals, WALL)
    assert session.solve(q, t, facing=turned).status is pc.Status.unreachable


def test_a_certificate_is_of_what_presses() -> None:
    q, facing = skin(4)
    session = pc.Session(ARRAY, solver="lagrange")
    solved = session.solve(q, np.full(4, 30.0), facing=facing)
    same = session.certify(solved.gains)
    np.testing.assert_allclose(same.sound_pressure, weighted(q, facing) @ solved.gains)
    assert same.status is solved.status
    assert same.error == pytest.approx(solved.error, abs=1e-4)
    assert same.bound <= same.objective + 1e-7 * 30.0**2 * 4


def test_bad_arguments_are_named() -> None:
    q, facing = skin(4)
    for bad in (facing.normals, "up", facing.only(slice(3))):
        with pytest.raises(pc.ArgumentError, match="facing"):
            pc.solve(ARRAY, q, np.ones(4), facing=bad)  # type: ignore[arg-type]
    session = pc.Session(ARRAY)
    with pytest.raises(pc.ArgumentError, match="facing"):
        session.solve(q, np.ones(4), facing=facing.only(slice(3)))
    assert session.solve(q, np.ones(4), facing=facing).status is pc.Status.ok


@pytest.mark.parametrize("back", [0.0, 5.0])
def test_each_side_of_a_hand_between_two_units_is_pressed_as_asked(back: float) -> None:
    """One unit is below a flat hand, one above: 20 Pa at four points of the palm, `back` on the back.

    Without facing, the free field meets the targets, but over a third of the drive comes from the wrong
    side, and the palm gets less than half of its target.
    """
    array = pc.autd() + pc.autd().transform(pc.Pose((0.0, 0.0, 0.4)).rotate("x", math.pi))
    hand = make_capsules(Hand.open(pose=pc.Pose((0.0, 0.0, 0.2))))
    x, y = np.meshgrid([-0.02, 0.02], [-0.02, 0.03])
    under, over = (
        find_closest(hand, np.c_[x.ravel(), y.ravel(), np.full(4, z)]) for z in (0.15, 0.25)
    )
    q, n = np.r_[under.points, over.points], np.r_[under.normals, over.normals]
    facing, P = SkinFacing(n, hand), np.r_[np.full(4, 20.0), np.full(4, back)]
    with_, without = (
        pc.solve(array, q, pc.sound_pressure(P, AIR), facing=given) for given in (facing, None)
    )
    assert with_.status is without.status is pc.Status.ok
    pressed = normal_pressure(array, with_.gains, q, facing, medium=pc.Air())
    np.testing.assert_allclose(pressed, P, rtol=2e-3, atol=2e-3)
    missed = normal_pressure(array, without.gains, q, facing, medium=pc.Air())
    assert (missed[:4] < 0.45 * P[:4]).all()
    if back == 0.0:
        assert missed[4:].mean() > 0.03 * 20.0  # where the target is 0
    above = [
        (np.abs(s.gains[249:]) ** 2).sum() / (np.abs(s.gains) ** 2).sum() for s in (with_, without)
    ]
    assert above[0] < (1e-3 if back == 0.0 else 0.25)
    assert above[1] > 0.35
    flow = (intensity(array, with_.gains, q, facing=facing, medium=pc.Air()) * n).sum(axis=1)
    assert (flow[:4] < 0.0).all()  # into the palm
    E = -flow[:4] / AIR.speed_of_sound  # waves arrive nearly head-on, so P is about 2 E
    np.testing.assert_allclose(2.0 * E, P[:4], rtol=0.2)
