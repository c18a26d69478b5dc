"""The surround: silent samples on the skin beside touched regions.

The samples of a region do not constrain the field on the skin beside it. There, the field would press with one to five
times the mean target pressure. A sparse ring of silent samples of low weight prevents this.

An elongated array, such as two units side by side, has a wide main lobe along its short side. There, a ring pushes the
sound outwards: just beyond it, the skin would get up to thirty times the mean. A second, wider ring prevents this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.region_numbers import BESIDE
from pacinian.scene.sampling.sample_keys import NUMBERS, make_keys
from pacinian.scene.sampling.samples import join_samples

if TYPE_CHECKING:
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats, Indices

INNER = 0.25  # smallest distance from a silent sample to its region, over the resolution
SURROUND_SPACING = 0.22  # spacing of silent samples, over the resolution


class Surround(NamedTuple):
    """How many silent samples there are.

    outer: largest distance from a silent sample to its region, over the resolution. share: maximum ratio of silent to
    pressing samples.
    """

    outer: float
    share: float


SURROUND = Surround(1.2, 1.0 / 3.0)  # if solves must be fast
# Otherwise. With more silent samples that lie farther away, the pressure 10 to 30 mm beside contacts is lower.
FINE_SURROUND = Surround(2.0, 1.2)
MAX_OF_SMALL = 48  # maximum number of silent samples where the ratio allows fewer
# Foci this many times longer than wide are elongated: the array has a second ring of silent samples.
MIN_ELONGATION = 1.4
# Of this ring: its outer radius and its spacing, over the resolution, and its maximum number of samples.
FAR, FAR_SPACING, MAX_FAR = 5.0, 0.5, 96
NEAR_SHARE = 2.0 / 3.0  # factor on `Surround.share` for the first ring if there is a second one


def add_surround(
    samples: Samples, hands: list[PosedSkin], centre: Floats, resolved: float, elongation: float, most: int,
    surround: Surround,
) -> Samples:  # fmt: skip
    """Add evenly spread silent samples on the skin beside the regions that touch it.

    centre: of the array, (3,) [m]; skin that faces away from it gets none. resolved: resolution of the array there [m].
    elongation: of the array's foci there. most: limit of the number of silent samples. surround: their largest
    distance, and their largest share of the pressing samples; 48 are always allowed. Elongated foci add a ring farther
    out.
    """
    of = np.flatnonzero((samples.regions >= 0) & (samples.radiation_pressure > 0.0))
    elongated = elongation >= MIN_ELONGATION
    share = surround.share * (NEAR_SHARE if elongated else 1.0)
    near = max(MAX_OF_SMALL, int(share * len(of)))
    rings = [(SURROUND_SPACING, INNER, surround.outer, near)]
    if elongated:
        far = min(MAX_FAR, near, most // 2)
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
                centre,
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
