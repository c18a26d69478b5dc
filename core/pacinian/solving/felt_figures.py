"""What is felt of a region: force, rms error, holes and spill, and the sums from which they are computed."""

from __future__ import annotations

import math
from typing import NamedTuple

MIN_FELT_SHARE = 0.5  # share of the target below which a place counts as a hole
# Largest relative error of the force, and largest rms error, of a region that is within tolerance: `FeltRegion.even`.
MAX_FORCE_ERROR, MAX_RMS_ERROR = 0.05, 0.10


class FeltRegion(NamedTuple):
    """What is felt of one region, relative to its target. All pressures are radiation pressures.

    force: relative to the target force; 1 is right. rms: root mean square error, relative to the root mean square of
    the target. holes: fraction of the region with less than half the target. spill: highest pressure 3 to 5 mm beside
    the region, relative to the mean target. Evaluated between the samples; by a loop on skin, over all touched skin
    and 3 to 30 mm beside it. For a region with target 0: 1, 0, 0, 0.
    """

    force: float = 1.0
    rms: float = 0.0
    holes: float = 0.0
    spill: float = 0.0

    def __str__(self) -> str:
        return (
            f"force {self.force:.1%} of what was asked, rms error {self.rms:.1%}, "
            f"{self.holes:.1%} holes, {self.spill:.0%} beside it"
        )

    @property
    def even(self) -> bool:
        """Whether the region is within the tolerance of status `ok`: force within 5 %, rms at most 0.10, no holes.

        Solvers use another measure for the strongest even field (`scale="max"`): its error at the samples.
        """
        within = abs(self.force - 1.0) <= MAX_FORCE_ERROR and self.rms <= MAX_RMS_ERROR
        return within and not self.holes


class FeltSums(NamedTuple):
    """Sums over weighted places, from which `FeltRegion` is computed; those of several points in time can be added.

    places: sum of the weights of the places in the region. made, asked: of the squared sound pressure amplitudes,
    achieved and target [Pa^2]. errors, squares: of the squares of their difference, and of `asked` [Pa^4]. holes: of
    the weights of places with less than half the target. beside: highest squared amplitude beside the region [Pa^2].
    """

    places: float = 0.0
    made: float = 0.0
    asked: float = 0.0
    errors: float = 0.0
    squares: float = 0.0
    holes: float = 0.0
    beside: float = 0.0

    def plus(self, other: FeltSums) -> FeltSums:
        """Return the sums of both."""
        return FeltSums(
            self.places + other.places,
            self.made + other.made,
            self.asked + other.asked,
            self.errors + other.errors,
            self.squares + other.squares,
            self.holes + other.holes,
            max(self.beside, other.beside),
        )

    @property
    def felt(self) -> FeltRegion:
        """The figures of the region."""
        if not self.asked:
            return FeltRegion()
        rms = math.sqrt(self.errors / self.squares)
        mean = self.asked / self.places
        return FeltRegion(self.made / self.asked, rms, self.holes / self.places, self.beside / mean)
