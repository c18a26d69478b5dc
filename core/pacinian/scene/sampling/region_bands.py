"""Bands: parts of a region that is too large to sound at once. They sound in turn, and their mean is the region."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.region_numbers import BESIDE

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

OVERLAP_SHARE = 0.15  # half-width of the overlap of two bands, as a fraction of a band's samples
# Samples that sound in a band, overlap included, over its own samples.
WIDER = 1.0 + 2.0 * OVERLAP_SHARE
MIN_DIVIDED_SAMPLES = 32  # regions of up to this number of samples are never divided
# Bands stay along their axis while the region there is at least this fraction of its longest side.
MIN_KEPT_LENGTH = 0.7
FADING = 1.1  # one band may exceed the budget by this factor, because fading samples add to it for some ticks
SPARE = 0.9  # the number of bands decreases only if fewer fit into this fraction of the budget


class Bands:
    """Divides the regions of samples into bands. It keeps state, so that bands stay in place from tick to tick."""

    def __init__(self) -> None:
        self._count = 1
        self._axes: dict[int, int] = {}

    def shares(self, samples: Samples, budget: int, most: int) -> Floats:
        """Return the share of each sample's pressure in each band, (M, K); the shares of a sample sum to 1.

        K is the smallest number of bands that each have at most `budget` samples, but at most `most`. Regions of more
        than 32 samples are cut across their longest side into K bands with equal numbers of samples. All other samples
        have equal shares in all bands. Silent samples do not count, because bands do not have fewer of them.
        """
        pressing = int((samples.regions != BESIDE).sum())
        if most == 1 or pressing <= SPARE * budget:
            self._count = 1
            return np.ones((len(samples), 1))
        regions, counts = np.unique(samples.regions, return_counts=True)
        large = regions[(regions >= 0) & (counts > MIN_DIVIDED_SAMPLES)]
        divided = np.isin(samples.regions, large)
        many = int(divided.sum())
        few = pressing - many

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
        """Return the world axis along which a region is longest; the previous axis if it is still nearly longest."""
        q = samples.positions[samples.regions == region]
        sides = q.max(axis=0) - q.min(axis=0)
        last = self._axes.get(region)
        if last is not None and sides[last] >= MIN_KEPT_LENGTH * sides.max():
            return last
        return int(sides.argmax())


def _cut(x: Floats, count: int) -> Floats:
    """Return the shares of samples in `count` bands of equal numbers of samples along x, (M,) [m]: (M, count)."""
    M = len(x)
    u = np.empty(M)
    u[np.argsort(x, kind="stable")] = count * (np.arange(M) + 0.5) / M
    edges = np.arange(count + 1.0)
    edges[0], edges[-1] = -math.inf, math.inf
    past = (u[:, None] - edges + OVERLAP_SHARE) / (2.0 * OVERLAP_SHARE)  # (M, count + 1)
    past = np.clip(past, 0.0, 1.0)
    return past[:, :-1] - past[:, 1:]
