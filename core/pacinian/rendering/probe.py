"""Feels now and then, between the samples, what is emitted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.solving.felt import Places, Sums
from pacinian.solving.propagator import Propagator

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.solving.solution import Solution
    from pacinian.types import Gains

PLACES = 24  # between samples in one look; many looks add up


class Probe:
    """Looks at other places each time, so that the figures of many looks are those of the regions as a whole."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._propagator = Propagator(session.array, session.medium)
        self._chance = np.random.default_rng(0)

    def look(self, samples: Samples, solution: Solution, gains: Gains) -> dict[str, Sums]:
        """What is felt of each object that has a region, by its name.

        samples: of the solution, where the session's propagator is. gains: as emitted, (N,).
        """
        if solution.targets.regions is None:
            return {}
        q, facing = samples.positions, self._session.propagator.facing
        places = Places.some(q, solution.targets, facing, PLACES, self._chance)
        if places is None:
            return {}
        self._propagator.place(places.points, places.facing)
        found: dict[str, Sums] = {}
        regions = solution.targets.regions
        for number, sums in enumerate(places.sums(self._propagator.apply(gains))):
            item = samples.items[samples.objects[np.flatnonzero(regions == number)[0]]]
            found[name_of(item)] = found.get(name_of(item), Sums()).plus(sums)
        return found


def name_of(item: Object) -> str:
    """Its name, or what kind of object it is."""
    return item.name or type(item).__name__.lower()
