"""Shapes given by a signed-distance function, and samples on the shell and inside of any solid."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Vector, vector
from pacinian.argument_checks import check_length, check_real
from pacinian.errors import ArgumentError
from pacinian.neighbours import find_nearest
from pacinian.scene.shapes.local_samples import LocalSamples, sample_grid
from pacinian.scene.shapes.poisson_disk import MIN_DISTANCE, thin_out
from pacinian.types import Floats

if TYPE_CHECKING:
    from pacinian.types import Indices

STEPS = 5  # number of Newton steps that project a point on the shell
MAX_SHELL_DISTANCE = 0.01  # largest distance of a projected point from the shell, over the spacing
SHELL_GAP = 0.6  # smallest distance of interior samples from those of the surface, over the spacing
CELLS = 50_000  # approximate number of cells in a solid's bounding box for measuring its area


class Solid(Protocol):
    """The interface of a volume's shape."""

    @property
    def area(self) -> float:
        """Surface area [m^2]."""
        ...

    @property
    def extent(self) -> Vector:
        """Half the size of a bounding box centred on the origin [m]."""
        ...

    @property
    def bounding_radius(self) -> float:
        """Upper bound of the distance from the origin to the farthest point [m]."""
        ...

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; negative inside."""
        ...

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return samples of the shell, about `spacing` [m] apart."""
        ...


class SDF(Struct, frozen=True, eq=False, dict=True):
    """A volume given by a signed-distance function.

    function: maps points, (K, 3) [m], to distances, (K,) [m], negative inside. It gets a copy, which it may change.
    Several threads may call it, one at a time. extent: half the size of a bounding box centred on the origin [m].
    Raises ArgumentError.
    """

    function: Callable[[Floats], Floats]
    extent: Vector

    def __post_init__(self) -> None:
        force_setattr(self, "extent", vector("extent", self.extent))
        for half in self.extent:
            check_length("extent", half)

    @property
    def _alone(self) -> threading.RLock:
        """Held while the function runs, because a loop samples and measures in different threads."""
        own = cast("dict[str, threading.RLock]", self.__dict__)
        return own.setdefault("_lock", threading.RLock())  # in one step

    @property
    def area(self) -> float:
        """Surface area [m^2], estimated on a grid."""
        return self._area

    @cached_property
    def _area(self) -> float:
        return measure_solid(self)

    @property
    def bounding_radius(self) -> float:
        """Upper bound of the distance from the origin to the farthest point [m]."""
        return math.hypot(*self.extent)

    def distance(self, points: Floats) -> Floats:
        """Return the signed distance of points, (K, 3), (K,) [m]; negative inside. Raises ArgumentError."""
        with self._alone:
            d = check_real("function", self.function(points.copy()))
        if d.shape != (len(points),) or not np.isfinite(d).all():
            raise ArgumentError(
                "function",
                f"must give one finite distance a point, shape ({len(points)},), not shape {d.shape}, "
                f"{np.isfinite(d).sum()} of {d.size} finite",
            )
        return d

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points of a fine grid, projected on the shell and thinned to about `spacing` [m]."""
        return sample_solid(self, spacing)


def sample_solid(solid: Solid, spacing: float) -> LocalSamples:
    """Return points of a fine grid, projected on the shell by Newton steps and thinned to about `spacing` [m]."""
    extent = np.array(solid.extent)
    points, area = _sample_shell(solid, spacing / 3.0, -extent, extent)
    for _ in range(STEPS):
        d, slope = solid.distance(points)[:, None], gradient(solid, points)
        points = points - d * slope / np.maximum((slope**2).sum(axis=1, keepdims=True), 0.25)
    held = (np.abs(points) <= extent + MAX_SHELL_DISTANCE * spacing).all(axis=1)
    on = held & (np.abs(solid.distance(points)) < MAX_SHELL_DISTANCE * spacing)
    points, area = points[on], area[on]
    kept = thin_out(points, MIN_DISTANCE * spacing)
    area = share_area(points, area, kept)
    return LocalSamples(
        points[kept], normalise(gradient(solid, points[kept])), scale_shell(area, solid.area)
    )


def measure_solid(solid: Solid) -> float:
    """Estimate the area of a shell [m^2] from the cells of a grid that it passes through."""
    low, high = -np.array(solid.extent), np.array(solid.extent)
    area = np.zeros(0)
    for _ in range(2):  # first in the solid's whole box, then in the part that holds the shell
        step = math.cbrt(float((high - low).prod()) / CELLS)
        points, area = _sample_shell(solid, step, low, high)
        if not len(points):
            break
        low, high = points.min(axis=0), points.max(axis=0)
    return float(area.sum())


def _sample_shell(solid: Solid, step: float, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Return the points of a grid near a shell, (K, 3) [m], and the shell's area in the cell around each, (K,) [m^2].

    Engquist, Tornberg and Tsai, "Discretization of Dirac delta functions in level set methods", 2005.
    """
    x, y, z = (high - low) / 2.0 + 2.0 * step
    points = sample_grid((x, y, z), step) + (low + high) / 2.0
    cell = 8.0 * x * y * z / len(points)  # [m^3]
    d = np.abs(solid.distance(points))
    near = d < math.sqrt(3.0) * math.cbrt(cell)
    points, slope = points[near], gradient(solid, points[near])
    width = np.maximum(math.cbrt(cell) * np.abs(slope).sum(axis=1), 1e-30)
    delta = np.maximum(1.0 - d[near] / width, 0.0) / width
    return points, cell * delta * np.sqrt((slope**2).sum(axis=1))


def sample_interior(solid: Solid, spacing: float) -> LocalSamples:
    """Return samples of a volume about `spacing` [m] apart: those of its surface, and a centred grid inside.

    Without samples on the surface, the pressure would fall before it. The grid keeps `SHELL_GAP` spacings away from it.
    The normals follow the gradient of the distance, outwards. A sample of the grid has the area spacing^2, and one of
    the surface, which stands for half a cell, half of this.
    """
    grid = sample_grid(solid.extent, spacing)
    inner = grid[solid.distance(grid) < -SHELL_GAP * spacing]
    shell = solid.sample_surface(spacing)
    cell = spacing**2
    return LocalSamples(
        np.concatenate([shell.points, inner]),
        np.concatenate([shell.normals, normalise(gradient(solid, inner))]),
        np.concatenate([np.full(len(shell.points), 0.5 * cell), np.full(len(inner), cell)]),
    )


def gradient(solid: Solid, points: Floats, step: float = 1e-5) -> Floats:
    """Return the gradient of the distance at points, (K, 3), by central differences over `step` [m]."""
    slopes = [solid.distance(points + e) - solid.distance(points - e) for e in step * np.eye(3)]
    return np.stack(slopes, axis=-1) / (2.0 * step)


def normalise(directions: Floats) -> Floats:
    """Scale directions, (K, 3), to unit length. Zero vectors stay zero."""
    size = np.sqrt((directions**2).sum(axis=1, keepdims=True))
    return directions / np.where(size > 0.0, size, 1.0)


def share_area(points: Floats, area: Floats, kept: Indices) -> Floats:
    """Return the area of each kept point, to which the other points add theirs if it is the nearest kept one."""
    if not len(kept):
        return np.empty(0)
    nearest = find_nearest(points[kept], points)[1]
    return np.bincount(nearest, area, len(kept)).astype(np.float64)


def scale_shell(area: Floats, total: float) -> Floats:
    """Scale areas to sum to `total` [m^2]. If all are zero, they become equal."""
    area = area if area.any() else np.ones_like(area)
    return area * (total / max(float(area.sum()), 1e-300))
