"""Feels now and then, between the samples, what is emitted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.solving.felt_regions import FeltPlaces, FeltSums
from pacinian.solving.propagator import Propagator

if TYPE_CHECKING:
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.solving.problem import Targets
    from pacinian.types import Floats, Gains

PLACES = 24  # between samples in one look; many looks add up


class Probe:
    """Looks at other places each time, so that the figures of many looks are those of the regions as a whole."""

    def __init__(self, session: Session) -> None:
        self._propagator = Propagator(session.array, session.medium)
        self._chance = np.random.default_rng(0)

    def look(
        self, samples: Samples, targets: Targets, facing: SkinFacing | None, gains: Gains
    ) -> dict[str, FeltSums]:
        """What is felt of each object that has a region, by its name.

        targets, facing: of the samples. gains: as emitted, (K, N), of the frames whose mean is felt.
        """
        if (regions := targets.regions) is None:
            return {}
        places = FeltPlaces.some(samples.positions, targets, facing, PLACES, self._chance)
        if places is None:
            return {}
        found: dict[str, FeltSums] = {}
        for number, sums in enumerate(places.sums(self.hear(places.points, places.facing, gains))):
            item = samples.items[samples.objects[np.flatnonzero(regions == number)[0]]]
            found[name_of(item)] = found.get(name_of(item), FeltSums()).plus(sums)
        return found

    def hear(self, points: Floats, facing: SkinFacing | None, gains: Gains) -> Floats:
        """Sound pressure amplitude at points (M, 3) [m] that presses as the mean of the frames does, (M,) [Pa].

        gains: of the frames, (K, N).
        """
        self._propagator.set_points(points, facing)
        p = np.array([self._propagator.apply(g) for g in gains])
        return np.asarray(np.sqrt((np.abs(p).astype(np.float64) ** 2).mean(axis=0)))


def name_of(item: Object) -> str:
    """Its name, or what kind of object it is."""
    return item.name or type(item).__name__.lower()
