"""The paper's equation (9), made numerically safe: the least-squares solution of least norm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_number
from pacinian.solving.back_propagation import NO_GRAM_MATRIX, affords_gram, back_propagate
from pacinian.solving.least_squares import LeastSquares
from pacinian.solving.phases import choose_phases

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes

MAX_CHOLESKY_POINTS = 256  # samples up to which the propagator's own Cholesky factor is fastest
# least reciprocal condition number with which that factor is used
MIN_RECIPROCAL_CONDITION = {np.dtype(np.complex64): 1e-5, np.dtype(np.complex128): 1e-10}
HURRIED_MU = 1e-4  # regularisation if the time is short, relative to trace(B B^H) / M


@dataclass(frozen=True)
class PseudoInverse(pc.Solver):
    """min ||B g - p||, and among these min ||g||: the paper's equation (9), safe for any rank.

    rcond: singular values below this share of the largest count as zero; None for
    max(M, N) times the precision of B.

    Well-conditioned problems use the Cholesky factor of the smaller Gram matrix (B B^H for
    M <= N, else B^H B) and steps of refinement. Others use a singular value decomposition of B
    in double precision; see `pacinian.solving.least_squares`. Free phases are chosen by
    Gerchberg-Saxton on B B^H. This solver ignores the gain limit; the session scales its solution down as a whole.
    If the time does not suffice for the decomposition, it regularises B B^H (M <= N), or back-propagates the targets.
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
        if not affords_gram(propagator, budget):
            phases = None if warm is None else warm.phases
            steps = back_propagate(propagator, targets, limits, phases, budget, out)
            return pc.Result(iterations=steps, late=True, note=NO_GRAM_MATRIX)
        if targets.free.any():
            p = choose_phases(propagator, targets, None if warm is None else warm.phases)
        else:
            p = targets.complex(targets.phases)
        scale = float(np.abs(p).max())  # avoids underflow and overflow
        found = self._least_squares(propagator, p / scale, budget)
        g, note = found or _approximate(propagator, p / scale)
        with np.errstate(over="ignore", under="ignore"):
            g *= scale
            if out.dtype == np.complex64:  # overflows at 3e38; the session scales the gains anyway
                g /= max(1.0, float(np.abs(g).max()) / 1e37)
            out[:] = g
        return pc.Result(note=note, late=found is None)

    def _least_squares(
        self, propagator: pc.Propagator, p: Complexes, budget: pc.Budget
    ) -> tuple[Complexes, str] | None:
        B = propagator.B
        M, N = B.shape
        trusted = max(MIN_RECIPROCAL_CONDITION[B.dtype], 3.0 * (self.rcond or 0.0) ** 2)
        if M <= N and M <= MAX_CHOLESKY_POINTS:
            factor = propagator.factor(0.0)
            if factor.reciprocal_condition > trusted:
                g = propagator.adjoint(factor.solve(p))
                g = g + propagator.adjoint(factor.solve(p - propagator.apply(g)))
                return g.astype(np.complex128), f"Cholesky: rank {M} of {M}"
        return LeastSquares.of(B, self.rcond).solve_within(p, budget)


def _approximate(propagator: pc.Propagator, p: Complexes) -> tuple[Complexes, str]:
    """Return gains that take a small part of the time, and a note."""
    M, N = propagator.B.shape
    if M <= N and (factor := propagator.factor(HURRIED_MU * propagator.power)).definite:
        return propagator.adjoint(factor.solve(p)).astype(np.complex128), "regularised: no time"
    g = propagator.adjoint(p).astype(np.complex128)
    made = propagator.apply(g)
    power = float(np.vdot(made, made).real)
    return g * (complex(np.vdot(made, p)) / power if power else 0.0), "back-propagated: no time"


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [PseudoInverse]
