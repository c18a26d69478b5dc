"""What a frame leaves out or changes, by object and reason."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from pacinian.rendering.cached_solution import CachedSolution
from pacinian.rendering.deviation_log import (
    AVERAGED,
    FEWER_FRAMES,
    INTERPOLATED,
    MISSED_TARGET,
    NOTHING,
    OUT_OF_TIME,
    SKIN_LIMITED,
    SLEW_LIMITED,
    WEAKENED,
    mark,
)
from pacinian.scene.sampling.sample_counts import TOO_FAST, label_object

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.solution_sequence import SolutionSequence, SolveResult
    from pacinian.scene.sampling.samples import Samples


class FrameDeviations:
    """Describes frames. While nothing changes, successive frames have the same description."""

    def __init__(self) -> None:
        self._of: tuple[object, ...] = (None,) * 4  # arguments of the last description
        self._last: Reasons = NOTHING

    def describe(
        self, before: SolveResult, played: SolveResult, *, between: bool, held_back: bool
    ) -> Reasons:
        """Return what a frame leaves out or changes, if it plays `played` and the previous result was `before`.

        between: whether the frame is interpolated between the two results. held_back: whether the slew-rate limit
        changed it.
        """
        given = before, played, between, held_back
        if any(now is not then for now, then in zip(given, self._of, strict=True)):
            self._of, self._last = given, _describe(before, played, between, held_back)
        return self._last


def _describe(before: SolveResult, played: SolveResult, between: bool, held_back: bool) -> Reasons:
    """Return the description of `FrameDeviations.describe`."""
    counts, short, reasons = played.sample_counts, set[CachedSolution](), set[str]()
    if between and before.solutions.samples is not played.solutions.samples:
        reasons.add(INTERPOLATED)
    for one in set(played.solutions.rows):
        if one.ran_out_of_time:
            reasons.add(OUT_OF_TIME)
        if one.averaged:
            reasons.add(AVERAGED)
        if one.limited:
            reasons.add(SKIN_LIMITED)
        if one.weakened or one.missed:
            short.add(one)
    if held_back:
        reasons.add(SLEW_LIMITED)
    if played.solutions.hurried:
        reasons.add(FEWER_FRAMES)
    if counts.clean and not reasons and not short and not played.too_fast:
        return NOTHING
    made: Reasons = mark(counts.deviations, played.too_fast, TOO_FAST)
    for label, count in _count(short, lambda one: one.weakened).items():
        made = mark(made, [label], WEAKENED, count)
    for label, count in _count_missed(played.solutions, short).items():
        made = mark(made, [label], MISSED_TARGET, count)
    for reason in sorted(reasons):
        made = mark(made, sorted(before.labels | played.labels), reason)
    return made


def _count_missed(solutions: SolutionSequence, short: Iterable[CachedSolution]) -> Counter[str]:
    """Return the number of samples by object that get clearly less than their target.

    In a cycle, a frame that was solved later may have made up for what an earlier one missed.
    """
    samples = solutions.samples
    if not solutions.cycle:
        return _count(short, lambda one: one.missed)
    before = [one for one in short if one.whole is not samples]  # frames of earlier samples
    items = samples.objects[list(solutions.missed)].tolist()
    return _count(before, lambda one: one.missed) | Counter(
        label_object(samples.items[i], i) for i in items
    )


def _count(
    solved: Iterable[CachedSolution], get: Callable[[CachedSolution], Iterable[int]]
) -> Counter[str]:
    """Return the number of samples by object. get: returns indices of samples of a solution.

    The frames of a cycle have their samples in common. Of the rows of a technique, the one with most counts.
    """
    found: dict[int, tuple[Samples, set[int]]] = {}
    for one in solved:
        if one.whole is not None:
            found.setdefault(id(one.whole), (one.whole, set()))[1].update(get(one))
    counts = Counter[str]()
    for samples, indices in found.values():
        items = samples.objects[sorted(indices)].tolist()
        counts |= Counter(label_object(samples.items[i], i) for i in items)
    return counts
