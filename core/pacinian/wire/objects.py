"""Objects on the wire: what is to be felt. Their names are the keys of the map that they come in."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Grid, Rows, check_arrays
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
from pacinian.wire.time import STEADY, Envelope, Technique

WAVELENGTH = 0.0085  # [m]
SPOT = math.pi * 0.00425**2  # [m^2], a disc one wavelength across
STILL = 0.0, 0.0, 0.0


class Material(Struct, frozen=True):
    """A bed of springs: pressure in proportion to depth, up to the object's own.

    stiffness: pressure for each metre; unless given, the whole pressure is felt 2 mm deep. reach: how far outside
    of the object it is felt already.
    """

    stiffness: Annotated[float, Meta(gt=0.0, le=1e12, description="[Pa/m]")] | None = None
    reach: Annotated[float, Meta(ge=0.0, le=10.0, description="[m]")] = 0.0


class Motion(Struct, frozen=True):
    """How an object moves after the command's time. velocity: straight on. angular_velocity: about the world's axes."""

    velocity: Velocity = STILL
    angular_velocity: Velocity = STILL


class Texture(Struct, frozen=True, kw_only=True):
    """A factor on pressure over x and y of an object's own frame.

    values: 0..1, (R, C) float32, in rows as in a picture that is looked at from +z. grid: R, C. size: of the whole
    in x and y. repeat: beyond that it is repeated; or else as on its rim.
    """

    values: Values
    grid: tuple[Side, Side]
    size: tuple[Length, Length]
    repeat: bool = True

    BULK = (Grid("values", 0.0, 1.0),)

    def __post_init__(self) -> None:
        check_arrays(self)


class Felt(Struct, frozen=True, kw_only=True, tag_field="type"):
    """What all objects have.

    radiation_pressure: how strong it is; either this or force. force: over the whole of it; either this or
    radiation_pressure. envelope: over time. technique: how its samples are presented in time; the server's unless
    given. material: from depth to pressure. motion: still unless given. priority: higher ones get samples first.
    duration: it is removed after so long; it stays unless given.
    """

    radiation_pressure: Pressure | None = None
    force: Force | None = None
    envelope: Envelope = STEADY
    technique: Technique | None = None
    material: Material = Material()
    motion: Motion | None = None
    priority: Priority = 0
    duration: Duration | None = None


class Point(Felt, frozen=True, kw_only=True, tag="point"):
    """A point that presses: a focus. position: where. area: what it presses on, a disc 8.5 mm across unless given."""

    position: Position
    area: Annotated[float, Meta(ge=1e-12, le=100.0, description="[m^2]")] = SPOT


class Path(Felt, frozen=True, kw_only=True, tag="path"):
    """A line that presses. shape: in its own frame. pose: where that is. width: within half of it the skin must be."""

    shape: Curve
    pose: Pose = Pose()
    width: Length = WAVELENGTH


class Particles(Felt, frozen=True, kw_only=True, tag="particles"):
    """Many points that press, each by itself. positions: in their own frame, (K, 3) float32 [m].

    pose: where that is. radius: how near the skin must be.
    """

    positions: Annotated[bytes, Meta(max_length=12 * MAX_PARTICLES)]
    pose: Pose = Pose()
    radius: Length = WAVELENGTH / 2.0

    BULK = (Rows("positions", 3),)

    def __post_init__(self) -> None:
        check_arrays(self)


class Surface(Felt, frozen=True, kw_only=True, tag="surface"):
    """A surface that presses evenly, or by its texture. shape: in its own frame.

    pose: where that is. texture: a factor on its pressure; 1 unless given. thickness: how far below it a hand still
    feels it.
    """

    shape: Shell
    pose: Pose = Pose()
    texture: Texture | None = None
    thickness: Length = 0.02


class Volume(Felt, frozen=True, kw_only=True, tag="volume"):
    """A volume that presses evenly, or by its texture. shape: in its own frame.

    pose: where that is. texture: a factor on its pressure; 1 unless given. thickness: how far inside a hand still
    feels it. felt: its shell, or its interior too.
    """

    shape: Solid
    pose: Pose = Pose()
    texture: Texture | None = None
    thickness: Length = 0.02
    felt: Literal["shell", "interior"] = "shell"


OBJECTS = Point, Path, Particles, Surface, Volume
Object = Point | Path | Particles | Surface | Volume
