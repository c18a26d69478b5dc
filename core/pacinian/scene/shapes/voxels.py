"""Voxel grids as solids."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_length, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.array_data import check_within, decode_array, encode_array
from pacinian.scene.shapes.sdf import sample_solid

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Vector
    from pacinian.scene.shapes.local_samples import LocalSamples
    from pacinian.types import ArrayLike, Floats, Singles

    Values = ArrayLike
else:  # the types that a scene file may hold
    Values = bytes | tuple[tuple[tuple[float, ...], ...], ...]

RIM = 2  # width of the empty margin around the grid [voxels]
EXACT_BAND = 2  # distance from the shell within which distances are exact [voxels]


class DistanceField(NamedTuple):
    """Signed distances at the voxels and their margin [m], and the shell's area [m^2], extent and reach [m]."""

    distances: Singles
    area: float
    extent: Vector
    reach: float


class Voxels(
    Struct,
    frozen=True,
    forbid_unknown_fields=True,
    kw_only=True,
    dict=True,
    tag_field="type",
    tag="voxels",
):
    """A volume given by the filling of each voxel of a grid centred on the origin.

    values: 0..1 on a grid over x, y and z, at most 1e8. file: a .npy file, instead of values; a scene file gives it
    relative to its own folder. pitch: side of a voxel [m]. level: the shell lies where the values, interpolated between
    the centres of voxels, equal this level; outside the grid they are 0. Raises ArgumentError.
    """

    values: Values | None = None
    pitch: float
    level: float = 0.5
    file: str = ""

    def __post_init__(self) -> None:
        force_setattr(self, "pitch", check_length("pitch", self.pitch))
        force_setattr(
            self, "level", check_number("level", self.level, low=0.0, high=1.0, above=True)
        )
        force_setattr(self, "values", encode_array("values", self.values, self.file, 3))
        if not self.file:
            _ = self.filling

    @property
    def area(self) -> float:
        """Surface area [m^2]. For a grid of only 0 and 1, it is that of the stairs with their corners cut."""
        return self._field.area

    @property
    def extent(self) -> Vector:
        """Half the size of the bounding box centred on the origin [m]."""
        return self._field.extent

    @property
    def bounding_radius(self) -> float:
        """Distance from the origin to the farthest point [m]."""
        return self._field.reach

    def distance(self, points: Floats) -> Floats:
        """Return the interpolated signed distance of points, (K, 3), (K,) [m]; negative inside.

        For points outside the grid, the result may exceed the true distance. The first call is slow (0.6 s for 1e6
        voxels) and needs 100 bytes per voxel.
        """
        from scipy.ndimage import map_coordinates

        D = self._field.distances
        last = np.array(D.shape)[:, None] - 1.0
        at = points.T / self.pitch + last / 2.0
        held = np.minimum(np.maximum(at, 0.0), last)
        d = map_coordinates(D, held, np.float64, order=1, mode="nearest")
        x, y, z = self.pitch * (at - held)
        return np.asarray(d + np.sqrt(x * x + y * y + z * z))

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return points of a fine grid, projected on the shell and thinned to about `spacing` [m]."""
        return sample_solid(self, spacing)

    @cached_property
    def _field(self) -> DistanceField:
        """The distance field.

        It is exact near the shell. Farther away, each voxel measures to the shell point of the nearest voxel near it.
        """
        import igl
        from scipy import ndimage

        v = np.pad(self.filling, RIM)
        inside, (X, Y, Z) = v > self.level, v.shape
        axes = np.ogrid[:X, :Y, :Z]
        nodes = np.stack(np.broadcast_arrays(*axes), axis=-1).reshape(-1, 3, order="F")
        made: Any = igl.marching_cubes(v.ravel(order="F"), nodes.astype(float), X, Y, Z, self.level)
        V, F = made[:2]
        wide = 2 * EXACT_BAND + 1
        near = ndimage.maximum_filter(inside, wide) != ndimage.minimum_filter(inside, wide)
        tree: Any = igl.AABB()
        tree.init(V, F)
        foot = tree.squared_distance(V, F, np.argwhere(near).astype(float))[2]
        number = np.zeros(v.shape, dtype=np.int32)
        number[near] = np.arange(len(foot))
        nearest = ndimage.distance_transform_edt(~near, return_distances=False, return_indices=True)
        which = number[tuple(nearest)]
        squared = sum((x - foot[:, axis][which]) ** 2 for axis, x in enumerate(axes))
        D = np.where(inside, -self.pitch, self.pitch) * np.sqrt(squared)
        V = self.pitch * (V - (np.array(v.shape) - 1.0) / 2.0)
        x, y, z = np.abs(V).max(axis=0).tolist()
        area = float(np.asarray(igl.doublearea(V, F)).sum()) / 2.0
        return DistanceField(
            D.astype(np.float32), area, (x, y, z), math.sqrt((V * V).sum(axis=1).max())
        )

    @property
    def filling(self) -> Floats:
        """Filling of each voxel, 0..1, (X, Y, Z). A file is read again. Raises ArgumentError."""
        values = decode_array("values", self.values, self.file, 3)
        check_within("values", values)
        inside = values > self.level
        if not inside.any() or inside.all():
            are = "all" if inside.all() else "none"
            raise ArgumentError("values", f"have no shell: {are} is above the level {self.level:g}")
        check_length("pitch", self.pitch * max(values.shape))
        return values.astype(np.float64)
