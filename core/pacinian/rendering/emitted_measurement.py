"""Measure the emitted field between the samples at intervals."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import sound_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.region_numbers import BESIDE
from pacinian.rendering.reachability import ReachabilityFilter
from pacinian.scene.sampling.sample_counts import label_object
from pacinian.scene.sampling.touched_skin import stays_on_skin
from pacinian.solving.felt_figures import FeltSums
from pacinian.solving.felt_places import FeltPlaces
from pacinian.solving.propagator import Propagator
from pacinian.solving.targets import Targets

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.types import Floats, Gains

PLACES = 24  # number of places between samples in one measurement; many measurements are added
PLACES_ON_SKIN = 48  # the same on touched skin, and beside it
MIN_AREA = 1e-12  # smallest area that a sample with a region represents [m^2]
SAMPLES = 48  # number of samples of a steered field in one measurement


class Probe:
    """Measures at different random places each time, so that many measurements together cover the regions."""

    def __init__(self, session: Session) -> None:
        self._propagator = Propagator(session.array, session.medium)
        self._reach = ReachabilityFilter(self._propagator)
        self._rng = np.random.default_rng(0)
        # Copies of the last input of `compute_pressures`.
        self._asked: tuple[Floats | Gains, ...] = ()
        self._heard: Floats = np.empty(0)

    def measure_between(
        self, samples: Samples, targets: Targets, facing: SkinFacing | None, gains: Gains
    ) -> dict[str, FeltSums]:
        """Return the sums at some places between samples, by the label of each object that has regions.

        Contacts that stay on skin are left out: see `measure_on_skin`. targets, facing: of the samples. gains: (K, N),
        of the frames whose mean is felt.
        """
        found: dict[str, FeltSums] = {}
        regions = targets.regions
        if regions is None:
            return found
        items, objects = samples.items, samples.objects
        rest = regions >= 0
        if facing is not None:
            rest &= ~np.isin(objects, [i for i, item in enumerate(items) if stays_on_skin(item)])
        if not rest.any():
            return found
        area = np.where(rest, np.maximum(samples.area, MIN_AREA), 0.0)
        places = FeltPlaces.random_places(
            samples.positions, targets, facing, PLACES, self._rng, area
        )
        every = places.sums(self._measure(places.points, places.facing, gains))
        for number in np.unique(regions[rest]).tolist():
            i = int(objects[np.flatnonzero(regions == number)[0]])
            label = label_object(items[i], i)
            found[label] = found.get(label, FeltSums()).plus(every[number])
        return found

    def measure_on_skin(self, places: Samples, gains: Gains) -> dict[str, FeltSums]:
        """Return the sums at places on touched skin and beside it, by the label of each object that touches it.

        places: as returned by `TouchedSkinObserver.scatter_places`. gains: as for `measure_between`.
        """
        found: dict[str, FeltSums] = {}
        if not len(places) or places.capsules is None:
            return found
        facing = SkinFacing(places.normals, places.capsules)
        P = places.radiation_pressure * self._reach.weigh_targets(
            places.positions, facing, Counter()
        )
        p, t = self._hear(gains), sound_pressure(P, self._propagator.medium)
        which, number = np.unique(places.objects, return_inverse=True)
        beside = places.regions == BESIDE
        measured = FeltPlaces(
            places.positions, t * t, number, beside, facing, len(which), np.ones(len(places))
        )
        for i, sums in zip(which.tolist(), measured.sums(p), strict=True):
            label = label_object(places.items[i], i)
            found[label] = found.get(label, FeltSums()).plus(sums)
        return found

    def estimate_error_at_samples(self, samples: Samples, targets: Targets, gains: Gains) -> float:
        """Return the relative error of the sound pressures at some samples in free air.

        The samples are other ones in each call. targets: of the samples. gains: as for `measure_between`.
        """
        some = self._rng.permutation(len(samples))[:SAMPLES]
        p = self._measure(samples.positions[some], None, gains)
        return Targets.make_unchecked(targets.amplitudes[some]).relative_error(p)

    def compute_pressures(self, points: Floats, facing: SkinFacing | None, gains: Gains) -> Floats:
        """Return the root mean square over the frames of the pressure amplitude at points, (M, 3) [m], (M,) [Pa].

        gains: of the frames, (K, N). If the input is that of the last call, the last result is returned.
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
        return self._hear(gains)

    def _hear(self, gains: Gains) -> Floats:
        """Return the root mean square of the pressure amplitude at the propagator's points, (M,) [Pa]."""
        p = np.array([self._propagator.apply(g) for g in gains])
        return np.asarray(np.sqrt((np.abs(p).astype(np.float64) ** 2).mean(axis=0)))
