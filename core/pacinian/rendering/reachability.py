"""Find the samples that sound can reach, and the fraction of the sound that presses on each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.propagation import SAMPLE_TOUCHING_DISTANCE, matrix
from pacinian.argument_checks import MAX_LENGTH
from pacinian.errors import PointOnTransducer
from pacinian.native import rendering as kernels
from pacinian.scene.sampling.array_resolution import FULL_PRESSURE_COS2, weigh_incidence
from pacinian.skip_reasons import SAMPLES_HARDLY_REACHED, SAMPLES_ON_TRANSDUCER, SAMPLES_TOO_FAR

if TYPE_CHECKING:
    from collections import Counter

    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.solving.propagator import Propagator
    from pacinian.types import Flags, Floats, Longs

# Cell size of the power cache [m], and largest number of its cells.
CELL_SIZE, MAX_CELLS = 0.02, 10_000
MAX_SUBSET = 128  # largest number of transducers used to compute the power in a cell
MIN_CELL_POWER = 1e-300  # smallest power in a cell, because it is used as a divisor [Pa^2]
WEAKENED_BELOW = 0.5  # share of a target below which its sample counts as weakened


class ReachabilityFilter:
    """Drops or weakens samples that the array of a propagator cannot reach. Sets the propagator's points."""

    def __init__(self, propagator: Propagator) -> None:
        array = propagator.array
        self._array, self._medium, self._propagator = array, propagator.medium, propagator
        self._some = _choose_subset(array)
        self._cells: Longs = np.empty(0, np.int64)  # known cells, ascending
        self._powers: Floats = np.empty(0)  # in these cells [Pa^2]
        away = np.abs(array.positions - self._propagator.origin)
        self._extent = away.max(axis=0) + SAMPLE_TOUCHING_DISTANCE  # [m]

    def find_reachable(self, q: Floats, skipped: Counter[str]) -> Flags:
        """Return which points of q, (M, 3) [m], sound can reach, (M,): not too far away, and not on a transducer.

        skipped: counts the other points, by reason.
        """
        if (unreachable := self.find_unreachable(q)) is None:
            return np.ones(len(q), dtype=np.bool_)
        far, on = unreachable
        for reason, found in (
            (SAMPLES_TOO_FAR, far),
            (SAMPLES_ON_TRANSDUCER, on),
        ):
            if found.any():
                skipped[reason] += int(found.sum())
        return ~(far | on)

    def find_unreachable(self, q: Floats) -> tuple[Flags, Flags] | None:
        """Return which points of q, (M, 3) [m], are too far away, (M,), and which lie on a transducer, (M,).

        Returns None if all are clearly reachable.
        """
        if not kernels.locate(q, self._propagator.origin, self._extent, MAX_LENGTH / 2.0):
            return None
        far, on = np.zeros((2, len(q)), dtype=np.bool_)
        d = np.abs(q - self._propagator.origin)
        if d.max() > MAX_LENGTH / 2.0:
            far = np.asarray((d * d).sum(axis=1) > MAX_LENGTH * MAX_LENGTH)
        inside = (d <= self._extent).all(axis=1)
        if self._medium.singular and inside.any():
            for m in np.flatnonzero(inside & ~far):
                r = self._array.positions - q[m]
                on[m] = (r * r).sum(
                    axis=1
                ).min() < SAMPLE_TOUCHING_DISTANCE**2  # where no hand can be
        return far, on

    def weigh_targets(self, q: Floats, facing: SkinFacing, skipped: Counter[str]) -> Floats:
        """Set the propagator's points to q, (M, 3) [m], and return the factor on the target of each sample there, (M,).

        The factor says how well the array sees the skin. skipped: counts the samples that it weakens clearly.
        """
        self._propagator.set_points(q, facing)
        seen = self._propagator.powers / self._free(q)
        if seen.min() >= FULL_PRESSURE_COS2:
            return np.ones(len(q))
        factors = weigh_incidence(seen)
        skipped[SAMPLES_HARDLY_REACHED] += int((factors < WEAKENED_BELOW).sum())
        return factors

    def _free(self, q: Floats) -> Floats:
        """Return the power of the sound at points q, (M, 3) [m], without facing and occlusion, (M,) [Pa^2]."""
        if len(self._cells) > MAX_CELLS:
            self._cells, self._powers = self._cells[:0], self._powers[:0]
        powers, missing = np.empty(len(q)), np.empty(len(q), np.int64)
        count = kernels.look_up(q, CELL_SIZE, self._cells, self._powers, powers, missing)
        if count:
            try:
                self._learn(np.unique(missing[:count]))
            except PointOnTransducer:  # so close to a transducer, all sound counts
                return np.full(len(q), MIN_CELL_POWER)
            kernels.look_up(q, CELL_SIZE, self._cells, self._powers, powers, missing)
        return powers

    def _learn(self, new: Longs) -> None:
        """Compute the powers of cells of these numbers, ascending, and keep them."""
        z, rest = new % kernels.SIDE, new // kernels.SIDE
        place = np.stack([rest // kernels.SIDE, rest % kernels.SIDE, z], axis=1) - kernels.LARGEST
        B = matrix(self._some, CELL_SIZE * (place + 0.5), self._medium)
        share = len(self._array) / len(self._some)
        powers = np.maximum(share * (np.abs(B) ** 2).sum(axis=1), MIN_CELL_POWER)
        cells = np.concatenate([self._cells, new])
        order = np.argsort(cells, kind="stable")
        self._cells, self._powers = cells[order], np.concatenate([self._powers, powers])[order]


def _choose_subset(array: Array) -> Array:
    """Return an array of at most MAX_SUBSET transducers, spread over the whole array."""
    step = -(-len(array) // MAX_SUBSET)
    r, n, s = array.positions[::step], array.normals[::step], array.responses[::step]
    return Array(r, n, array.transducer, s)
