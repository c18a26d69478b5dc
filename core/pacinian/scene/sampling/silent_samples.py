"""The surround: silent samples on the skin beside touched regions.

The samples of a region do not constrain the field on the skin beside it. There, the field would press with one to five
times the mean target pressure. A sparse ring of silent samples of low weight prevents this.

A ring also pushes sound outwards: just beyond it, the skin may get several times the mean. A second, wider ring
prevents this. Contacts above an elongated array, such as two units side by side, always have it: its main lobe is wide
along its short side. Above other small arrays, contacts have it if solves may take long. Large arrays hardly need it,
and a solve for them would take up to five times as long.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.region_numbers import BESIDE
from pacinian.scene.sampling.sample_keys import NUMBERS, make_keys
from pacinian.scene.sampling.samples import join_samples

if TYPE_CHECKING:
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Indices

# Smallest distance from a silent sample to its region, over the resolution.
MIN_RING_DISTANCE = 0.25
SURROUND_SPACING = 0.22  # spacing of silent samples, over the resolution


class Surround(NamedTuple):
    """How many silent samples there are.

    outer: largest distance from a sample of the first ring to its region, over the resolution. max_ratio: maximum ratio
    of such samples to pressing ones. max_transducers: arrays that are not elongated have a second ring up to this
    number of transducers.
    """

    outer: float
    max_ratio: float
    max_transducers: int


# If solves must be fast: few silent samples, near the contacts.
FAST_SURROUND = Surround(1.2, 1.0 / 3.0, 0)
# If solves may take long: more silent samples, also farther away. They lower the pressure 10 to 30 mm beside contacts.
FINE_SURROUND = Surround(2.0, 1.2, 1000)
# The limit of the first ring is at least this, whatever the ratio allows.
MIN_RING_LIMIT = 48
MIN_ELONGATION = 1.4  # ratio of length to width from which foci are elongated
# Largest distance from a sample of the second ring to its region, and the spacing of these samples, both over the
# resolution.
SECOND_RING_RADIUS, SECOND_RING_SPACING = 5.0, 0.5
MAX_SECOND_RING_SAMPLES = 96
# Largest share of the second ring in the silent samples that the budget allows.
MAX_SECOND_RING_SHARE = 0.5


def add_surround(
    samples: Samples,
    hands: list[PosedSkin],
    resolving: ArrayResolution,
    most: int,
    surround: Surround,
) -> Samples:
    """Add evenly spread silent samples on the skin beside the regions that touch it.

    Skin that faces away from the array gets none. most: limit of the number of silent samples.
    """
    places = [hand.centre for hand in hands]
    resolved = min(map(resolving.compute_isolated_spacing, places))
    elongation = max(map(resolving.compute_elongation, places))
    pressing = np.flatnonzero((samples.regions >= 0) & (samples.radiation_pressure > 0.0))
    first_limit = max(MIN_RING_LIMIT, int(surround.max_ratio * len(pressing)))
    rings = [(SURROUND_SPACING, MIN_RING_DISTANCE, surround.outer, first_limit)]
    if elongation >= MIN_ELONGATION or len(resolving.array) <= surround.max_transducers:
        second_limit = min(MAX_SECOND_RING_SAMPLES, first_limit, int(MAX_SECOND_RING_SHARE * most))
        rings.insert(0, (SECOND_RING_SPACING, surround.outer, SECOND_RING_RADIUS, second_limit))
    q, every = samples.positions[pressing], [samples]
    for spacing, inner, outer, limit in rings if len(pressing) else ():
        remaining = min(most, limit)
        most -= remaining
        for hand in hands if remaining > 0 else ():
            nodes, nearest = hand.around(
                q,
                spacing * resolved,
                inner * resolved,
                outer * resolved,
                resolving.centre,
                remaining,
            )
            if len(nodes):
                every.append(
                    _silent(samples, pressing[nearest], hand, nodes, SURROUND_SPACING * resolved)
                )
                remaining -= len(nodes)
        most += remaining
    return join_samples(every)


def _silent(
    samples: Samples, beside: Indices, hand: PosedSkin, nodes: Indices, spacing: float
) -> Samples:
    """Make silent samples of no area on `nodes`, (K,). Their objects are those of the samples `beside`, (K,)."""
    K = len(nodes)
    return samples.changed(
        positions=hand.points[nodes],
        normals=hand.normals[nodes],
        radiation_pressure=np.zeros(K),
        area=np.zeros(K),
        objects=samples.objects[beside],
        most=samples.most[beside],
        keys=make_keys(hand.salt % NUMBERS, spacing, nodes),
        regions=np.full(K, BESIDE),
    )
