"""What comes back: gains and their certificate."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats


class Answer(NamedTuple):
    """Gains and their certificate, in the units of A and p.

    h: (N,), |h_n| <= 1 and ||h||^2 <= power up to rounding. y: multipliers to start from again, (R,).
    made: A h, (R,) [Pa]. objective: of h [Pa^2]; -strength where that is asked for, and else NaN.
    bound: what no gains within the limits can be below. violation: |p - made| beyond each row's
    limit, (R,) [Pa]. late: the budget was spent. kept: all limits are, but for the tolerance of exact
    rows. impossible: no gains keep them, which is proven; then h is the answer without exact rows.
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
        """(objective - bound) / |objective|."""
        rest = self.objective - self.bound
        return rest / abs(self.objective) if self.objective else rest
