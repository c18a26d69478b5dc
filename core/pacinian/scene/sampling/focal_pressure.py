"""Pressure of points and particles that are given a force: the force divided by the area of the array's focus."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.sampling.sample_counts import PRESSURE_LIMITED
from pacinian.scene.sampling.sample_sources import is_sequential

if TYPE_CHECKING:
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.sampling.samples import Samples


def spread_forces(
    samples: Samples, resolving: ArrayResolution, max_uniform_points: float, peak: float, counts: SampleCounts
) -> Samples:  # fmt: skip
    """Spread the forces of focal objects over the area that the focus has at each sample.

    Where no focus is possible, a sample keeps the area of the object's own disc. max_uniform_points: the focus is that
    of a uniform drive if at most this many samples sound at once, see `focal_area`. peak: largest pressure [Pa]; counts
    gets the number of samples that would exceed it.
    """
    if not any(samples.items[i].focal for i in set(samples.objects.tolist())):
        return samples
    items = [samples.items[i] for i in samples.objects.tolist()]
    focal = np.flatnonzero([item.focal for item in items])
    alone = np.array([is_sequential(items[i]) for i in focal])
    together = len(items) - sum(map(is_sequential, items))
    P, most, area = samples.radiation_pressure.copy(), samples.most.copy(), samples.area.copy()
    for uniform in (True, False):
        rows = focal[(np.where(alone, 1, together) <= max_uniform_points) == uniform]
        if not len(rows):
            continue
        found = resolving.focal_areas(
            samples.positions[rows], samples.normals[rows], uniform=uniform
        )
        found = np.where(np.isnan(found), area[rows], found)
        P[rows] *= area[rows] / found
        most[rows] *= area[rows] / found
        area[rows] = found
    counts.note_rows(PRESSURE_LIMITED, samples, focal[P[focal] > peak])
    P[focal], most[focal] = np.minimum(P[focal], peak), np.minimum(most[focal], peak)
    return samples.changed(radiation_pressure=P, most=most, area=area)
