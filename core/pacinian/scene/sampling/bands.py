"""Bands: parts of what is too large to sound at once. They sound in turn, and their mean is the whole."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

BLEND = 0.15  # of a band's samples, to either side of its edge: there both bands press
WIDER = 1.0 + 2.0 * BLEND  # so many times its own samples sound in a band
MIN_DIVIDED_SAMPLES = 32  # samples of a region that is never divided
STEADY = 0.7  # of the longest side: bands stay across a side that is no shorter
FADING = 1.1  # of the budget: samples that fade come on top of it, for some ticks, and need no band
SPARE = 0.9  # of the budget, within which fewer bands must fit before there are fewer


class Bands:
    """Divides the regions of samples into bands. It remembers how, so that bands stay where they are."""

    def __init__(self) -> None:
        self._count = 1
        self._axes: dict[int, int] = {}

    def shares(self, samples: Samples, budget: int, most: int) -> Floats:
        """Of each sample's pressure the share in each band, (M, K); each sample's sum to 1.

        K is as few as bring a band to at most `budget` samples, and at most `most`. Regions of more than 32 samples
        are cut across their longest side into K bands of equal number. All else has the same share in each.
        """
        if most == 1 or len(samples) <= SPARE * budget:
            self._count = 1
            return np.ones((len(samples), 1))
        regions, counts = np.unique(samples.regions, return_counts=True)
        large = regions[(regions >= 0) & (counts > MIN_DIVIDED_SAMPLES)]
        divided = np.isin(samples.regions, large)
        many = int(divided.sum())
        few = len(samples) - many

        def fits(count: int, budget: float) -> bool:
            return (
                few + many * (WIDER / count) <= budget
                if count > 1
                else few + many <= FADING * budget
            )

        count = next((K for K in range(1, most) if fits(K, budget)), most) if many else 1
        if count < self._count <= most and not fits(count, SPARE * budget):
            count = self._count
        self._count = count
        shares = np.full((len(samples), count), 1.0 / count)
        if count > 1:
            self._axes = {name: self._axis(samples, name) for name in large.tolist()}
            for name, axis in self._axes.items():
                own = np.flatnonzero(samples.regions == name)
                shares[own] = _cut(samples.positions[own, axis], count)
        return shares

    def _axis(self, samples: Samples, region: int) -> int:
        """Of the world, the one along which a region is longest, or nearly so and was before."""
        q = samples.positions[samples.regions == region]
        sides = q.max(axis=0) - q.min(axis=0)
        last = self._axes.get(region)
        if last is not None and sides[last] >= STEADY * sides.max():
            return last
        return int(sides.argmax())


def _cut(x: Floats, count: int) -> Floats:
    """Shares of samples in bands of equal number along x, (M,) [m]: (M, count)."""
    M = len(x)
    u = np.empty(M)
    u[np.argsort(x, kind="stable")] = count * (np.arange(M) + 0.5) / M
    edges = np.arange(count + 1.0)
    edges[0], edges[-1] = -math.inf, math.inf
    past = np.clip((u[:, None] - edges + BLEND) / (2.0 * BLEND), 0.0, 1.0)  # (M, count + 1)
    return past[:, :-1] - past[:, 1:]
