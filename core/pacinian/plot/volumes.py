"""The field in a box: on a grid, and the surface where it has one value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.checks import check_length, check_near, check_numbers
from pacinian.errors import ArgumentError
from pacinian.plot.planes import ALONE, MARGIN, middle_of
from pacinian.plot.quantities import heard

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Floats, Longs

FINE = 4.0  # points in a wavelength
USUAL, MOST = 1_000_000, 10_000_000  # points of a grid: as many as are fine enough; at most

Box = tuple["ArrayLike", "ArrayLike"]


@dataclass(frozen=True, eq=False)
class Volume:
    """Sound pressure on a grid: p complex [Pa], (z, y, x); its lower corner (3,) and its step [m]."""

    p: Complexes
    corner: Floats
    step: float

    def radiation(self, medium: Air) -> Floats:
        """Radiation pressure on skin [Pa], (z, y, x)."""
        return radiation_pressure(self.p, medium)


def volume(
    array: Array,
    gains: ArrayLike,
    points: Floats,
    medium: Air,
    box: Box | None,
    spacing: float | None,
) -> Volume:
    """The field in a box: its lower and upper corner [m]; around the points, (M, 3) [m], unless given.

    spacing: of the grid [m]; a quarter of a wavelength unless given, or what a million points allow.
    Raises ArgumentError.
    """
    low, high = around(array, points) if box is None else _corners(box)
    check_near("box", np.stack([low, high]), array.centre)
    size = high - low
    if spacing is None:
        wavelength = medium.wavelength(array.transducer.frequency)
        step = max(wavelength / FINE, float(np.cbrt(size.prod() / USUAL)))
    else:
        step = check_length("spacing", spacing)
    counts = np.maximum(np.round(size / step), 1.0) + 1.0
    if counts.prod() > MOST:
        raise ArgumentError(
            "spacing", f"of {step:g} m makes {counts.prod():.3g} points: choose a larger one"
        )
    x, y, z = (low[k] + step * np.arange(int(counts[k])) for k in range(3))
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    return Volume(heard(array, gains, np.stack([X, Y, Z], axis=-1), medium), low, step)


def around(array: Array, points: Floats) -> tuple[Floats, Floats]:
    """The box about points (M, 3) [m], or before the array where there are none: its corners [m]."""
    if len(points):
        return points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    middle = middle_of(array, points)
    return middle - ALONE, middle + ALONE


def isosurface(
    values: Floats, corner: Floats, step: float | Floats, level: float
) -> tuple[Floats, Longs]:
    """Where values (z, y, x) on a grid are `level`, as triangles: vertices (V, 3) [m], faces (F, 3), outward."""
    from igl import marching_cubes

    known = np.nan_to_num(values, nan=level)
    Z, Y, X = np.meshgrid(*(np.arange(n, dtype=np.float64) for n in values.shape), indexing="ij")
    grid = np.stack([X, Y, Z], axis=-1).reshape(-1, 3)
    d, h, w = values.shape
    made: Any = marching_cubes(level - known.astype(np.float64).ravel(), grid, w, h, d, 0.0)
    vertices, faces = np.asarray(made[0], np.float64), np.asarray(made[1], np.int64)
    return np.asarray(corner + step * vertices.reshape(-1, 3)), faces.reshape(-1, 3)


def _corners(box: Box) -> tuple[Floats, Floats]:
    try:
        lower, upper = box
    except (TypeError, ValueError):
        raise ArgumentError("box", "must be two corners [m]") from None
    low, high = check_numbers("box[0]", lower, (3,)), check_numbers("box[1]", upper, (3,))
    if not (low < high).all():
        raise ArgumentError(
            "box", "must have each number of its first corner below that of its second"
        )
    return low, high
