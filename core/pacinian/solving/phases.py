"""Phases for targets whose phase is free: people feel amplitude, not phase."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.solving import kernels

if TYPE_CHECKING:
    from pacinian.solving.problem import Targets
    from pacinian.solving.propagator import Propagator
    from pacinian.types import Complexes, Reals


COLD, WARM = 20, 3  # steps from scratch, and from the phases of the last solution


def gerchberg_saxton(
    gram: Complexes, targets: Targets, start: Reals | None = None, steps: int = COLD
) -> Complexes:
    """Targets [Pa], complex, (M,), with phases chosen by Gerchberg-Saxton steps on the Gram matrix.

    One step sends the targets back to the array and forth again, p <- |t| exp(j arg(G p)), G = B B^H:
    the classical iteration in M unknowns instead of N (Plasencia et al., GS-PAT, ACM TOG 2020).
    It climbs towards phases that the array makes with the least power. Fixed phases stay.

    gram: (M, M). start: phases to start from [rad], (M,); quadratic ones unless given.
    """
    if start is None:
        m = np.arange(len(gram))
        start = np.pi * m * m / max(1, len(gram))  # spread out: equal phases may be a saddle point
    p = targets.complex(start)
    if targets.free.any():
        kernels.gerchberg_saxton(gram, targets.free, steps, p)
    return p


def choose(propagator: Propagator, targets: Targets, start: Reals | None) -> Complexes:
    """Targets [Pa], complex, (M,): given phases kept, free ones chosen."""
    if not targets.free.any():
        return targets.complex(targets.phases)
    return gerchberg_saxton(propagator.gram, targets, start, COLD if start is None else WARM)
