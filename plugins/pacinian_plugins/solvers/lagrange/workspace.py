"""Workspace of the kernels, allocated once for M samples and N transducers and reused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.solving import TILE

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats, Indices, Singles

# approximate speed of Newton steps [M M N / s]; duration up to which steps are always started [s]
PACE, MIN_TIME = 5e9, 1e-3
MAX_BEGIN_SAMPLES = 16  # samples up to which the kernel `begin` computes the start


@dataclass(frozen=True, eq=False)
class Workspace:
    """Workspace of the kernels for M samples and N transducers."""

    p: Complexes  # targets, (M,)
    free: Flags  # where their phase is, (M,)
    y: Complexes  # multipliers, (M,)
    L: Complexes  # a factor of the Gram matrix of few samples
    h: Singles  # gains and |x_n|, (3, N)
    spare: Singles  # saved copy of h, (3, N)
    other: Singles  # second saved copy of h, (3, N)
    made: Floats  # pressures, (2, M)
    A: Floats  # matrix of a system of up to 2 M equations
    tile: Singles  # see fused_passes.hpp
    V: Singles  # columns for the systems
    W: Singles  # steps of the gains, (7, N)
    held: Flags  # transducers at their limit, (N,)
    which: Indices  # indices of transducers in a tile
    found: Floats  # outputs of the kernels; see `descend`, `nearest`, `attempt`

    @classmethod
    def of(cls, M: int, N: int) -> Workspace:
        """Allocate the workspace for M samples with up to two equations each."""
        K = 2 * M + 4
        return cls(
            np.zeros(M, np.complex128),
            np.zeros(M, np.bool_),
            np.zeros(M, np.complex128),
            np.zeros((min(M, MAX_BEGIN_SAMPLES), min(M, MAX_BEGIN_SAMPLES)), np.complex128),
            np.zeros((3, N), np.float32),
            np.zeros((3, N), np.float32),
            np.zeros((3, N), np.float32),
            np.zeros((2, M)),
            np.zeros((K, K)),
            np.zeros((2, M + -M % 4, TILE), np.float32),
            np.zeros((K, 2 * TILE), np.float32),
            np.zeros((7, N), np.float32),
            np.zeros(N, np.bool_),
            np.zeros(TILE, np.int64),
            np.zeros(8),
        )


def in_time(budget: pc.Budget, work: int) -> bool:
    """Return whether a Newton step of `work` M M N is short or fits in the budget; if not, do not start it."""
    return work <= MIN_TIME * PACE or budget.affords(work / PACE)
