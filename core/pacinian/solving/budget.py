"""The time budget of a solve."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pacinian.argument_checks import check_number

if TYPE_CHECKING:
    from collections.abc import Callable


def _never_cancel() -> bool:
    """Return False: nothing cancels the solve."""
    return False


@dataclass(frozen=True)
class Budget:
    """The time budget of a solver, which checks it between iterations.

    due: when to stop, as a reading of `clock` [s]; infinity for no deadline. is_cancelled: returns whether to stop
    at once, because nobody needs the result any more.
    """

    due: float = math.inf
    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)
    is_cancelled: Callable[[], bool] = field(default=_never_cancel, repr=False)

    @classmethod
    def until(
        cls, deadline: float | None, clock: Callable[[], float] = time.perf_counter
    ) -> Budget:
        """Make a budget that ends `deadline` seconds from now; None for no deadline."""
        if deadline is None:
            return cls(math.inf, clock)
        return cls(clock() + check_number("deadline", deadline, low=0.0), clock)

    @property
    def endless(self) -> bool:
        """Whether there is no deadline."""
        return self.due == math.inf

    @property
    def spent(self) -> bool:
        """Whether the time is up, or the solve is cancelled."""
        return (self.due < math.inf and self.clock() >= self.due) or self.is_cancelled()

    def affords(self, seconds: float) -> bool:
        """Return whether a step of `seconds` would end before the deadline."""
        return self.due == math.inf or self.clock() + seconds <= self.due
