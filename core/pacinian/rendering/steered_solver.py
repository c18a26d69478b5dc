"""Solve for one object that moves in free air, or steer the field of its last solution."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from pacinian.rendering.field_steering import SampleMotion

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

# Largest shift, relative to the distance from the nearest transducer, after which samples are solved for again. It is
# larger (MAX_LIMITED_SHIFT) if transducers are at their limit, because solutions are then less exact and take longer.
# It is largest (MAX_LATE_SHIFT) while solves for the same samples go on, because the last one ran out of time.
MAX_SHIFT, MAX_LIMITED_SHIFT, MAX_LATE_SHIFT = 0.02, 0.06, 0.15
LIMITED_FROM = 0.02  # share of the transducers at their limit from which MAX_LIMITED_SHIFT holds
# Largest error of a solution that ran out of time, relative to that of the solution that it replaces.
MAX_WORSENING = 1.25
# Factor on the time that a solve may take while there is a field to steer.
STEERED_TIME_FACTOR = 2.5


class Anchor(NamedTuple):
    """Samples that were solved for, and their centre, (3,) [m]."""

    samples: Samples
    centre: Floats


class SteeredSolver:
    """Solves for the samples of one object, and steers the solution while they move as one."""

    def __init__(self, array: Array) -> None:
        self._tracker = SampleMotion(array)
        self.reset()

    def reset(self) -> None:
        """Forget all solutions."""
        self._tracker.reset()
        self._anchor: Anchor | None = None  # of the last solve
        # The solution that is steered. A worse one that ran out of time replaces it only if no further solve is due, or
        # if the samples have moved too far.
        self._played: tuple[SolutionSequence, Anchor] | None = None
        self._late, self._max_shift = False, MAX_SHIFT  # of the last solve
        self._result: SolutionSequence | None = None  # of the last call of `solve`

    def solve(
        self, samples: Samples, t: float, solve: Callable[[Samples, float], SolutionSequence],
        is_due: Callable[[SolutionSequence], bool], move: Callable[[Floats, Floats], None],
    ) -> SolutionSequence | None:  # fmt: skip
        """Return what to play for samples whose positions are those at time t [s]; None if they are close to the array.

        solve: solves for samples, within the usual time multiplied by a factor. is_due: whether a further solve for the
        same samples may come nearer to the targets. move: steers the solutions from which the next solve starts, from
        the centre of their samples to another place, (3,) [m]. Call `reset` if other limits or another solver are used.
        """
        tracker, motion, anchor = self._tracker, None, self._anchor
        tracker.track(samples, t)
        if tracker.close:
            self.reset()
            return None
        if anchor is not None:
            motion = tracker.find_motion(samples, *anchor, self._max_shift)
            if motion is not None and motion.misplaced and tracker.stands and not self._late:
                motion = None
        goes_on = anchor is not None and motion is not None and self._late
        if anchor is None or motion is None:
            motion = tracker.begin()._replace(continues=anchor is not None)
            if anchor is not None and tracker.find_motion(samples, *anchor, MAX_LATE_SHIFT):
                move(anchor.centre, motion.centre)
            anchor = self._anchor = Anchor(samples, motion.centre)
        played = self._played
        since = played and tracker.find_motion(samples, *played[1], MAX_LATE_SHIFT)
        solutions = solve(anchor.samples, STEERED_TIME_FACTOR if since or goes_on else 1.0)
        late = any(one.ran_out_of_time for one in solutions.rows)
        limited = any(one.solution.saturation >= LIMITED_FROM for one in solutions.rows)
        self._late = late and is_due(solutions)
        self._max_shift = MAX_LIMITED_SHIFT if limited else MAX_SHIFT
        if self._late:
            self._max_shift = MAX_LATE_SHIFT
        if self._late and played and since and _is_worse(solutions, played[0]):
            solutions, motion = played[0], since
        else:
            self._played = solutions, anchor
        last = self._result
        if last is not None and last.samples is samples and last.rows == solutions.rows:
            assert last.motion is not None
            if motion.rests_like(last.motion):
                return last  # nothing has changed
        self._result = replace(
            solutions, samples=samples, motion=motion, before_motion=solutions.samples
        )
        return self._result


def _is_worse(solutions: SolutionSequence, played: SolutionSequence) -> bool:
    """Return whether the largest error of the frames at their samples has clearly grown."""
    now, before = (max(one.solution.error for one in each.rows) for each in (solutions, played))
    return now > MAX_WORSENING * before
