"""Warm starts: carry the last solution over to the present points, which may have moved, come or gone."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels
from pacinian.solving.solution import Solution

if TYPE_CHECKING:
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets

# A warm start is used if the number of points has changed by at most this share of it, plus one.
MAX_COUNT_CHANGE = 1 / 4
# A sample that moved by less than this, apart from the motion of its whole region, counts as the same [m].
MAX_STILL_MOVE = 5e-4
# Samples that all moved as one, by at most this, count as the same [m].
MAX_COMMON_MOVE = 0.03
# A new sample takes over the phase of an earlier one that is at most this far away [m].
MAX_CARRY_DISTANCE = 3e-3


def carry_over(propagator: Propagator, targets: Targets, warm: Solution) -> Solution | None:
    """Return the last solution `warm` carried over to the propagator's points; None if they differ too much.

    targets: the present ones.
    """
    M, last = len(propagator.points), len(warm.sound_pressure)
    if not M or not last:
        return None
    if warm.asked_phases is not None and targets.regions is not None:
        return carry_regions(propagator, targets, warm)
    if last == M:
        return warm
    alike = abs(last - M) <= MAX_COUNT_CHANGE * max(last, M) + 1
    return _evaluate_here(propagator, warm) if alike else None


def _evaluate_here(propagator: Propagator, warm: Solution) -> Solution:
    """Return the last solution evaluated at the present points, so that points that remain keep their phases."""
    return dataclasses.replace(
        warm,
        points=propagator.points,
        sound_pressure=propagator.apply(warm.gains),
        multipliers=None,
        asked_phases=None,
    )


def carry_regions(propagator: Propagator, targets: Targets, warm: Solution) -> Solution:
    """Return the last solution carried over to the present points, although samples may have come and gone.

    Points that have all moved as one are the same. Otherwise, a point takes over the phase and the multiplier of the
    earlier point at its place, after the motion of its whole region has been subtracted. A new point takes over the
    phase of the nearest earlier point of its kind (in a region, isolated, or beside regions) within 3 mm, or else that
    of the present sound there, and its multiplier is 0 (decision 72).
    """
    q, before, asked = propagator.points, warm.points, warm.asked_phases
    now, were = targets.regions, warm.targets.regions
    assert asked is not None
    assert now is not None
    assert were is not None
    M = len(q)
    if len(before) == M and np.array_equal(now, were):
        moved = q - before
        if float(np.abs(moved).max()) < MAX_STILL_MOVE:
            return warm
        as_one = float(np.abs(moved - moved[0]).max()) < MAX_STILL_MOVE
        if as_one and float(np.linalg.norm(moved[0])) <= MAX_COMMON_MOVE:
            return dataclasses.replace(warm, sound_pressure=propagator.apply(warm.gains))
    p, phases, y = propagator.apply(warm.gains), np.empty(M), np.empty(M, np.complex128)
    last = np.zeros(len(before), np.complex128) if warm.multipliers is None else warm.multipliers
    found = kernels.carry_multipliers(
        q, now, before, were, asked, last, p, MAX_CARRY_DISTANCE, MAX_STILL_MOVE, phases, y
    )  # fmt: skip
    made = object.__new__(Solution)  # `dataclasses.replace` takes as long as a kernel
    made.__dict__.update(
        warm.__dict__, sound_pressure=p, asked_phases=phases, multipliers=y if found else None
    )
    return made
