"""Haptic objects: points, paths, particles, surfaces and volumes. All are immutable."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Pose, Vector, vector
from pacinian.argument_checks import (
    check_kind,
    check_length,
    check_near,
    check_number,
    check_numbers,
)
from pacinian.errors import ArgumentError
from pacinian.scene.haptic_object import MIN_AREA, HapticObject
from pacinian.scene.shapes import LocalSamples
from pacinian.scene.shapes.curves import Circle, Curve, Line, Lissajous, Polyline
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.sdf import sample_interior
from pacinian.scene.shapes.shape_types import (
    SHELLS,
    SOLIDS,
    Shell,
    SolidShape,
    check_closed,
    distance,
)
from pacinian.scene.shapes.texture import Texture

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.types import Floats

SPOT = math.pi * 0.00425**2  # default area of a point [m^2]: a disc one wavelength across
DEFAULT_WIDTH = 0.0085  # default width of paths and diameter of particles [m]
THICKNESS = 0.02  # default depth down to which a surface is felt [m]
MAX_PARTICLES = 100_000  # largest number of particles in one object
ORIGIN = np.zeros(3)


class Point(HapticObject, frozen=True, kw_only=True, tag_field="type", tag="point"):
    """A point that presses: a focus.

    position: [m]. force: [N] over the main lobe of the focus, whose area depends on the array (`pacinian.focal_area`).
    area: of a disc [m^2]; by default it is one wavelength across. A hand feels the point where the skin is within that
    disc's radius of the point, and where the point is inside the hand. For the other parameters, see `HapticObject`.
    Raises ArgumentError.
    """

    position: Vector
    area: float = SPOT

    def __post_init__(self) -> None:
        force_setattr(self, "position", vector("position", self.position))
        force_setattr(self, "area", check_number("area", self.area, low=MIN_AREA))
        self._check()

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope [Pa]. For a force, the value before an array is known."""
        return self._pressure(self.area)

    @property
    def focal(self) -> bool:
        """Whether the point is given a force."""
        return self.force is not None

    @property
    def radius(self) -> float:
        """Radius of the disc that the point presses on [m]."""
        return math.sqrt(self.area / math.pi)

    @property
    def pose(self) -> Pose:
        """The pose at the point's position, without a rotation."""
        return Pose(self.position)

    @property
    def bounding_radius(self) -> float:
        """Distance from the object's origin to its farthest point [m]."""
        return self.radius

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return the point itself as the only sample."""
        return LocalSamples(np.zeros((1, 3)), np.zeros((1, 3)), np.array([self.area]))


class Path(HapticObject, frozen=True, kw_only=True, tag_field="type", tag="path"):
    """A line that presses: a segment, a polyline, a circle or a Lissajous figure.

    shape: the curve, in the object's own frame. pose: of that frame. width: of the line; it is felt where the skin is
    within half of this [m]. force: [N] over length times width. For the other parameters, see `HapticObject`. Raises
    ArgumentError.
    """

    shape: Curve
    pose: Pose = Pose()
    width: float = DEFAULT_WIDTH

    def __post_init__(self) -> None:
        check_kind("shape", self.shape, Line, Circle, Lissajous, Polyline)
        check_kind("pose", self.pose, Pose)
        force_setattr(self, "width", check_length("width", self.width))
        self._check()

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope [Pa]."""
        return self._pressure(self.shape.length * self.width)

    @property
    def radius(self) -> float:
        """Largest distance from the skin at which the path is felt: half the width [m]."""
        return self.width / 2.0

    @property
    def bounding_radius(self) -> float:
        """Distance from the object's origin to its farthest point [m]."""
        return self.shape.bounding_radius + self.radius

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return samples about `spacing` [m] apart, in the object's own frame."""
        made = self.shape.sample_surface(spacing)
        area = self.shape.length * self.width / max(1, len(made.points))
        return LocalSamples(made.points, made.normals, np.full(len(made.points), area))


class Particles(
    HapticObject, frozen=True, kw_only=True, dict=True, tag_field="type", tag="particles"
):
    """Many points, each of which presses by itself: rain, sparks, smoke.

    positions: in the object's own frame, (K, 3) [m]. pose: of that frame. radius: largest distance from the skin at
    which a particle is felt [m]. radiation_pressure [Pa] or force [N]: of each particle, as of a `Point`. For the
    other parameters, see `HapticObject`. Raises ArgumentError.
    """

    positions: tuple[Vector, ...]
    pose: Pose = Pose()
    radius: float = DEFAULT_WIDTH / 2.0

    def __post_init__(self) -> None:
        places = check_numbers("positions", self.positions, (None, 3))
        if len(places) > MAX_PARTICLES:
            raise ArgumentError(
                "positions", f"must be at most {MAX_PARTICLES} particles, not {len(places)}"
            )
        check_near("positions", places, ORIGIN)
        force_setattr(self, "positions", tuple(map(tuple, places.tolist())))
        check_kind("pose", self.pose, Pose)
        force_setattr(self, "radius", check_length("radius", self.radius))
        self._check()

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope [Pa]. For a force, the value before an array is known."""
        return self._pressure(math.pi * self.radius**2)

    @property
    def focal(self) -> bool:
        """Whether each particle is given a force."""
        return self.force is not None

    @cached_property
    def bounding_radius(self) -> float:
        """Distance from the object's origin to its farthest point [m]."""
        places = np.array(self.positions).reshape(-1, 3)
        return self.radius + float(np.sqrt((places * places).sum(axis=1)).max(initial=0.0))

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return each particle as a sample."""
        places = np.array(self.positions).reshape(-1, 3)
        area = np.full(len(places), math.pi * self.radius**2)
        return LocalSamples(places, np.zeros_like(places), area)


class Body(HapticObject, frozen=True, kw_only=True):
    """The base of surfaces and volumes: a shape at a pose, with a texture.

    texture: a factor on the pressure, over the shape's own x and y. thickness: depth below the surface down to which
    a hand still feels the object [m].
    """

    pose: Pose = Pose()
    texture: Texture | None = None
    thickness: float = THICKNESS

    def load(self) -> Iterator[str]:
        """Read the object's files, as `HapticObject.load`."""
        yield "texture"
        if self.texture is not None:
            _ = self.texture.factors
        yield from super().load()

    def _check(self) -> None:
        super()._check()
        check_kind("pose", self.pose, Pose)
        if self.texture is not None:
            check_kind("texture", self.texture, Texture)
        force_setattr(self, "thickness", check_length("thickness", self.thickness))


class Surface(Body, frozen=True, kw_only=True, tag_field="type", tag="surface"):
    """A surface that presses evenly, or with a texture.

    shape: in the object's own frame. For the other parameters, see `Body` and `HapticObject`. Raises ArgumentError.
    """

    shape: Shell

    def __post_init__(self) -> None:
        check_kind("shape", self.shape, *SHELLS)
        if isinstance(self.shape, Mesh) and not self.shape.file:
            _ = self.shape.area  # raises if the mesh has no area
        self._check()

    def load(self) -> Iterator[str]:
        """Read the object's files, as `HapticObject.load`."""
        yield "shape"
        _ = self.shape.area
        yield from super().load()

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope, where the texture is 1 [Pa]."""
        return self._pressure(self.shape.area if self.force is not None else 1.0)

    @property
    def bounding_radius(self) -> float:
        """Distance from the object's origin to its farthest point [m]."""
        return self.shape.bounding_radius

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return samples about `spacing` [m] apart, in the object's own frame."""
        return self.shape.sample_surface(spacing)

    def distance(self, points: Floats, beyond: float, deep: float) -> Floats:
        """Return the signed distance of points (K, 3) in the object's own frame, negative where it is felt: (K,) [m].

        beyond: distances farther outside than this need not be exact [m]. deep: unused here, because a surface is felt
        only down to its thickness.
        """
        d = distance(self.shape, points, beyond, self.thickness + beyond)
        return np.asarray(np.maximum(d, -d - self.thickness))


class Volume(Body, frozen=True, kw_only=True, tag_field="type", tag="volume"):
    """A volume that presses evenly, or with a texture.

    shape: in the object's own frame. felt: "shell", or "interior" if a hand inside the volume feels it everywhere. For
    the other parameters, see `Body` and `HapticObject`. Raises ArgumentError.
    """

    shape: SolidShape
    felt: Literal["shell", "interior"] = "shell"

    def __post_init__(self) -> None:
        check_kind("shape", self.shape, *SOLIDS)
        if self.felt not in ("shell", "interior"):
            raise ArgumentError("felt", f'must be "shell" or "interior", not {self.felt!r}')
        if self.force is not None and self.felt == "interior":
            raise ArgumentError("force", "needs a shell: give radiation_pressure for an interior")
        if isinstance(self.shape, Mesh) and not self.shape.file:
            self.shape.check_closed()
        self._check()

    def load(self) -> Iterator[str]:
        """Read the object's files, as `HapticObject.load`."""
        yield "shape"
        check_closed(self.shape)
        _ = self.shape.area
        yield from super().load()

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope, where the texture is 1 [Pa]."""
        return self._pressure(self.shape.area if self.force is not None else 1.0)

    @property
    def bounding_radius(self) -> float:
        """Distance from the object's origin to its farthest point [m]."""
        return self.shape.bounding_radius

    def sample_surface(self, spacing: float) -> LocalSamples:
        """Return samples about `spacing` [m] apart, in the object's own frame."""
        return (
            self.shape.sample_surface(spacing)
            if self.felt == "shell"
            else sample_interior(self.shape, spacing)
        )

    def distance(self, points: Floats, beyond: float, deep: float) -> Floats:
        """Return the signed distance of points (K, 3), negative where the volume is felt: (K,) [m].

        beyond, deep: distances farther outside or inside than these need not be exact [m]. A shell ignores `deep`.
        """
        if self.felt == "interior":
            return distance(self.shape, points, beyond, deep)
        d = distance(self.shape, points, beyond, self.thickness + beyond)
        return np.asarray(np.maximum(d, -d - self.thickness))


Object = Point | Path | Particles | Surface | Volume
