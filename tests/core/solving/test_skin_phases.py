"""Phases on skin, relaxed from those of a wave, against the same steps in double precision, and their cost."""

from __future__ import annotations

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.solving.phases import choose_phases
from pacinian.solving.propagator import Propagator
from pacinian.solving.region_phases import settle_phases
from pacinian.solving.skin_phases import (
    BESIDE_WEIGHT,
    DAMPING,
    MAX_COLD_STEPS,
    MAX_PHASE_STEP,
    MAX_SAMPLES,
    MAX_WARM_STEPS,
    MIN_AMPLITUDE,
    REGION_MU,
    relax_phases,
)
from pacinian.solving.targets import Targets

AIR, ARRAY = pc.Air(), pc.autd()  # all transducers count
K = AIR.wavenumber(ARRAY.transducer.frequency)
ASIDE = 0.1, 0.05, 0.0  # source of a poor wave, relative to the array's centre [m]


def bulge(count: int, silent: int = 0) -> tuple[Propagator, Targets, np.ndarray]:
    """Return skin curved like a fingertip, with lower targets towards its rim, and the phases of a poor wave."""
    rng = np.random.default_rng(count)
    aside = rng.uniform(-0.006, 0.006, (count + silent, 2))
    aside[count:] *= 2.0
    away = (aside**2).sum(axis=1)
    normals = np.column_stack([aside / 0.01, -np.sqrt(np.maximum(1.0 - away / 1e-4, 0.01))])
    q = ARRAY.centre + np.column_stack([aside, 0.15 + away / 0.02])
    propagator = Propagator(ARRAY, AIR)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    propagator.set_points(q, SkinFacing(normals, np.empty((0, 8))))
    t = 100.0 * np.sqrt(np.maximum(1.0 - away / 7.2e-5, 0.0))
    t[count:] = 0.0
    regions = np.repeat([0, -2], [count, silent])
    return (
        propagator,
        Targets.make_checked(len(t), t, None, "exact", regions),
        -K * np.linalg.norm(q - ARRAY.centre - ASIDE, axis=1),
    )


def inverse(propagator: Propagator, targets: Targets) -> np.ndarray:
    B = propagator.B.astype(complex)
    G = B @ B.conj().T
    return np.linalg.inv(
        np.diag(np.where(targets.beside, 1.0 / BESIDE_WEIGHT, 1.0))
        + G / (REGION_MU * G.diagonal().real.mean())
    )


def cost(R: np.ndarray, targets: Targets, phases: np.ndarray) -> float:
    p = targets.amplitudes * np.exp(1j * phases)
    return float(np.vdot(p, R @ p).real)


def relaxed(R: np.ndarray, targets: Targets, phases: np.ndarray, steps: int) -> np.ndarray:
    """Return the same steps, computed in double precision."""
    size, own = targets.amplitudes / targets.amplitudes.max(), targets.amplitudes > 0.0
    for _ in range(steps):
        p = size * np.exp(1j * phases)
        A = (p[own].conj()[:, None] * R[np.ix_(own, own)] * p[own]).real
        A += DAMPING * np.diag(np.maximum(size[own], MIN_AMPLITUDE) ** 2)
        step = np.linalg.solve(A, -(p.conj() * (R @ p))[own].imag)
        phases = phases.copy()
        phases[own] += step * min(1.0, MAX_PHASE_STEP / np.abs(step).max())
    return phases


def off(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest difference of angles [rad]."""
    return float(np.abs(np.angle(np.exp(1j * (a - b)))).max())


@pytest.mark.parametrize(("count", "silent"), [(8, 0), (40, 0), (40, 20), (120, 30)])
def test_the_steps_are_those_of_double_precision(count: int, silent: int) -> None:
    propagator, targets, wave = bulge(count, silent)
    R = inverse(propagator, targets)
    found = relax_phases(propagator, targets, wave, None)
    wanted = relaxed(R, targets, wave, MAX_COLD_STEPS)
    assert cost(R, targets, found) == pytest.approx(cost(R, targets, wanted), rel=0.02)
    assert cost(R, targets, found) < 0.9 * cost(R, targets, wave)
    strong = targets.amplitudes > 0.3 * targets.amplitudes.max()
    assert off(found[strong], wanted[strong]) < 0.1


def test_the_gradient_is_that_of_the_cost() -> None:
    """At phases where no step reduces the cost, no small change of one phase does either."""
    propagator, targets, wave = bulge(30)
    R = inverse(propagator, targets)
    phases = relaxed(R, targets, wave, 300)
    least = cost(R, targets, phases)
    for m in range(30):
        for turn in (-0.01, 0.01):
            turned = phases.copy()
            turned[m] += turn
            assert cost(R, targets, turned) >= least * (1.0 - 1e-9)


def test_steps_go_on_from_the_last_phases_if_these_cost_less() -> None:
    propagator, targets, wave = bulge(60, 20)
    R = inverse(propagator, targets)
    first = relax_phases(propagator, targets, wave, None)
    second = relax_phases(propagator, targets, wave, first)
    assert cost(R, targets, second) < cost(R, targets, first)
    assert off(second, relaxed(R, targets, first, MAX_WARM_STEPS)) < 0.1
    rng = np.random.default_rng(0)
    assert np.array_equal(
        relax_phases(propagator, targets, wave, rng.uniform(-3.0, 3.0, 80)), first
    )


def test_given_phases_isolated_points_and_silence_keep_theirs() -> None:
    propagator, targets, wave = bulge(40, 10)
    regions, given = targets.regions, np.full(50, np.nan)
    assert regions is not None
    regions = regions.copy()
    regions[:5], given[5:9] = -1, 0.3
    targets = Targets.make_checked(50, targets.amplitudes, given, "exact", regions)
    found = relax_phases(propagator, targets, wave, None)
    changed = found != wave
    assert changed[9:40].all()
    assert not changed[:9].any()
    assert not changed[40:].any()
    settled = settle_phases(propagator, targets, None)
    assert (settled.phases[5:9] == 0.3).all()
    assert choose_phases(propagator, settled, None)[5:9] == pytest.approx(
        targets.amplitudes[5:9] * np.exp(0.3j)
    )


def test_where_nothing_can_relax_the_wave_stays() -> None:
    for count in (1, 2):
        propagator, targets, wave = bulge(count)
        assert relax_phases(propagator, targets, wave, None) is wave
    propagator, targets, wave = bulge(20)
    silent = Targets.make_checked(20, np.zeros(20), None, "exact", np.zeros(20, int))
    assert relax_phases(propagator, silent, wave, None) is wave
    propagator, targets, wave = bulge(MAX_SAMPLES + 1)
    assert relax_phases(propagator, targets, wave, None) is wave
    propagator, targets, wave = bulge(20)
    propagator.set_points(
        propagator.points, SkinFacing(np.tile([0.0, 0.0, 1.0], (20, 1)), np.empty((0, 8)))
    )
    assert relax_phases(propagator, targets, wave, None) is wave  # no sound reaches it
