"""Phases of regions on skin: those of a wave, relaxed until the array meets the amplitudes as nearly as it can.

Skin curves, and a contact's pressure falls to nothing at its rim. There, the phases of one wave are only a start. With
phases phi, the regularised least squares of the targets p = t exp(j phi) leave the cost

    E(phi) = 1/2 p^H R p,    R = (D + B B^H / mu)^-1,

where D is 1 over the weights of the squared errors. The gradient with respect to phi_m is Im(conj(p_m) (R p)_m). The
steps divide it by Re(conj(p_m) R_mn p_n), the part of the second derivative that is never negative. Some of the
transducers suffice for B B^H.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.linalg import lapack
from pacinian.solving.propagator import gram_matrix, mean_square

if TYPE_CHECKING:
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes, Flags, Floats, Singles

# Of the least squares for targets with regions. Solvers for regions minimise the cost that the phases minimise, so they
# use the same weights, and the same mu unless an option changes it.
REGION_MU = 5e-3  # regularisation mu, relative to trace(B B^H) / M
BESIDE_WEIGHT = 0.02  # weight of the squared errors of points beside regions; other points have 1
MAX_TRANSDUCERS = 500  # largest number of transducers that represent the array in B B^H
MAX_SAMPLES = 480  # largest number of samples whose phases are relaxed
# Largest number of steps from the phases of the wave, and from those of the last solution.
MAX_COLD_STEPS, MAX_WARM_STEPS = 10, 2
DAMPING = 3e-3  # damping of the steps, relative to a sample's squared amplitude
# Amplitude, relative to the largest, below which damping no longer falls.
MIN_AMPLITUDE = 0.03
MAX_PHASE_STEP = 0.5  # longest step of a phase [rad]


def relax_phases(
    propagator: Propagator, targets: Targets, wave: Floats, before: Floats | None
) -> Floats:
    """Return relaxed phases of the targets, (M,) [rad]; those given, of isolated points and of silence do not change.

    wave: phases to start from, (M,). before: those of the last solution at the same points, (M,), from which the steps
    start instead where that costs less.
    """
    regions = targets.regions
    assert regions is not None
    t, own = targets.amplitudes, (regions >= 0) & targets.free & (targets.amplitudes > 0.0)
    M = len(t)
    if not 2 < M <= MAX_SAMPLES or np.count_nonzero(own) < 2:
        return wave
    with limit_blas_threads(propagator.B.size):
        R = _invert(propagator, targets.beside)
        if R is None:
            return wave
        size = np.asarray(t / t.max(), np.float32)
        start, steps = wave, MAX_COLD_STEPS
        if before is not None:
            last = np.where(own, before, wave)
            if _cost(R, size, last) < _cost(R, size, wave):
                start, steps = last, MAX_WARM_STEPS
        return _step(R, size, own, start, steps)


def _invert(propagator: Propagator, beside: Flags) -> Complexes | None:
    """Return R, (M, M), in single precision; None if rounding prevents that."""
    B, N = propagator.B, len(propagator.array)
    some = np.ascontiguousarray(B[:, :: -(-N // MAX_TRANSDUCERS)])
    G = gram_matrix(some)
    mean = mean_square(G)
    if not 0.0 < mean < np.inf:
        return None
    A = np.asarray(G / (REGION_MU * mean), np.complex64, order="F")
    A.T.reshape(-1)[:: len(A) + 1] += np.where(beside, 1.0 / BESIDE_WEIGHT, 1.0)
    A, failed = lapack.cpotrf(A, clean=0, overwrite_a=1)
    if failed:
        return None
    A, failed = lapack.cpotri(A, overwrite_c=1)
    if failed or not np.isfinite(A.diagonal().real).all():
        return None
    upper = np.triu(A)
    upper += np.triu(A, 1).conj().T
    return np.asarray(upper)


def _turn(size: Singles, phases: Floats) -> Complexes:
    return np.asarray(size * np.exp(1j * phases), np.complex64)


def _cost(R: Complexes, size: Singles, phases: Floats) -> float:
    p = _turn(size, phases)
    return float(np.vdot(p, R @ p).real)


def _step(R: Complexes, size: Singles, own: Flags, start: Floats, steps: int) -> Floats:
    """Take steps from phases `start`, (M,), as long as the cost falls. own: which may change, (M,)."""
    phases, best, least = start, start, np.inf
    which = np.flatnonzero(own)
    inner = R[np.ix_(which, which)]
    damping = DAMPING * np.maximum(size[own], MIN_AMPLITUDE) ** 2
    for _ in range(steps + 1):
        p = _turn(size, phases)
        y = R @ p
        cost = float(np.vdot(p, y).real)
        if not cost < least:
            break
        best, least = phases, cost
        u = p[own]
        A = np.asarray((u.conj()[:, None] * inner * u).real, np.float32, order="F")
        A.T.reshape(-1)[:: len(A) + 1] += damping
        _, step, failed = lapack.sposv(A, -(u.conj() * y[own]).imag, overwrite_a=1)
        longest = float(np.abs(step).max())
        if failed or not longest < np.inf:
            break
        phases = phases.copy()
        phases[own] += step * min(1.0, MAX_PHASE_STEP / max(longest, MAX_PHASE_STEP))
    return best
