"""What a frame leaves out or changes, by object and reason, as far as skin could feel it.

Samples below the threshold of feeling are not felt, whether they sound or not. They are named only if they are at least
half of the samples of their object. Regions whose samples press less than asked are named if these losses together are
clearly more than those of an even region, if a sample is a hole, or if the whole force is too low. Every isolated
sample is named, because each of them is felt on its own.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.region_numbers import ISOLATED
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
from pacinian.rendering.solution_sequence import RISEN_FROM
from pacinian.scene.sampling.sample_counts import FAINT, TOO_FAST, label_object
from pacinian.solving.felt_regions import MIN_FELT_SHARE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.solution_sequence import SolutionSequence, SolveResult
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Flags, Floats, Indices

# Share of an object's samples from which those that are too faint to feel are a deviation.
MIN_FAINT_SHARE = 0.5
# Force that a region may lose at the samples that get clearly less than asked, relative to its whole force. Normally
# distributed errors with an rms of 8 % lose 1.5 %.
MAX_LOST_FORCE = 0.015
MAX_MISSING_FORCE = 0.03  # by how much the whole force of a region may be too low
# Value of MAX_LOST_FORCE while pressures rise from silence, for some milliseconds: the first solves are less even.
MAX_LOST_WHILE_RISING = 0.05


class _Loss(NamedTuple):
    """Samples that press less than asked.

    samples: all of the solve. rows: which of them press less, (K,). lost: force that is missing at each, (K,) [N].
    alone: whether each is a loss on its own, however small its share of the object's force, (K,).
    """

    samples: Samples
    rows: Indices
    lost: Floats
    alone: Flags


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
    if silenced:
        reasons.add(SKIN_LIMITED)
    if played.solutions.hurried:
        reasons.add(FEWER_FRAMES)
    missed = [*_find_missed(played.solutions, short), *_find_weak_regions(played.solutions)]
    if counts.clean and not (reasons or short or missed or played.too_fast):
        return NOTHING
    made: Reasons = mark(_keep_felt(counts), played.too_fast, TOO_FAST)
    if short or missed:
        rising = _find_rising(played)
        for label, count in _count_felt(_find_weakened(short), rising).items():
            made = mark(made, [label], WEAKENED, count)
        for label, count in _count_felt(missed, rising).items():
            made = mark(made, [label], MISSED_TARGET, count)
    for reason in sorted(reasons):
        made = mark(made, sorted(before.labels | played.labels), reason)
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


def _find_rising(played: SolveResult) -> set[str]:
    """Return the labels of the objects whose pressures are clearly below their full ones, because their ramps go on."""
    samples, counts = played.solutions.samples, played.sample_counts
    if samples is counts.samples:
        return set()
    force = _sum_by_object(samples)
    labels = {i: label_object(samples.items[i], i) for i in np.unique(samples.objects).tolist()}
    full = {label: one.force for label, one in counts.objects.items()}
    return {label for i, label in labels.items() if force[i] < RISEN_FROM * full.get(label, 0.0)}


def _sum_by_object(samples: Samples) -> Floats:
    """Return the force of the samples of each object [N]."""
    force = samples.radiation_pressure * samples.area
    return np.bincount(samples.objects, force, len(samples.items)).astype(np.float64)


def _count_felt(losses: Iterable[_Loss], rising: set[str]) -> Counter[str]:
    """Return the number of samples by object, for the objects whose losses can be felt.

    rising: labels of objects that may lose more. Of several losses of one object, such as those of the rows of a
    technique, the one with most samples counts.
    """
    counts = Counter[str]()
    for samples, rows, lost, alone in losses:
        whole, of = _sum_by_object(samples), samples.objects[rows]
        for i in np.unique(of).tolist():
            own, label = of == i, label_object(samples.items[i], i)
            most = MAX_LOST_WHILE_RISING if label in rising else MAX_LOST_FORCE
            if alone[own].any() or lost[own].sum() > most * whole[i]:
                counts |= Counter({label: int(own.sum())})
    return counts


def _find_weakened(short: Iterable[CachedSolution]) -> Iterator[_Loss]:
    """Yield the samples that little sound reaches, as if all of their force were lost; it is more than half of it.

    The frames of a cycle have their samples in common.
    """
    found: dict[int, tuple[Samples, set[int]]] = {}
    for one in short:
        if one.whole is not None:
            found.setdefault(id(one.whole), (one.whole, set()))[1].update(one.weakened)
    for samples, indices in found.values():
        rows = np.array(sorted(indices), np.intp)
        lost = samples.radiation_pressure[rows] * samples.area[rows]
        yield _Loss(samples, rows, lost, samples.regions[rows] == ISOLATED)


def _find_missed(solutions: SolutionSequence, short: Iterable[CachedSolution]) -> Iterator[_Loss]:
    """Yield the samples that get clearly less than their target.

    In a cycle, a frame that was solved later may have made up for what an earlier one missed.
    """
    for one in short:
        if one.whole is None or (solutions.cycle and one.whole is solutions.samples):
            continue
        share = 1.0 / len(solutions.rows) if solutions.cycle else 1.0  # frames of earlier samples
        asked, made = _find_pressures(one)
        yield _compare(one.whole, one.missed, one.samples, share * asked, share * made)
    if solutions.cycle and solutions.missed:
        yield _compare(solutions.samples, solutions.missed, *_find_mean_pressures(solutions))


def _find_weak_regions(solutions: SolutionSequence) -> Iterator[_Loss]:
    """Yield the samples that are too weak in regions whose whole force is too low.

    Bands, and frames of earlier samples, are left out.
    """
    if not (solutions.samples.regions >= 0).any():
        return
    if not solutions.cycle:
        found = [(one.samples, *_find_pressures(one)) for one in dict.fromkeys(solutions.rows)]
    elif all(one.samples is solutions.samples for one in solutions.rows):
        found = [_find_mean_pressures(solutions)]
    else:
        return
    for samples, asked, made in found:
        for i in np.unique(samples.objects[samples.regions >= 0]).tolist():
            own = (samples.objects == i) & (samples.regions >= 0)
            force = float(asked[own] @ samples.area[own])
            missing = force - float(made[own] @ samples.area[own])
            if missing > MAX_MISSING_FORCE * force:
                rows = np.flatnonzero(own & (made < asked))
                lost = np.full(len(rows), missing / len(rows))
                yield _Loss(samples, rows, lost, np.zeros(len(rows), np.bool_))


def _find_pressures(one: CachedSolution) -> tuple[Floats, Floats]:
    """Return the pressures asked for and made at the samples that were solved for, (M',) [Pa]."""
    medium = one.solution.medium
    asked = radiation_pressure(one.solution.targets.amplitudes, medium)
    return asked, radiation_pressure(one.solution.sound_pressure, medium)


def _find_mean_pressures(solutions: SolutionSequence) -> tuple[Samples, Floats, Floats]:
    """Return the samples of a cycle that sound can reach, and the pressures asked for and made there, (M',) [Pa].

    What bands make beyond their own samples is left out.
    """
    assert solutions.common is not None
    assert solutions.asked is not None
    made = np.zeros(len(solutions.common))
    for one in solutions.rows:
        _, i, j = np.intersect1d(solutions.common.keys, one.samples.keys, return_indices=True)
        made[i] += _find_pressures(one)[1][j] / len(solutions.rows)
    return solutions.common, solutions.asked, made


def _compare(
    whole: Samples, missed: tuple[int, ...], solved: Samples, asked: Floats, made: Floats
) -> _Loss:
    """Return what is lost at the samples `missed` of `whole`.

    solved: those of `whole` that were solved for, with the pressures asked for and made, (M',) [Pa].
    """
    rows = np.array(missed, np.intp)
    lost, alone = whole.radiation_pressure[rows] * whole.area[rows], np.ones(len(rows), np.bool_)
    _, i, j = np.intersect1d(whole.keys[rows], solved.keys, return_indices=True)
    lost[i] = np.maximum(asked[j] - made[j], 0.0) * solved.area[j]
    alone[i] = (solved.regions[j] == ISOLATED) | (made[j] < MIN_FELT_SHARE * asked[j])
    return _Loss(whole, rows, lost, alone)
