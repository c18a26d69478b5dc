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

INNER = 0.25  # smallest distance from a silent sample to its region, over the resolution
SURROUND_SPACING = 0.22  # spacing of silent samples, over the resolution


class Surround(NamedTuple):
    """How many silent samples there are.

    outer: largest distance from a sample of the first ring to its region, over the resolution. share: maximum ratio of
    such samples to pressing ones. max_transducers: of an array that is not elongated, for a second ring.
    """

    outer: float
    share: float
    max_transducers: int


SURROUND = Surround(1.2, 1.0 / 3.0, 0)  # if solves must be fast
# Otherwise. With more silent samples that lie farther away, the pressure 10 to 30 mm beside contacts is lower.
FINE_SURROUND = Surround(2.0, 1.2, 1000)
MAX_OF_SMALL = 48  # maximum number of samples of the first ring where the ratio allows fewer
MIN_ELONGATION = 1.4  # ratio of length to width from which foci are elongated
# Of the second ring: its outer radius and its spacing, over the resolution, and its maximum number of samples.
FAR, FAR_SPACING, MAX_FAR = 5.0, 0.5, 96
MAX_FAR_SHARE = 0.5  # of all silent samples that the budget allows


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
    of = np.flatnonzero((samples.regions >= 0) & (samples.radiation_pressure > 0.0))
    near = max(MAX_OF_SMALL, int(surround.share * len(of)))
    rings = [(SURROUND_SPACING, INNER, surround.outer, near)]
    if elongation >= MIN_ELONGATION or len(resolving.array) <= surround.max_transducers:
        far = min(MAX_FAR, near, int(MAX_FAR_SHARE * most))
        rings.insert(0, (FAR_SPACING, surround.outer, FAR, far))
    q, every = samples.positions[of], [samples]
    for spacing, inner, outer, limit in rings if len(of) else ():
        left = min(most, limit)
        most -= left
        for hand in hands if left > 0 else ():
            nodes, nearest = hand.around(
                q,
                spacing * resolved,
                inner * resolved,
                outer * resolved,
                resolving.centre,
                left,
            )
            if len(nodes):
                every.append(
                    _silent(samples, of[nearest], hand, nodes, SURROUND_SPACING * resolved)
                )
                left -= len(nodes)
        most += left
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
