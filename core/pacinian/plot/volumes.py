"""The field in a box, on a grid, and its isosurfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.argument_checks import check_length, check_near, check_numbers
from pacinian.errors import ArgumentError
from pacinian.plot.planes import HALF_WIDTH, MARGIN, middle_of
from pacinian.plot.quantities import compute_field

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Floats, Longs

POINTS_PER_WAVELENGTH = 4.0  # grid points per wavelength
# maximum number of grid points: by default; at all
DEFAULT_MAX_POINTS, MAX_POINTS = 1_000_000, 10_000_000

Box = tuple["ArrayLike", "ArrayLike"]


@dataclass(frozen=True, eq=False)
class Volume:
    """Sound pressure on a grid: p complex [Pa], (z, y, x); its lower corner (3,) and its step [m]; the air."""

    p: Complexes
    corner: Floats
    step: float
    medium: Air

    def radiation(self) -> Floats:
        """Return the radiation pressure on skin [Pa], (z, y, x)."""
        return radiation_pressure(self.p, self.medium)


def volume(
    array: Array,
    gains: ArrayLike,
    points: Floats,
    medium: Air,
    box: Box | None,
    spacing: float | None,
) -> Volume:
    """Compute the field in a box of given corners [m]; default: around the points, (M, 3) [m].

    spacing: of the grid [m]; default: a quarter of a wavelength, or coarser to stay within a million points.
    Raises ArgumentError.
    """
    low, high = around(array, points) if box is None else _corners(box)
    check_near("box", np.stack([low, high]), array.centre)
    size = high - low
    if spacing is None:
        wavelength = medium.wavelength(array.transducer.frequency)
        step = max(
            wavelength / POINTS_PER_WAVELENGTH, float(np.cbrt(size.prod() / DEFAULT_MAX_POINTS))
        )
    else:
        step = check_length("spacing", spacing)
    counts = np.maximum(np.round(size / step), 1.0) + 1.0
    if counts.prod() > MAX_POINTS:
        raise ArgumentError(
            "spacing", f"of {step:g} m makes {counts.prod():.3g} points: choose a larger one"
        )
    x, y, z = (low[k] + step * np.arange(int(counts[k])) for k in range(3))
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    return Volume(
        compute_field(array, gains, np.stack([X, Y, Z], axis=-1), medium), low, step, medium
    )


def around(array: Array, points: Floats) -> tuple[Floats, Floats]:
    """Return the corners [m] of the box around points (M, 3) [m], or in front of the array if there are none."""
    if len(points):
        return points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    middle = middle_of(array, points)
    return middle - HALF_WIDTH, middle + HALF_WIDTH


def isosurface(
    values: Floats, corner: Floats, step: float | Floats, level: float
) -> tuple[Floats, Longs]:
    """Return the isosurface of grid values (z, y, x) at `level`: vertices (V, 3) [m], outward faces (F, 3)."""
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
