"""How long a solve may take before it must return the best gains that it has found."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pacinian.rendering.solution_sequence import SolveResult

# Deadline of a solve, relative to the time that it may take: one tick, or `max_ticks` ticks in the background.
DEADLINE_SHARE = 0.7
# Quiet zones, power limits and exact samples need longer solves. If such a solve in the background runs out of time
# while the samples are at rest, the deadline of the next one is multiplied by DEADLINE_FACTOR_GROWTH. It grows to at
# most MAX_DEADLINE_FACTOR times the usual deadline.
DEADLINE_FACTOR_GROWTH, MAX_DEADLINE_FACTOR = 4.0, 32.0

# If more than half of the recent solves in the background run out of time, the next ones get twice as long. Otherwise,
# more solutions would press too weakly. Solves get the usual time again once a quarter or less of them needs more.
SLOW_FACTOR, SLOW_ABOVE_SHARE, USUAL_UP_TO_SHARE = 2.0, 0.5, 0.25
AVERAGED_SOLVES = 16  # time constant of this share, in solves


class SolveDeadline:
    """Chooses the deadlines of solves.

    period: of a tick [s]. adaptive: whether solves have deadlines at all.
    """

    def __init__(self, period: float, *, adaptive: bool) -> None:
        self._period, self._adaptive = period, adaptive
        self.reset()

    def reset(self) -> None:
        """Forget how long solves have taken."""
        self.unhurried = False
        """Whether the last solve has no deadline, because nothing moves."""
        # factor on the deadline of the next solve in the background; usual deadline of the last one [s]
        self._factor, self._usual = 1.0, math.inf
        # share of recent solves that need more time than usual; whether the next ones get more
        self._slow_share, self._slow = 0.0, False

    @property
    def factor(self) -> float:
        """Factor on the usual deadline in the background; infinite for a solve without one."""
        slow = SLOW_FACTOR if self._slow else 1.0
        return math.inf if self.unhurried else max(self._factor, slow)

    def choose_tick_deadline(self) -> float:
        """Return the deadline of the next solve, in a tick, from its beginning [s]; may be infinite."""
        self.unhurried, self._usual = False, math.inf
        return DEADLINE_SHARE * self._period if self._adaptive else math.inf

    def choose_background_deadline(self, ticks: int, *, unhurried: bool) -> float:
        """Return the deadline of the next solve, in the background, from its beginning [s]; may be infinite.

        ticks: number of ticks that it may take. unhurried: whether it may take any time.
        """
        self.unhurried = unhurried
        if not self._adaptive:
            return math.inf
        self._usual = DEADLINE_SHARE * (ticks * self._period)
        return self._usual * self.factor

    def adapt(self, result: SolveResult, before: SolveResult) -> None:
        """Adapt the deadline of the next solve in the background. before: what was played before `result`."""
        for one in result.fresh if self._usual < math.inf else ():
            slow = one.ran_out_of_time or one.solution.seconds > self._usual
            self._slow_share += (slow - self._slow_share) / AVERAGED_SOLVES
        self._slow = self._slow_share > (USUAL_UP_TO_SHARE if self._slow else SLOW_ABOVE_SHARE)
        at_rest = result.solutions.samples is before.solutions.samples
        extends = at_rest and result.solutions.limits.forbids_steering
        if extends and any(one.ran_out_of_time for one in result.fresh):
            self._factor = min(DEADLINE_FACTOR_GROWTH * self._factor, MAX_DEADLINE_FACTOR)
        elif result.fresh or not extends:
            self._factor = 1.0
