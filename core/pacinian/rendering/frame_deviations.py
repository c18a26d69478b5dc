"""What a frame leaves out or changes, by object and reason, as far as skin could feel it.

Samples below the threshold of feeling are not felt, whether they sound or not. They are named only if they are at least
half of the samples of their object.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

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
    ZONE_LIMITED,
    mark,
)
from pacinian.scene.sampling.sample_counts import FAINT, TOO_FAST

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.solution_sequence import SolveResult
    from pacinian.rendering.weak_samples import WeakSamples
    from pacinian.scene.sampling.sample_counts import SampleCounts

# Share of an object's samples from which those that are too faint to feel are a deviation.
MIN_FAINT_SHARE = 0.5


def describe_solve(counts: SampleCounts, too_fast: Iterable[str], weak: WeakSamples) -> Reasons:
    """Return what a solve leaves out or changes, apart from what concerns all of its objects.

    too_fast: labels of the objects whose vibration the device cannot play.
    """
    made: Reasons = mark(_keep_felt(counts), too_fast, TOO_FAST)
    for found, reason in ((weak.weakened, WEAKENED), (weak.missed, MISSED_TARGET)):
        for label, count in found.items():
            made = mark(made, [label], reason, count)
    return made


class FrameDeviations:
    """Describes frames. While nothing changes, successive frames have the same description."""

    def __init__(self) -> None:
        self._of: tuple[object, ...] = (None,) * 5  # arguments of the last description
        self._last: Reasons = NOTHING

    def describe(
        self, before: SolveResult, played: SolveResult, *, between: bool, held_back: bool, silenced: bool
    ) -> Reasons:  # fmt: skip
        """Return what a frame leaves out or changes, if it plays `played` and the previous result was `before`.

        between: whether the frame is interpolated between the two results. held_back: whether the slew-rate limit
        changed it. silenced: whether it is silent, because `played` does not know a hand whose skin has a limit.
        """
        given = before, played, between, held_back, silenced
        if any(now is not then for now, then in zip(given, self._of, strict=True)):
            self._of, self._last = given, _describe(*given)
        return self._last


def _describe(
    before: SolveResult, played: SolveResult, between: bool, held_back: bool, silenced: bool
) -> Reasons:
    """Return the description of `FrameDeviations.describe`."""
    solutions, reasons = played.solutions, set[str]()
    if between and before.solutions.samples is not solutions.samples:
        reasons.add(INTERPOLATED)
    for one in set(solutions.rows):
        if one.ran_out_of_time:
            reasons.add(OUT_OF_TIME)
        if one.averaged:
            reasons.add(AVERAGED)
        if one.limited:
            reasons.add(SKIN_LIMITED)
        if one.limited_in_zones:
            reasons.add(ZONE_LIMITED)
    if held_back:
        reasons.add(SLEW_LIMITED)
    if silenced:
        reasons.add(SKIN_LIMITED)
    if solutions.hurried:
        reasons.add(FEWER_FRAMES)
    made = played.deviations
    if reasons:
        labels = sorted(before.labels | played.labels)
        for reason in sorted(reasons):
            made = mark(made, labels, reason)
    return made


def _keep_felt(counts: SampleCounts) -> Reasons:
    """Return the reasons of the sample counts, without faint samples where they are few."""
    if not counts.total(FAINT):
        return counts.deviations
    made: dict[str, dict[str, int]] = {}
    for label, reasons in counts.deviations.items():
        faint = reasons.get(FAINT, 0)
        if faint and faint < MIN_FAINT_SHARE * counts.objects[label].asked:
            rest = {reason: count for reason, count in reasons.items() if reason != FAINT}
        else:
            rest = reasons
        if rest:
            made[label] = rest
    return made
