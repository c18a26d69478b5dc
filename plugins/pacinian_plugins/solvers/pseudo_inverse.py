"""Equation (9) made safe: least squares, of those the least gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from scipy import linalg

import pacinian as pc
from pacinian.checks import number
from pacinian.solving.phases import choose
from pacinian.solving.propagator import cholesky, gram

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes

# Below this reciprocal condition number the smaller Gram matrix has lost too much: decompose B itself.
TRUSTED = {np.dtype(np.complex64): 1e-5, np.dtype(np.complex128): 1e-10}


@dataclass(frozen=True)
class PseudoInverse(pc.Solver):
    """min ||B g - p||, of those min ||g||: the paper's equation (9), safe for any rank.

    rcond: singular values below this share of the largest count as zero; None for
    max(M, N) times the precision of B.

    Well-conditioned problems go through the Cholesky factor of the smaller Gram matrix (B B^H for
    M <= N, B^H B else) with one step of refinement; others through a singular value decomposition of B
    in double precision. Free phases are chosen by Gerchberg-Saxton on B B^H. It knows no gain limit:
    the session scales its answer down as a whole.
    """

    name: ClassVar[str] = "pseudo-inverse"

    rcond: float | None = None

    def __post_init__(self) -> None:
        if self.rcond is not None:
            object.__setattr__(self, "rcond", number("rcond", self.rcond, low=0.0, high=1.0))

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the least-squares gains; see `pacinian.Solver.solve`."""
        p = choose(propagator, targets, None if warm is None else np.angle(warm.sound_pressure))
        scale = float(np.abs(p).max())  # so that neither tiny nor huge targets leave the range
        g, note = self._least_squares(propagator, p / scale)
        with np.errstate(over="ignore", under="ignore"):
            g *= scale
            peak = float(np.abs(g).max())
            # complex64 ends at 3e38; the session scales anyway
            out[:] = g if peak < 1e37 else g * (1e37 / peak)
        return pc.Result(note=note)

    def _least_squares(self, propagator: pc.Propagator, p: Complexes) -> tuple[Complexes, str]:
        B = propagator.B
        M, N = B.shape
        wide = M <= N
        trusted = TRUSTED[B.dtype]
        if self.rcond is None or self.rcond**2 < trusted:
            factor = propagator.factor(0.0) if wide else cholesky(gram(B.conj().T.copy()), 0.0)
            if factor.reciprocal_condition > trusted:
                if wide:
                    g = propagator.adjoint(factor.solve(p))
                    g = g + propagator.adjoint(factor.solve(p - propagator.apply(g)))
                else:
                    g = factor.solve(propagator.adjoint(p))
                    g = g + factor.solve(propagator.adjoint(p - propagator.apply(g)))
                return g.astype(np.complex128), "Cholesky"
        rcond = self.rcond
        if rcond is None:
            rcond = max(M, N) * float(np.finfo(B.dtype).eps)
        g, _, rank, _ = linalg.lstsq(B.astype(np.complex128), p, cond=rcond, lapack_driver="gelsd")
        return g, f"singular values: rank {rank} of {min(M, N)}"


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [PseudoInverse]
