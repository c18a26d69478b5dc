"""Samples that press less than asked, as far as skin could feel it.

Regions whose samples press less than asked are named if these losses together are clearly more than those of an even
region, if a sample is a hole, or if the whole force is too low. Every isolated sample is named, because each of them is
felt on its own.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.region_numbers import ISOLATED
from pacinian.rendering.solution_sequence import RISEN_FROM
from pacinian.scene.sampling.sample_counts import label_object
from pacinian.solving.felt_figures import MIN_FELT_SHARE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Flags, Floats, Indices

# Force that a region may lose at the samples that get clearly less than asked, relative to its whole force. Normally
# distributed errors with an rms of 8 % lose 1.5 %.
MAX_LOST_FORCE = 0.015
MAX_MISSING_FORCE = 0.03  # by how much the whole force of a region may be too low
# Value of MAX_LOST_FORCE while pressures rise from silence, for some milliseconds: the first solves are less even.
MAX_LOST_WHILE_RISING = 0.05


class WeakSamples(NamedTuple):
    """Number of samples that press less than asked, by label of their object, if skin could feel the loss.

    weakened: little sound reaches them. missed: the solution gives them less than their targets.
    """

    weakened: Counter[str]
    missed: Counter[str]


class _Loss(NamedTuple):
    """Samples that press less than asked.

    samples: all of the solve. rows: which of them press less, (K,). lost: force that is missing at each, (K,) [N].
    alone: whether each is a loss on its own, however small its share of the object's force, (K,).
    """

    samples: Samples
    rows: Indices
    lost: Floats
    alone: Flags


def count_weak_samples(solutions: SolutionSequence, rising: Collection[str]) -> WeakSamples:
    """Count the samples that press less than asked. rising: labels of objects that may lose more, see `find_rising`."""
    short = {one for one in solutions.rows if one.weakened or one.missed}
    missed = [*_find_missed(solutions, short), *_find_weak_regions(solutions)]
    return WeakSamples(_count_felt(_find_weakened(short), rising), _count_felt(missed, rising))


def find_rising(samples: Samples, counts: SampleCounts) -> set[str]:
    """Return the labels of the objects whose pressures are clearly below their full ones, because their ramps go on."""
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


def _count_felt(losses: Iterable[_Loss], rising: Collection[str]) -> Counter[str]:
    """Return the number of samples by object, for the objects whose losses can be felt.

    rising: labels of objects that may lose more. Of several losses of one object, such as those of the rows of a
    technique, the one with most samples counts.
    """
    counts = Counter[str]()
    for samples, rows, lost, alone in losses:
        if not len(rows):
            continue
        whole, of = _sum_by_object(samples), samples.objects[rows]
        number, missing = np.bincount(of), np.bincount(of, lost)
        single = np.bincount(of, alone)
        for i in np.flatnonzero(number).tolist():
            label = label_object(samples.items[i], i)
            most = MAX_LOST_WHILE_RISING if label in rising else MAX_LOST_FORCE
            if single[i] or missing[i] > most * whole[i]:
                counts |= Counter({label: int(number[i])})
    return counts


def _find_weakened(short: Iterable[CachedSolution]) -> Iterator[_Loss]:
    """Yield the samples that little sound reaches. All of their force counts as lost, because more than half of it is.

    The frames of a cycle have the same samples, so each sample is counted once.
    """
    found: dict[int, tuple[Samples, set[int]]] = {}
    for one in short:
        if one.all_samples is not None:
            found.setdefault(id(one.all_samples), (one.all_samples, set()))[1].update(one.weakened)
    for samples, indices in found.values():
        rows = np.array(sorted(indices), np.intp)
        lost = samples.radiation_pressure[rows] * samples.area[rows]
        yield _Loss(samples, rows, lost, samples.regions[rows] == ISOLATED)


def _find_missed(solutions: SolutionSequence, short: Iterable[CachedSolution]) -> Iterator[_Loss]:
    """Yield the samples that get clearly less than their target.

    In a cycle, a frame that was solved later may have made up for what an earlier one missed.
    """
    for one in short:
        if one.all_samples is None or (
            solutions.cycle and one.all_samples is solutions.solved_samples
        ):
            continue
        share = 1.0 / solutions.frames  # for frames of earlier samples
        asked, made = one.pressures
        yield _compare(one.all_samples, one.missed, one.samples, share * asked, share * made)
    if solutions.cycle and solutions.missed:
        yield _compare(solutions.solved_samples, solutions.missed, *_find_mean_pressures(solutions))


def _find_weak_regions(solutions: SolutionSequence) -> Iterator[_Loss]:
    """Yield the samples that are too weak in regions whose whole force is too low.

    Bands, and frames of earlier samples, are left out.
    """
    if not (solutions.samples.regions >= 0).any():
        return
    if not solutions.cycle:
        found = [(one.samples, *one.pressures) for one in dict.fromkeys(solutions.rows)]
    elif all(one.samples is solutions.solved_samples for one in solutions.rows):
        found = [_find_mean_pressures(solutions)]
    else:
        return
    for samples, asked, made in found:
        inside = samples.regions >= 0
        force = np.bincount(samples.objects, inside * asked * samples.area)
        missing = force - np.bincount(samples.objects, inside * made * samples.area)
        for i in np.flatnonzero(missing > MAX_MISSING_FORCE * force).tolist():
            rows = np.flatnonzero(inside & (samples.objects == i) & (made < asked))
            lost = np.full(len(rows), missing[i] / len(rows))
            yield _Loss(samples, rows, lost, np.zeros(len(rows), np.bool_))


def _find_mean_pressures(solutions: SolutionSequence) -> tuple[Samples, Floats, Floats]:
    """Return the samples of a cycle that are solved for, and the pressures asked for and made there, (M',) [Pa].

    The pressure that a band makes beyond its own samples is left out.
    """
    assert solutions.common is not None
    assert solutions.asked is not None
    made = np.zeros(len(solutions.common))
    for one in solutions.rows:
        of, P = solutions.common.keys, one.pressures[1] / len(solutions.rows)
        if np.array_equal(of, one.samples.keys):
            made += P
        else:
            _, i, j = np.intersect1d(of, one.samples.keys, return_indices=True)
            made[i] += P[j]
    return solutions.common, solutions.asked, made


def _compare(
    all_samples: Samples, missed: tuple[int, ...], solved: Samples, asked: Floats, made: Floats
) -> _Loss:
    """Return what is lost at the samples `missed` of `all_samples`.

    solved: those of `all_samples` that were solved for, with the pressures asked for and made, (M',) [Pa].
    """
    rows = np.array(missed, np.intp)
    lost, alone = (
        all_samples.radiation_pressure[rows] * all_samples.area[rows],
        np.ones(len(rows), np.bool_),
    )
    if len(solved) == len(all_samples):  # in the same order
        i, j = np.arange(len(rows)), rows
    else:
        _, i, j = np.intersect1d(all_samples.keys[rows], solved.keys, return_indices=True)
    lost[i] = np.maximum(asked[j] - made[j], 0.0) * solved.area[j]
    alone[i] = (solved.regions[j] == ISOLATED) | (made[j] < MIN_FELT_SHARE * asked[j])
    return _Loss(all_samples, rows, lost, alone)
