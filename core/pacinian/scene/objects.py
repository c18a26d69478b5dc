"""What is to be felt: points, surfaces and volumes, and the scene that holds them. All immutable."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import Pose, Vector, vector
from pacinian.checks import kind, number
from pacinian.errors import ArgumentError
from pacinian.scene.envelope import STEADY, Envelope
from pacinian.scene.shapes import Box, Capsule, Disc, Local, Rectangle, Sphere
from pacinian.scene.solids import SDF, Mesh, interior

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats

Shell = Rectangle | Disc | Sphere | Mesh
if TYPE_CHECKING:
    SolidShape = Box | Sphere | Capsule | SDF
else:  # what a scene file may hold
    SolidShape = Box | Sphere | Capsule

SMALLEST = 1e-12  # [m^2]
SPOT = math.pi * 0.00425**2  # [m^2], a disc one wavelength across: a focus is about that wide


class Point(
    Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="type", tag="point"
):
    """A point that presses.

    position: [m]. radiation_pressure: [Pa], or force: [N] over `area` [m^2] (a disc one wavelength
    across unless given). envelope: over time. name: for messages. Raises ArgumentError.
    """

    position: Vector
    radiation_pressure: float | None = None
    force: float | None = None
    area: float = SPOT
    envelope: Envelope = STEADY
    name: str = ""

    def __post_init__(self) -> None:
        force_setattr(self, "position", vector("position", self.position))
        force_setattr(self, "area", number("area", self.area, low=SMALLEST))
        _check(self)

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope [Pa]."""
        return _pressure(self.radiation_pressure, self.force, self.area)


class Surface(
    Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="type", tag="surface"
):
    """A surface that presses evenly.

    shape: in its own frame. pose: where it is. radiation_pressure: [Pa], or force: [N] over the whole
    of it. envelope: over time. name: for messages. Raises ArgumentError.
    """

    shape: Shell
    pose: Pose = Pose()
    radiation_pressure: float | None = None
    force: float | None = None
    envelope: Envelope = STEADY
    name: str = ""

    def __post_init__(self) -> None:
        kind("shape", self.shape, Rectangle, Disc, Sphere, Mesh)
        kind("pose", self.pose, Pose)
        _check(self)

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope [Pa]."""
        return _pressure(self.radiation_pressure, self.force, self.shape.area)

    def cover(self, spacing: float) -> Local:
        """Samples in its own frame, about `spacing` [m] apart."""
        return self.shape.cover(spacing)


class Volume(
    Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="type", tag="volume"
):
    """A volume that presses evenly.

    felt: its "shell", or its "interior" too, so that a hand inside of it feels it everywhere. shape: in
    its own frame. pose: where it is. radiation_pressure: [Pa], or force: [N] over the whole shell.
    envelope: over time. name: for messages. Raises ArgumentError.
    """

    shape: SolidShape
    felt: Literal["shell", "interior"] = "shell"
    pose: Pose = Pose()
    radiation_pressure: float | None = None
    force: float | None = None
    envelope: Envelope = STEADY
    name: str = ""

    def __post_init__(self) -> None:
        kind("shape", self.shape, Box, Sphere, Capsule, SDF)
        kind("pose", self.pose, Pose)
        if self.felt not in ("shell", "interior"):
            raise ArgumentError("felt", f'must be "shell" or "interior", not {self.felt!r}')
        if self.force is not None and (self.felt == "interior" or isinstance(self.shape, SDF)):
            raise ArgumentError("force", "needs a shell of known area: give radiation_pressure")
        _check(self)

    @property
    def pressure(self) -> float:
        """Radiation pressure at full envelope [Pa]."""
        area = 1.0 if isinstance(self.shape, SDF) else self.shape.area
        return _pressure(self.radiation_pressure, self.force, area)

    def cover(self, spacing: float) -> Local:
        """Samples in its own frame, about `spacing` [m] apart."""
        return self.shape.cover(spacing) if self.felt == "shell" else interior(self.shape, spacing)


Object = Point | Surface | Volume


class Workspace(Struct, frozen=True, forbid_unknown_fields=True):
    """The box where anything may be felt. lower, upper: its corners [m]. Raises ArgumentError."""

    lower: Vector
    upper: Vector

    def __post_init__(self) -> None:
        force_setattr(self, "lower", vector("lower", self.lower))
        force_setattr(self, "upper", vector("upper", self.upper))
        if any(low >= high for low, high in zip(self.lower, self.upper, strict=True)):
            raise ArgumentError("workspace", "must have each of `lower` below that of `upper`")

    def holds(self, points: Floats) -> Flags:
        """Which of the points, (M, 3) [m], are inside, (M,)."""
        return np.asarray(((points >= self.lower) & (points <= self.upper)).all(axis=1))


class Scene(Struct, frozen=True, eq=False, forbid_unknown_fields=True):
    """An immutable snapshot of what is to be felt. A change is a new scene that shares what stayed.

    objects: in order of importance. workspace: where; everywhere unless given.
    """

    objects: tuple[Object, ...] = ()
    workspace: Workspace | None = None

    def __post_init__(self) -> None:
        try:
            force_setattr(self, "objects", tuple(self.objects))
        except TypeError:
            raise ArgumentError("objects", f"must be a list, not {self.objects!r}") from None
        if self.workspace is not None:
            kind("workspace", self.workspace, Workspace)
        for i, item in enumerate(self.objects):
            kind(f"objects[{i}]", item, Point, Surface, Volume)


def _check(item: Point | Surface | Volume) -> None:
    if (item.radiation_pressure is None) == (item.force is None):
        raise ArgumentError("radiation_pressure", "or `force` must be given, and not both")
    for name in ("radiation_pressure", "force"):
        if (value := getattr(item, name)) is not None:
            force_setattr(item, name, number(name, value, low=0.0))
    if not callable(getattr(item.envelope, "at", None)):
        raise ArgumentError("envelope", f"must be an envelope, not {item.envelope!r}")


def _pressure(radiation_pressure: float | None, force: float | None, area: float) -> float:
    """[Pa]."""
    if radiation_pressure is not None:
        return radiation_pressure
    return (force or 0.0) / max(area, SMALLEST)
