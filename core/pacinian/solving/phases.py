"""Choose the phases of targets whose phase is free, because people feel amplitude, not phase."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes, Flags, Floats


# Gerchberg-Saxton steps from scratch, and from the phases of the last solution.
COLD_STEPS, WARM_STEPS = 20, 3


def gerchberg_saxton(
    gram: Complexes, targets: Targets, start: Floats | None = None, steps: int = COLD_STEPS
) -> Complexes:
    """Return complex targets, (M,) [Pa], with phases chosen by Gerchberg-Saxton steps on the Gram matrix.

    One step propagates the targets back to the array and forth again: p <- |t| exp(j arg(G p)), G = B B^H. This is the
    classical iteration in M unknowns instead of N (Plasencia et al., GS-PAT, ACM TOG 2020). It approaches the phases
    for which the array needs the least power. Fixed phases do not change.

    gram: (M, M). start: initial phases [rad], (M,); quadratic ones by default.
    """
    start = _make_spread_phases(len(gram)) if start is None else start
    p, free = np.empty(len(gram), np.complex128), np.empty(len(gram), np.bool_)
    kernels.choose_phases(gram, targets.amplitudes, targets.phases, start, steps, p, free)
    return p


@functools.lru_cache(maxsize=64)
def _make_spread_phases(count: int) -> Floats:
    """Return initial phases [rad], (count,). They are spread out, because equal phases may be a saddle point."""
    m = np.arange(count)
    start = np.pi * m * m / max(1, count)
    start.flags.writeable = False
    return start


def choose_phases(propagator: Propagator, targets: Targets, start: Floats | None) -> Complexes:
    """Return complex targets, (M,) [Pa]; chooses the free phases and keeps the others."""
    p, free = np.empty(len(targets.amplitudes), np.complex128), np.empty_like(targets.free)
    choose_phases_into(propagator, targets, start, p, free)
    return p


def choose_phases_into(
    propagator: Propagator, targets: Targets, start: Floats | None, p: Complexes, free: Flags
) -> float:
    """Like `choose_phases`, but write the targets to p, and to `free`, (M,), where the phase is free and t > 0.

    Returns ||t||.
    """
    if not targets.free.any():
        p[:], free[:] = targets.complex(targets.phases), False
        return targets.norm
    first, steps = initial_phases(len(p), start)
    if len(p) > len(propagator.array):
        return _choose_tall(propagator, targets, first, steps, p, free)
    return float(
        kernels.choose_phases(
            propagator.gram, targets.amplitudes, targets.phases, first, steps, p, free
        )
    )


def _choose_tall(
    propagator: Propagator, targets: Targets, start: Floats, steps: int, p: Complexes, free: Flags
) -> float:
    """Take the same steps by products with B and B^H, because there are fewer transducers than points."""
    p[:], free[:] = targets.complex(start), targets.free & (targets.amplitudes > 0.0)
    for _ in range(steps):
        q = propagator.apply(propagator.adjoint(p))
        chosen = free & (q != 0.0)
        p[chosen] = targets.amplitudes[chosen] * np.exp(1j * np.angle(q[chosen]))
    return targets.norm


def initial_phases(count: int, start: Floats | None) -> tuple[Floats, int]:
    """Return initial phases [rad], (count,), and the number of steps to take from there."""
    return (_make_spread_phases(count), COLD_STEPS) if start is None else (start, WARM_STEPS)
