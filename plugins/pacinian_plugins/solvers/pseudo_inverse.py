"""Equation (9) made safe: least squares, of those the least gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.checks import check_number
from pacinian.solving.least_squares import LeastSquares
from pacinian.solving.phases import choose_phases

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes

MAX_CHOLESKY_POINTS = (
    256  # samples up to which the propagator's own Cholesky factor is the quickest
)
# and its reciprocal condition number from which it is used
TRUSTED = {np.dtype(np.complex64): 1e-5, np.dtype(np.complex128): 1e-10}


@dataclass(frozen=True)
class PseudoInverse(pc.Solver):
    """min ||B g - p||, of those min ||g||: the paper's equation (9), safe for any rank.

    rcond: singular values below this share of the largest count as zero; None for
    max(M, N) times the precision of B.

    Well-conditioned problems go through the Cholesky factor of the smaller Gram matrix (B B^H for
    M <= N, B^H B else) and steps of refinement; others through a singular value decomposition of B
    in double precision: see `pacinian.solving.least_squares`. Free phases are chosen by
    Gerchberg-Saxton on B B^H. It knows no gain limit: the session scales its answer down as a whole.
    """

    name: ClassVar[str] = "pseudo-inverse"
    linear: ClassVar[bool] = True

    rcond: Annotated[float, Meta(ge=0.0, le=1.0)] | None = None

    def __post_init__(self) -> None:
        if self.rcond is not None:
            object.__setattr__(self, "rcond", check_number("rcond", self.rcond, low=0.0, high=1.0))

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
        if targets.free.any():
            p = choose_phases(propagator, targets, None if warm is None else warm.phases)
        else:
            p = targets.complex(targets.phases)
        scale = float(np.abs(p).max())  # so that neither tiny nor huge targets leave the range
        g, note = self._least_squares(propagator, p / scale)
        with np.errstate(over="ignore", under="ignore"):
            g *= scale
            if out.dtype == np.complex64:  # it ends at 3e38; the session scales anyway
                g /= max(1.0, float(np.abs(g).max()) / 1e37)
            out[:] = g
        return pc.Result(note=note)

    def _least_squares(self, propagator: pc.Propagator, p: Complexes) -> tuple[Complexes, str]:
        B = propagator.B
        M, N = B.shape
        trusted = max(TRUSTED[B.dtype], 3.0 * (self.rcond or 0.0) ** 2)
        if M <= N and M <= MAX_CHOLESKY_POINTS:
            factor = propagator.factor(0.0)
            if factor.reciprocal_condition > trusted:
                g = propagator.adjoint(factor.solve(p))
                g = g + propagator.adjoint(factor.solve(p - propagator.apply(g)))
                return g.astype(np.complex128), f"Cholesky: rank {M} of {M}"
        return LeastSquares.of(B, self.rcond).solve(p)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [PseudoInverse]
