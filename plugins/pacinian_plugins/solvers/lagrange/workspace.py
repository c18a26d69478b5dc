"""Space for the kernels: made once for M samples and N transducers, used again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.solving import TILE

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats, Indices, Singles

PACE, LONG = (
    5e9,
    1e-3,
)  # M M N of a Newton step in a second, about; what is shorter need not be foreseen [s]
SMALL = 16  # samples up to which `small.begin` solves for the start


@dataclass(frozen=True, eq=False)
class Workspace:
    """Space for the kernels, for M samples and N transducers: made once."""

    p: Complexes  # targets, (M,)
    free: Flags  # where their phase is, (M,)
    y: Complexes  # multipliers, (M,)
    L: Complexes  # a factor of the Gram matrix of few samples
    h: Singles  # gains and |x_n|, (3, N)
    spare: Singles  # others, to come back to
    other: Singles
    made: Floats  # pressures, (2, M)
    A: Floats  # a system of up to 2 M equations
    tile: Singles  # as in `passes`
    V: Singles  # columns for the systems
    W: Singles  # steps of gains, (7, N)
    held: Flags  # (N,)
    which: Indices  # of transducers in a tile
    found: Floats  # see `descend`, `nearest`, `attempt`

    @classmethod
    def of(cls, M: int, N: int) -> Workspace:
        """Room for M samples, each of them two equations."""
        K = 2 * M + 4
        return cls(
            np.zeros(M, np.complex128),
            np.zeros(M, np.bool_),
            np.zeros(M, np.complex128),
            np.zeros((min(M, SMALL), min(M, SMALL)), np.complex128),
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
    """Whether a Newton step of so much `work`, M M N, is short, or would come in time: else it is not to be begun."""
    return work <= LONG * PACE or budget.affords(work / PACE)
