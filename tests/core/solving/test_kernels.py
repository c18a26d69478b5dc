"""The kernels of the small space give what plain NumPy gives."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacinian.native import solving as kernels
from pacinian.solving.phases import gerchberg_saxton
from pacinian.solving.targets import Targets


def hermitian(M: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    B = rng.normal(size=(M, 3 * M)) + 1j * rng.normal(size=(M, 3 * M))
    return B @ B.conj().T


@given(M=st.integers(1, 12), steps=st.integers(0, 9), seed=st.integers(0, 99))
def test_gerchberg_saxton_steps(M: int, steps: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    G, free = hermitian(M, seed), rng.random(M) < 0.7
    p = rng.normal(size=M) + 1j * rng.normal(size=M)
    made, plain = p.copy(), p.copy()
    kernels.gerchberg_saxton(G, free, steps, made)
    for _ in range(steps):
        q = G @ plain
        plain = np.where(free, np.abs(p) * np.exp(1j * np.angle(q)), plain)
    np.testing.assert_allclose(made, plain, atol=1e-9 * np.abs(p).max())


@given(M=st.integers(2, 12), seed=st.integers(0, 99))
def test_gerchberg_saxton_climbs_towards_less_power_per_pressure(M: int, seed: int) -> None:
    G = hermitian(M, seed)
    targets = Targets(np.random.default_rng(seed).uniform(0.1, 1, M), np.full(M, np.nan))
    value = [
        np.vdot(p, G @ p).real for p in (gerchberg_saxton(G, targets, None, n) for n in range(6))
    ]
    assert all(after >= before * (1 - 1e-12) for before, after in itertools.pairwise(value))


def test_a_point_that_nothing_reaches_keeps_its_phase() -> None:
    G = np.zeros((2, 2), dtype=np.complex128)
    p = np.array([1j, 2.0 + 0j])
    kernels.gerchberg_saxton(G, np.array([True, True]), 3, p)
    np.testing.assert_array_equal(p, [1j, 2.0])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, complex(0, np.nan), complex(np.inf, 1)])
def test_the_peak_is_nan_where_a_gain_is_not_finite(bad: complex) -> None:
    g = np.ones(100, dtype=np.complex64)
    assert kernels.peak(g) == 1.0
    g[57] = bad
    assert np.isnan(kernels.peak(g))


@given(seed=st.integers(0, 99), factor=st.floats(0.01, 10), highest=st.floats(0.1, 2))
def test_restrained_gains_are_scaled_and_shortened(
    seed: int, factor: float, highest: float
) -> None:
    rng = np.random.default_rng(seed)
    g = (rng.normal(size=64) + 1j * rng.normal(size=64)).astype(np.complex64)
    made = g.copy()
    kernels.limit_gains(made, factor, highest)
    plain = factor * g.astype(np.complex128)
    plain *= np.minimum(1.0, highest / np.abs(plain))
    np.testing.assert_allclose(made, plain, rtol=1e-6, atol=1e-30)
