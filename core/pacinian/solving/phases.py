"""Phases for targets whose phase is free: people feel amplitude, not phase."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from pacinian.solving.problem import Targets
    from pacinian.solving.propagator import Propagator
    from pacinian.types import Complexes, Flags, Floats


COLD, WARM = 20, 3  # steps from scratch, and from the phases of the last solution


def gerchberg_saxton(
    gram: Complexes, targets: Targets, start: Floats | None = None, steps: int = COLD
) -> Complexes:
    """Targets [Pa], complex, (M,), with phases chosen by Gerchberg-Saxton steps on the Gram matrix.

    One step sends the targets back to the array and forth again, p <- |t| exp(j arg(G p)), G = B B^H:
    the classical iteration in M unknowns instead of N (Plasencia et al., GS-PAT, ACM TOG 2020).
    It climbs towards phases that the array makes with the least power. Fixed phases stay.

    gram: (M, M). start: phases to start from [rad], (M,); quadratic ones unless given.
    """
    start = _spread(len(gram)) if start is None else start
    p, free = np.empty(len(gram), np.complex128), np.empty(len(gram), np.bool_)
    kernels.choose(gram, targets.amplitudes, targets.phases, start, steps, p, free)
    return p


@functools.lru_cache(maxsize=64)
def _spread(count: int) -> Floats:
    """Phases to start from [rad]: spread out, as equal ones may be a saddle point."""
    m = np.arange(count)
    start = np.pi * m * m / max(1, count)
    start.flags.writeable = False
    return start


def choose_phases(propagator: Propagator, targets: Targets, start: Floats | None) -> Complexes:
    """Targets [Pa], complex, (M,): given phases kept, free ones chosen."""
    p, free = np.empty(len(targets.amplitudes), np.complex128), np.empty_like(targets.free)
    choose_phases_into(propagator, targets, start, p, free)
    return p


def choose_phases_into(
    propagator: Propagator, targets: Targets, start: Floats | None, p: Complexes, free: Flags
) -> float:
    """As `choose_phases`, into p; and into `free`, (M,), where a phase is free and counts. Returns ||t||."""
    if not targets.free.any():
        p[:], free[:] = targets.complex(targets.phases), False
        return targets.norm
    first, steps = initial_phases(len(p), start)
    if len(p) > len(propagator.array):
        return _choose_tall(propagator, targets, first, steps, p, free)
    return float(
        kernels.choose(propagator.gram, targets.amplitudes, targets.phases, first, steps, p, free)
    )


def _choose_tall(
    propagator: Propagator, targets: Targets, start: Floats, steps: int, p: Complexes, free: Flags
) -> float:
    """The same steps through the transducers, of which there are fewer than points."""
    p[:], free[:] = targets.complex(start), targets.free & (targets.amplitudes > 0.0)
    for _ in range(steps):
        q = propagator.apply(propagator.adjoint(p))
        chosen = free & (q != 0.0)
        p[chosen] = targets.amplitudes[chosen] * np.exp(1j * np.angle(q[chosen]))
    return targets.norm


def initial_phases(count: int, start: Floats | None) -> tuple[Floats, int]:
    """Phases to start from [rad], (count,), and how many steps to take from there."""
    return (_spread(count), COLD) if start is None else (start, WARM)
