"""Result of a convex problem: gains and their certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats


class Answer(NamedTuple):
    """Gains and their certificate, in the units of A and p.

    h: (N,), |h_n| <= 1 and ||h||^2 <= power up to rounding. y: multipliers for a warm start, (R,).
    made: A h, (R,) [Pa]. objective: of h [Pa^2]; -strength when the strength is maximised.
    bound: lower bound of the objective within the limits. violation: excess of |p - made| over each row's
    limit, (R,) [Pa]. late: the budget was spent. kept: all limits are kept, exact rows within a tolerance.
    impossible: it is proven that no gains keep the limits; then h is the solution without exact rows.
    strength: multiple of c made; NaN unless it is maximised.
    """

    h: Complexes
    y: Complexes
    made: Complexes
    objective: float
    bound: float
    violation: Floats
    steps: int
    late: bool
    kept: bool
    impossible: bool = False
    strength: float = float("nan")

    @property
    def gap(self) -> float:
        """Relative duality gap, (objective - bound) / |objective|."""
        rest = self.objective - self.bound
        return rest / abs(self.objective) if self.objective else rest
