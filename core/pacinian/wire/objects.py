"""Haptic objects on the wire. The keys of the map that holds them are their names."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Grid, Rows, check_arrays
from pacinian.wire.modulation import STEADY, Envelope, Technique
from pacinian.wire.protocol import (
    MAX_PARTICLES,
    Duration,
    Force,
    Length,
    Position,
    Pressure,
    Priority,
    Side,
    Velocity,
)
from pacinian.wire.shapes import Curve, Pose, Shell, Solid, Values

DEFAULT_WIDTH = 0.0085  # [m]
SPOT = math.pi * 0.00425**2  # area of a disc one wavelength across [m^2]
STILL = 0.0, 0.0, 0.0


class Material(Struct, frozen=True):
    """A bed of springs: the pressure grows in proportion to depth, up to the pressure of the object.

    stiffness: pressure per depth; by default the full pressure is reached at a depth of 2 mm. reach: distance outside
    of the object at which it begins to press.
    """

    stiffness: Annotated[float, Meta(gt=0.0, le=1e12, description="[Pa/m]")] | None = None
    reach: Annotated[float, Meta(ge=0.0, le=10.0, description="[m]")] = 0.0


class Motion(Struct, frozen=True):
    """Motion of an object from the command's time on.

    velocity: linear velocity. angular_velocity: angular velocity about the world's axes.
    """

    velocity: Velocity = STILL
    angular_velocity: Velocity = STILL


class Texture(Struct, frozen=True, kw_only=True):
    """A factor on the pressure, over x and y of the object's own frame.

    values: factors 0..1, (R, C) float32, in rows like those of a picture seen from +z. grid: R, C. size: extent of the
    texture in x and y. repeat: whether the texture repeats beyond its extent; otherwise its edge values continue.
    """

    values: Values
    grid: tuple[Side, Side]
    size: tuple[Length, Length]
    repeat: bool = True

    BULK = (Grid("values", 0.0, 1.0),)

    def __post_init__(self) -> None:
        check_arrays(self)


class HapticObject(Struct, frozen=True, kw_only=True, tag_field="type"):
    """Fields of all objects.

    radiation_pressure: radiation pressure of the object; give either this or `force`. force: total force of the object;
    give either this or `radiation_pressure`. envelope: strength over time. technique: presentation of the samples in
    time; by default the server's. material: relation of depth and pressure. motion: motion of the object; by default
    it is at rest. priority: objects of higher priority get samples first. duration: time until the server removes the
    object; by default it stays.
    """

    radiation_pressure: Pressure | None = None
    force: Force | None = None
    envelope: Envelope = STEADY
    technique: Technique | None = None
    material: Material = Material()
    motion: Motion | None = None
    priority: Priority = 0
    duration: Duration | None = None


class Point(HapticObject, frozen=True, kw_only=True, tag="point"):
    """A single focus. position: position of the focus. area: area on which it presses; by default a disc of 8.5 mm."""

    position: Position
    area: Annotated[float, Meta(ge=1e-12, le=100.0, description="[m^2]")] = SPOT


class Path(HapticObject, frozen=True, kw_only=True, tag="path"):
    """A curve that presses on the skin along it.

    shape: curve in its own frame. pose: pose of that frame. width: width of the curve; it presses on skin within half
    of this distance.
    """

    shape: Curve
    pose: Pose = Pose()
    width: Length = DEFAULT_WIDTH


class Particles(HapticObject, frozen=True, kw_only=True, tag="particles"):
    """Many points, each of which presses by itself. positions: points in their own frame, (K, 3) float32 [m].

    pose: pose of that frame. radius: distance within which a point presses on the skin.
    """

    positions: Annotated[bytes, Meta(max_length=12 * MAX_PARTICLES)]
    pose: Pose = Pose()
    radius: Length = DEFAULT_WIDTH / 2.0

    BULK = (Rows("positions", 3),)

    def __post_init__(self) -> None:
        check_arrays(self)


class Surface(HapticObject, frozen=True, kw_only=True, tag="surface"):
    """A surface that presses evenly, or according to its texture. shape: surface in its own frame.

    pose: pose of that frame. texture: factor on the pressure; by default 1. thickness: depth below the surface down to
    which a hand feels it.
    """

    shape: Shell
    pose: Pose = Pose()
    texture: Texture | None = None
    thickness: Length = 0.02


class Volume(HapticObject, frozen=True, kw_only=True, tag="volume"):
    """A volume that presses evenly, or according to its texture. shape: solid in its own frame.

    pose: pose of that frame. texture: factor on the pressure; by default 1. thickness: depth inside the volume down to
    which a hand feels it. felt: whether only the shell can be felt, or also the interior.
    """

    shape: Solid
    pose: Pose = Pose()
    texture: Texture | None = None
    thickness: Length = 0.02
    felt: Literal["shell", "interior"] = "shell"


OBJECTS = Point, Path, Particles, Surface, Volume
Object = Point | Path | Particles | Surface | Volume
