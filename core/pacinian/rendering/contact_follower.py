"""Follow contacts with skin from solution to solution, so that the field moves with them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.field_steering import (
    MAX_JUMP,
    MAX_VELOCITY_INTERVAL,
    MIN_STEERED_DISTANCE,
    MIN_VELOCITY_INTERVAL,
    Motion,
    choose_slower,
)

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

# Contacts move as one if their shifts differ by at most this [m].
MAX_CONTACT_SHIFT_DIFFERENCE = 1e-3


class ContactFollower:
    """Finds how contacts with skin have moved from one solution to the next, so that the field moves with them.

    Without it, the gains of two solutions whose fields lie apart would be blended. Halfway, these fields cancel each
    other partly, and a hand that moves steadily would feel its contact vibrate (decision 81).
    """

    def __init__(self, array: Array) -> None:
        self._transducers = array.positions
        self.reset()

    def reset(self) -> None:
        """Forget all contacts."""
        self._solutions: SolutionSequence | None = None  # as last given to `follow`
        self._moved: SolutionSequence | None = None  # as last returned by it
        self._places: dict[int, Floats] = {}  # centre of each of their contacts [m]
        self._time = -math.inf  # time of the last solutions [s]
        self._velocity = np.zeros(3)  # velocity of the last step [m/s]

    def follow(self, solutions: SolutionSequence, t: float) -> SolutionSequence:
        """Return the solutions with the motion of their samples, whose positions are those at time t [s]."""
        # The same solutions again: the contact rests.
        if solutions is self._solutions and self._moved is not None:
            motion = self._moved.motion
            if motion is not None and motion.velocity.any():
                motion = motion._replace(velocity=np.zeros(3))
                self._moved, self._velocity = replace(self._moved, motion=motion), np.zeros(3)
            return self._moved
        samples = solutions.samples
        places, before = _find_centres(samples), self._places
        centre = np.mean(list(places.values()), axis=0)
        steps = [place - before[n] for n, place in places.items() if n in before]
        continues = (
            len(steps) == len(places) == len(before)
            and float(np.ptp(steps, axis=0).max()) <= MAX_CONTACT_SHIFT_DIFFERENCE
            and float(np.linalg.norm(steps, axis=1).max()) <= MAX_JUMP
            and float(np.linalg.norm(self._transducers - centre, axis=1).min())
            >= MIN_STEERED_DISTANCE
        )
        velocity, seconds = np.zeros(3), t - self._time
        if continues and MIN_VELOCITY_INTERVAL <= seconds <= MAX_VELOCITY_INTERVAL:
            velocity = np.mean(steps, axis=0) / seconds
        motion = Motion(centre, np.zeros(3), choose_slower(velocity, self._velocity), t, continues)
        self._time, self._velocity = t, velocity
        self._solutions, self._places = solutions, places
        self._moved = replace(solutions, motion=motion)
        return self._moved


def _find_centres(samples: Samples) -> dict[int, Floats]:
    """Return the centre of each region, by its number, (3,) [m]: the mean place of its force."""
    force = samples.radiation_pressure * samples.area
    numbers, which = np.unique(samples.regions, return_inverse=True)
    total = np.bincount(which, force)
    sums = np.stack([np.bincount(which, force * x) for x in samples.positions.T], axis=1)
    return {
        int(number): sums[i] / total[i]
        for i, number in enumerate(numbers)
        if number >= 0 and total[i] > 0.0
    }
