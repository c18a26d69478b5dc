"""The surround: skin beside what is touched, of which silence is asked.

Samples say how the field presses where something is touched. They say nothing of the skin beside it, where the
field presses with one to five times the mean of what is asked. A sparse ring of silent samples, which count little,
keeps it away.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.sampling.samples import BESIDE, join_samples
from pacinian.scene.sampling.sources import make_keys

if TYPE_CHECKING:
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats, Indices

INNER, OUTER = 0.25, 0.9  # of what the array resolves: how far from its region a silent sample is
APART = 0.45  # of that, from one silent sample to the next
SHARE = 1.0 / 3.0  # silent samples for each that presses, at most; more do little
MOST_OF_SMALL = 24  # silent samples, where that share is less


def add_surround(
    samples: Samples, hands: list[PosedSkin], centre: Floats, resolved: float, most: int
) -> Samples:
    """Add silent samples on the skin beside the regions that touch it.

    At most a third as many as press, or 24 where that is less, evenly spread. centre: of the array, (3,) [m]; skin that
    faces away from it has none. resolved: by the array, there [m]. most: silent samples at most.
    """
    of = np.flatnonzero((samples.regions >= 0) & (samples.radiation_pressure > 0.0))
    most = min(most, max(MOST_OF_SMALL, int(SHARE * len(of))))
    if most <= 0 or not len(of):
        return samples
    q, every = samples.positions[of], [samples]
    for hand in hands:
        nodes, nearest = hand.around(
            q, APART * resolved, INNER * resolved, OUTER * resolved, centre
        )  # fmt: skip
        nodes, nearest = nodes[:most], nearest[:most]
        if len(nodes):
            silent = _silent(samples, of[nearest], hand.points[nodes], hand.normals[nodes])
            silent.keys[:] = make_keys(hand.salt % (1 << 31), APART * resolved, nodes)
            every.append(silent)
            most -= len(nodes)
    return join_samples(every)


def _silent(samples: Samples, beside: Indices, points: Floats, normals: Floats) -> Samples:
    """Silent samples beside those of the indices `beside`, (K,): they stand for no area."""
    made = samples.only(beside)
    made.positions[:], made.normals[:] = points, normals
    made.radiation_pressure[:] = made.area[:] = 0.0
    made.regions[:] = BESIDE
    return made
