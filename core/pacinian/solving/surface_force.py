"""The force of a field on a surface, along its normals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.solving.propagator import Propagator

if TYPE_CHECKING:
    from pacinian.solving.solution_metrics import SolutionMetrics
    from pacinian.types import Floats

MAX_ELEMENTS_AT_ONCE = 1 << 22  # largest number of elements of B that are computed at once
MIN_FLAT_COSINE = 1.0 - 1e-9  # smallest cosine between the normals of a flat surface


def surface_force(
    solution: SolutionMetrics, points: Floats, normals: Floats, areas: Floats
) -> float:
    """Return the force [N] on places of a surface: points, (K, 3) [m], outward normals, (K, 3), areas, (K,) [m^2].

    If all normals are equal, the surface is a flat sheet: its normals are turned to the side of the array. Computed in
    single precision. Raises ArgumentError, PointOnTransducer.
    """
    array = solution.array
    if len(points) and (normals @ normals[0]).min() > MIN_FLAT_COSINE:
        aside = float((array.centre - points.mean(axis=0)) @ normals[0])
        normals = -normals if aside < 0.0 else normals
    facing, propagator = SkinFacing(normals), Propagator(array, solution.medium)
    gains = solution.gains.astype(np.complex64)
    rows, force = max(1, MAX_ELEMENTS_AT_ONCE // len(array)), 0.0
    for first in range(0, len(points), rows):
        part = slice(first, first + rows)
        propagator.set_points(points[part], facing.only(part))
        pressure = radiation_pressure(propagator.apply(gains), solution.medium)
        force += float(pressure @ areas[part])
    return force
