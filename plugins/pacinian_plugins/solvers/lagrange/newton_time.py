"""Whether there is time for a Newton step."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pacinian as pc

# approximate speed of Newton steps [M M N / s]; duration up to which steps are always started [s]
NEWTON_SPEED, MIN_TIME = 5e9, 1e-3


def affords_newton_step(budget: pc.Budget, work: int) -> bool:
    """Return whether a Newton step of `work` M M N is short or fits in the budget; if not, do not start it."""
    return work <= MIN_TIME * NEWTON_SPEED or budget.affords(work / NEWTON_SPEED)
