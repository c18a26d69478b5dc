"""Steering: move the emitted field with samples that move as one, without another solve.

Let c be the centre of the samples that were solved for. If each transducer produces the same sound pressure at c + d as
it did at c, the field around c moves by d. A transducer at distance r from c, and r' from c + d, produces sound
pressures in proportion to e^(-jkr) / r and e^(-jkr') / r' there. Therefore its gain is multiplied by

    e^(jk(r' - r)) r' / r

At the centre, this is exact, except for the directivity. Elsewhere, the error grows with the shift and with the
distance from the centre, relative to the distance from the array (decision 76).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.propagation import KernelData

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats, Gains

MAX_SAMPLE_SHIFT_DIFFERENCE = 2e-4  # samples move as one if their shifts differ by at most this [m]
# Smallest distance from the centre of the samples to the nearest transducer at which a field is steered [m].
MIN_STEERED_DISTANCE = 0.05
# Largest displacement from place to place that counts as a movement, not as a jump [m].
MAX_JUMP = 0.02
# Samples stand if they have stayed within MAX_TREMBLE [m] of one place for at least MIN_STANDSTILL [s].
MAX_TREMBLE, MIN_STANDSTILL = 3e-4, 0.033
# Largest distance of samples from where they were solved for at which they need no other solve if they stand, or if
# they creep (sample_solver.py): a twentieth of a wavelength [m].
MAX_MISPLACEMENT = 4e-4
# Shortest and longest time between the two places from which a velocity is computed [s].
MIN_VELOCITY_INTERVAL, MAX_VELOCITY_INTERVAL = 5e-3, 0.05
MAX_EXTRAPOLATION = 0.03  # longest time for which samples are assumed to keep their velocity [s]
MAX_RATIO = 2.0  # factors on gains are limited to 1 / MAX_RATIO to MAX_RATIO in amplitude

NOWHERE, AT_REST = np.full(3, math.nan), np.zeros(3)  # a place [m] and a velocity [m/s]
for _constant in (NOWHERE, AT_REST):
    _constant.flags.writeable = False


class Motion(NamedTuple):
    """How samples have moved since they were solved for.

    centre: of the samples solved for, (3,) [m]. shift: since then, (3,) [m]. velocity: (3,) [m/s]. time: at which the
    samples had this shift [s]. continues: whether the samples have moved here as one from those played before, so that
    the field moves with them.
    """

    centre: Floats
    shift: Floats
    velocity: Floats
    time: float
    continues: bool = True

    @property
    def misplaced(self) -> bool:
        """Whether samples that stand are so far from where they were solved for that they need another solve."""
        return float(np.linalg.norm(self.shift)) > MAX_MISPLACEMENT

    def rests_like(self, other: Motion) -> bool:
        """Return whether both have the same centre and shift, and the samples are at rest."""
        return (
            np.array_equal(self.centre, other.centre)
            and np.array_equal(self.shift, other.shift)
            and not (self.velocity.any() or other.velocity.any())
        )

    def find_place(self, t: float) -> Floats:
        """Return the centre of the samples at time t [s], (3,) [m]."""
        ahead = min(max(t - self.time, -MAX_EXTRAPOLATION), MAX_EXTRAPOLATION)
        return np.asarray(self.centre + self.shift + ahead * self.velocity)


class SampleMotion:
    """Follows samples from solve to solve."""

    def __init__(self, array: Array) -> None:
        self._transducers, self._centre = array.positions, array.centre
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self._place, self._time = NOWHERE, -math.inf  # of the last samples [m], [s]
        # where the present step began [m], and when [s]; each velocity is computed from one step
        self._step_from, self._step_begun = self._place, self._time
        # velocity in the last step, and the slower one of the last two steps [m/s]
        self._step = self._velocity = AT_REST
        # place near which the samples are [m], and since when [s]
        self._rest, self._stands_since = self._place, math.inf
        self._distance = 0.0  # from the nearest transducer [m]

    @property
    def close(self) -> bool:
        """Whether the samples are so close to the array that their field cannot be steered."""
        return not self._distance >= MIN_STEERED_DISTANCE

    @property
    def stands(self) -> bool:
        """Whether the samples have stayed near one place for at least MIN_STANDSTILL."""
        return self._time - self._stands_since >= MIN_STANDSTILL

    def track(self, samples: Samples, t: float) -> None:
        """Note where samples are at time t [s].

        The velocity is the smaller one of the last two steps, so that a single step is not taken for a movement.
        """
        place = samples.positions.mean(axis=0)
        # also true if there was no place before
        far = not float(np.linalg.norm(place - self._place)) <= MAX_JUMP
        seconds = t - self._step_begun
        if far or not 0.0 <= seconds <= MAX_VELOCITY_INTERVAL:
            self._velocity = self._step = AT_REST
            self._step_from, self._step_begun = place, t
        elif seconds >= MIN_VELOCITY_INTERVAL:
            step = (place - self._step_from) / seconds
            self._velocity, self._step = choose_slower(step, self._step), step
            self._step_from, self._step_begun = place, t
        if t < self._time or not float(np.linalg.norm(place - self._rest)) <= MAX_TREMBLE:
            self._rest, self._stands_since = place, t
        self._place, self._time = place, t
        self._distance = float(np.linalg.norm(self._transducers - place, axis=1).min())

    def begin(self) -> Motion:
        """Return the motion of the samples noted last, which are solved for where they are."""
        self._stands_since = self._time
        return Motion(self._place, np.zeros(3), self._velocity, self._time)

    def find_motion(
        self, samples: Samples, solved: Samples, centre: Floats, most: float
    ) -> Motion | None:
        """Return how the samples noted last have moved since they were `solved`; None if they need another solve.

        centre: of `solved`, (3,) [m]. most: largest shift sideways, over the distance from the nearest transducer. A
        shift towards the array or away from it may be half as large.
        """
        shift = samples.find_shift(solved, MAX_SAMPLE_SHIFT_DIFFERENCE)
        if shift is None:
            return None
        # towards the array or away from it, a field is distorted twice as much
        away = self._place - self._centre
        away /= max(float(np.linalg.norm(away)), MIN_STEERED_DISTANCE)
        if not float(np.linalg.norm(shift + (shift @ away) * away)) <= most * self._distance:
            return None
        return Motion(centre, shift, self._velocity, self._time)


def choose_slower(velocity: Floats, before: Floats) -> Floats:
    """Return a velocity, (3,) [m/s], limited to the speed of the one before.

    Returns 0 if the angle between the two is 90 degrees or more. Therefore a single step is not taken for a movement.
    """
    length = float(np.linalg.norm(velocity))
    goes_on = length > 0.0 and float(velocity @ before) > 0.0
    share = min(1.0, float(np.linalg.norm(before)) / length) if goes_on else 0.0
    return share * velocity


class Steering:
    """Steers rows of gains along a motion."""

    def __init__(self, array: Array, medium: Air) -> None:
        self._data = KernelData.prepare(array, medium)
        self.reset()

    def reset(self) -> None:
        """Follow no motion."""
        self._motion: Motion | None = None
        self._place = np.zeros(3)  # place to which the last row was steered [m]
        self._factor: Gains | None = None  # factors on the gains of that row, (N,)
        self._behind, self._span, self._left = np.zeros(3), 1, 0  # see `follow`

    @property
    def settled(self) -> bool:
        """Whether the next rows are steered to the same place as the last one, if nothing changes."""
        return self._motion is None or not (self._left or self._motion.velocity.any())

    def follow(self, motion: Motion | None, t: float, ticks: int) -> Gains | None:
        """Follow a motion from time t [s] on; None for no motion.

        ticks: number of ticks over which to catch up with the place of the motion. Returns the factors, (N,), by which
        the gains of the previous solution must be multiplied so that their field stays the same; None if there is
        nothing to multiply.
        """
        last, self._motion = self._motion, motion
        if motion is last:
            return None
        near, factors = False, None
        if last is not None:
            if motion is not None and motion.continues:
                way = motion.find_place(t) - self._place
                near = float(np.linalg.norm(way)) <= MAX_JUMP
            centre = motion.centre if motion is not None and near else self._place
            if not np.array_equal(last.centre, centre):
                factors = self.find_factors(last.centre, centre)
        if motion is None:
            self.reset()
            return factors
        if not near:
            self._place = motion.centre
        if not near or factors is not None:
            self._factor = None
        self._behind, self._span, self._left = self._place - motion.find_place(t), ticks, ticks
        return factors

    def steer(self, rows: Gains, t: float) -> None:
        """Steer rows of a tick that begins at time t [s], (K, N), in place."""
        motion = self._motion
        if motion is None:
            return
        if self._factor is None:
            self._factor = self.find_factors(motion.centre, self._place)
        before = self._factor
        if not self.settled:
            self._place = motion.find_place(t)
            if self._left:
                self._left -= 1
                self._place = self._place + self._left / self._span * self._behind
            self._factor = self.find_factors(motion.centre, self._place)
        K = len(rows)
        if K == 1 or before is self._factor:
            rows *= self._factor
            return
        share = (np.arange(1, K + 1, dtype=np.float32) / np.float32(K))[:, None]
        rows *= before + share * (self._factor - before)

    def steer_like_last(self, gains: Gains) -> Gains:
        """Return gains, (K, N), steered like the last row."""
        return gains if self._motion is None or self._factor is None else gains * self._factor

    def find_factors(self, centre: Floats, place: Floats) -> Gains:
        """Return the factor on each gain that moves the field around `centre` to `place`, (3,) [m]: (N,)."""
        return _find_factors(self._data, centre, place)


def find_factors(array: Array, medium: Air, centre: Floats, place: Floats) -> Gains:
    """Return the factor on each gain that moves the field around `centre` to `place`, (3,) [m]: (N,)."""
    return _find_factors(KernelData.prepare(array, medium), centre, place)


def _find_factors(data: KernelData, centre: Floats, place: Floats) -> Gains:
    from pacinian.native import rendering as kernels

    factors: Gains = np.empty(data.r.shape[1], np.complex64)
    ends = (np.array([centre, place]) - data.origin).astype(np.float32)
    turns, exponent = data.law[:2].tolist()
    kernels.find_factors(data.r, turns, exponent, ends[0], ends[1], MAX_RATIO, factors)
    return factors
