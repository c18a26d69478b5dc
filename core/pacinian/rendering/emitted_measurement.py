"""Measure the emitted field between the samples at intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.neighbours import find_nearest
from pacinian.scene.sampling.samples import BESIDE
from pacinian.solving.felt_regions import BESIDE as DISTANCES
from pacinian.solving.felt_regions import FeltPlaces, FeltSums
from pacinian.solving.problem import Targets
from pacinian.solving.propagator import Propagator

if TYPE_CHECKING:
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.types import Floats, Gains

# Smallest distance from the samples of a region at which a silent sample counts as a place beside it [m].
MIN_DISTANCE = DISTANCES[0]
PLACES = 24  # number of places between samples in one measurement; many measurements are added
SAMPLES = 48  # number of samples of a steered field in one measurement


class Probe:
    """Measures at different random places each time, so that many measurements together cover the regions."""

    def __init__(self, session: Session) -> None:
        self._propagator = Propagator(session.array, session.medium)
        self._chance = np.random.default_rng(0)
        # Copies of the last input of `compute_pressures`.
        self._asked: tuple[Floats | Gains, ...] = ()
        self._heard: Floats = np.empty(0)

    def look(
        self,
        samples: Samples,
        targets: Targets,
        facing: SkinFacing | None,
        gains: Gains,
        p: Floats,
    ) -> dict[str, FeltSums]:
        """Return the sums from which felt pressures are computed, by the name of each object that has regions.

        On skin, the silent samples 3 mm and more beside a region count as places beside it, because the highest
        pressure lies at few places. targets, facing: of the samples. gains: as emitted, (K, N), of the frames whose
        mean is felt. p: pressure amplitudes at the samples, (M,) [Pa], as returned by `compute_pressures`.
        """
        if (regions := targets.regions) is None:
            return {}
        places = FeltPlaces.some(samples.positions, targets, facing, PLACES, self._chance)
        if places is None:
            return {}
        found: dict[str, FeltSums] = {}
        for number, sums in enumerate(
            places.sums(self._measure(places.points, places.facing, gains))
        ):
            item = samples.items[samples.objects[np.flatnonzero(regions == number)[0]]]
            found[name_of(item)] = found.get(name_of(item), FeltSums()).plus(sums)
        silent = np.flatnonzero(samples.regions == BESIDE)
        pressing = samples.positions[(samples.regions >= 0) & (targets.amplitudes > 0.0)]
        if len(silent) and len(pressing):
            away = find_nearest(pressing, samples.positions[silent])[0]
            for m in silent[away >= MIN_DISTANCE]:
                name = name_of(samples.items[samples.objects[m]])
                if name in found:
                    found[name] = found[name].plus(FeltSums(beside=float(p[m] ** 2)))
        return found

    def estimate_error(self, samples: Samples, targets: Targets, gains: Gains) -> float:
        """Return the relative error of the sound pressures at some samples in free air, other ones each time.

        targets: of the samples. gains: as for `look`.
        """
        some = self._chance.permutation(len(samples))[:SAMPLES]
        p = self._measure(samples.positions[some], None, gains)
        return Targets.make_unchecked(targets.amplitudes[some]).relative_error(p)

    def compute_pressures(self, points: Floats, facing: SkinFacing | None, gains: Gains) -> Floats:
        """Return the root mean square over the frames of the pressure amplitude at points, (M, 3) [m], (M,) [Pa].

        gains: of the frames, (K, N). The same input again, as of a still scene, costs only the comparison.
        """
        asked: tuple[Floats | Gains, ...] = points, gains
        if facing is not None:
            asked += facing.normals, facing.capsules, np.array(facing.edge)
        if len(asked) != len(self._asked) or not all(map(np.array_equal, asked, self._asked)):
            self._asked, self._heard = (), self._measure(points, facing, gains)
            self._asked = tuple(each.copy() for each in asked)
            self._heard.flags.writeable = False
        return self._heard

    def _measure(self, points: Floats, facing: SkinFacing | None, gains: Gains) -> Floats:
        self._propagator.set_points(points, facing)
        p = np.array([self._propagator.apply(g) for g in gains])
        return np.asarray(np.sqrt((np.abs(p).astype(np.float64) ** 2).mean(axis=0)))


def name_of(item: Object) -> str:
    """Return the object's name, or its type if it has none."""
    return item.name or type(item).__name__.lower()
