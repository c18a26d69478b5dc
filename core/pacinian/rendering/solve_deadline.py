"""How long a solve may take before it must return the best gains that it has found."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pacinian.rendering.solution_sequence import SolveResult

# Deadline of a solve, relative to the time that it may take: one tick, or `max_ticks` ticks in the background.
DEADLINE_SHARE = 0.7
# Quiet zones, power limits and exact samples take longer to solve for. If the solver ran out of time and the samples
# are at rest, the next solve in the background gets so many times as long, up to a limit [relative to the deadline].
DEADLINE_FACTOR_GROWTH, MAX_DEADLINE_FACTOR = 4.0, 32.0

# If more than half of the recent solves in the background run out of time, the next ones get twice as long: more solves
# would press too weakly, and fewer press as asked. They get the usual time again once a quarter or less needs more.
SLOW_FACTOR, SLOW_FROM, SLOW_ABOVE, AVERAGED_SOLVES = 2.0, 0.5, 0.25, 16


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
        """Whether the solve that was chosen for last has no deadline, because nothing moves."""
        self._factor, self._usual = 1.0, math.inf  # deadline of the last solve without factors [s]
        self._slow_share, self._slow = 0.0, False  # of recent solves that need more time than usual

    @property
    def factor(self) -> float:
        """Factor on the usual deadline in the background; infinite for a solve without one."""
        slow = SLOW_FACTOR if self._slow else 1.0
        return math.inf if self.unhurried else max(self._factor, slow)

    def choose(self, ticks: int, *, in_background: bool, unhurried: bool) -> float:
        """Return the deadline of the next solve, from its beginning [s]; may be infinite.

        ticks: that it may take. unhurried: whether it may take any time, if it runs in the background.
        """
        self.unhurried = in_background and unhurried
        if not self._adaptive:
            return math.inf
        usual = DEADLINE_SHARE * (ticks * self._period)
        self._usual = usual if in_background else math.inf
        return usual * self.factor if in_background else usual

    def adapt(self, result: SolveResult, before: SolveResult) -> None:
        """Adapt the deadline of the next solve in the background. before: what was played before `result`."""
        for one in result.fresh if self._usual < math.inf else ():
            slow = one.ran_out_of_time or one.solution.seconds > self._usual
            self._slow_share += (slow - self._slow_share) / AVERAGED_SOLVES
        self._slow = self._slow_share > (SLOW_ABOVE if self._slow else SLOW_FROM)
        at_rest = result.solutions.samples is before.solutions.samples
        extends = at_rest and result.solutions.limits.forbids_steering
        if extends and any(one.ran_out_of_time for one in result.fresh):
            self._factor = min(DEADLINE_FACTOR_GROWTH * self._factor, MAX_DEADLINE_FACTOR)
        elif result.fresh or not extends:
            self._factor = 1.0
