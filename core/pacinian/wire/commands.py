"""Commands: what a client sends to the command socket.

Each has its session's key, a sequence number that counts up, the client's time, and how long it may live: one
that would be applied later than `ttl` after `time` is dropped and counted. Of several for one object, the newest
wins. With an `id` it is answered, by `ok` or `error`; without, only errors are told, and not all of them.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Rows, check_arrays
from pacinian.wire.objects import Object
from pacinian.wire.protocol import (
    MAX_HANDS,
    MAX_OBJECTS,
    MAX_POINTS,
    MAX_ZONES,
    Id,
    Lifetime,
    Name,
    Position,
    Pressure,
    Seconds,
    Sequence,
    Session,
)
from pacinian.wire.time import Envelope

Names = Annotated[tuple[Name, ...], Meta(max_length=MAX_OBJECTS)]


class Command(Struct, frozen=True, kw_only=True, tag_field="type"):
    """What all commands have. time: of the client's own steady clock. ttl: for how long the command may live."""

    session: Session
    sequence: Sequence
    time: Seconds
    ttl: Lifetime = 1.0
    id: Id = 0


class Put(Command, frozen=True, kw_only=True, tag="put"):
    """Objects: each is new, or takes the place of the one of that name. objects: by name."""

    objects: Annotated[dict[Name, Object], Meta(max_length=MAX_OBJECTS)]


class Move(Command, frozen=True, kw_only=True, tag="move"):
    """New poses of objects that are there. names: of these objects.

    poses: x, y, z [m], quaternion x, y, z, w of each, (K, 7) float32. velocities: [m/s] and [rad/s],
    (K, 6) float32, or empty: not known.
    """

    names: Names
    poses: Annotated[bytes, Meta(max_length=28 * MAX_OBJECTS)]
    velocities: Annotated[bytes, Meta(max_length=24 * MAX_OBJECTS)] = b""

    BULK = (
        Rows("poses", 7, each="names"),
        Rows("velocities", 6, each="names", empty=True, low=-100.0, high=100.0),
    )

    def __post_init__(self) -> None:
        check_arrays(self)


class Remove(Command, frozen=True, kw_only=True, tag="remove"):
    """Objects are taken away. names: of these; such as nothing has are no error."""

    names: Names


class Clear(Command, frozen=True, kw_only=True, tag="clear"):
    """All of this client's objects, hands and quiet zones are taken away."""


class Envelopes(Command, frozen=True, kw_only=True, tag="envelope"):
    """How strong objects that are there are over time, from now on. names: of these. envelope: for all of them."""

    names: Names
    envelope: Envelope


class HandFrame(Struct, frozen=True, kw_only=True):
    """A hand at the command's time. side: which it is. name: to tell hands of one side apart.

    joints: (26, 3) float32 [m] in OpenXR's order, or empty or NaN: the tracker has lost it. radii: (26,) float32 [m],
    or empty: an adult's. velocities: (26, 3) or (1, 3) float32 [m/s], or empty: not known.
    """

    side: Literal["left", "right"] = "right"
    name: Annotated[str, Meta(max_length=64)] = ""
    joints: Annotated[bytes, Meta(max_length=312)] = b""
    radii: Annotated[bytes, Meta(max_length=104)] = b""
    velocities: Annotated[bytes, Meta(max_length=312)] = b""

    BULK = (
        Rows("joints", 3, (26,), empty=True, low=None),
        Rows("radii", 1, (26,), empty=True, low=None),
        Rows("velocities", 3, (26, 1), empty=True, low=None),
    )

    def __post_init__(self) -> None:
        check_arrays(self)


class Hands(Command, frozen=True, kw_only=True, tag="hands"):
    """All hands that this client tracks, in place of those before.

    From the first such command on its scene is felt by hands only: with none there, nothing sounds. hands: empty
    where there are none.
    """

    hands: Annotated[tuple[HandFrame, ...], Meta(max_length=MAX_HANDS)]


class Zone(Struct, frozen=True, kw_only=True):
    """A ball that is to stay quiet. position: its centre. pressure: the most sound pressure. radius: of the ball."""

    position: Position
    pressure: Pressure
    radius: Annotated[float, Meta(ge=0.0, le=1.0, description="[m]; 0 for a point")] = 0.0


class Quiet(Command, frozen=True, kw_only=True, tag="quiet"):
    """All quiet zones of this client, in place of those before; those of the configuration stay.

    zones: where.
    """

    zones: Annotated[tuple[Zone, ...], Meta(max_length=MAX_ZONES)]


class Field(Command, frozen=True, kw_only=True, tag="field"):
    """Asks for the sound pressure at points, of what is emitted now. points: (K, 3) float32 [m]."""

    points: Annotated[bytes, Meta(max_length=12 * MAX_POINTS)]

    BULK = (Rows("points", 3),)

    def __post_init__(self) -> None:
        check_arrays(self)


class Show(Command, frozen=True, kw_only=True, tag="show"):
    """Asks for the objects of the scene that is felt, or was felt last, whoever put them; since protocol 1.1.

    scene: that the asker knows. since: its `version`, as of the last answer: what was told then is not told again.
    """

    scene: Annotated[str, Meta(max_length=64)] = ""
    since: Annotated[int, Meta(ge=0, le=2**53)] = 0


COMMANDS = Put, Move, Remove, Clear, Envelopes, Hands, Quiet, Field, Show
AnyCommand = Put | Move | Remove | Clear | Envelopes | Hands | Quiet | Field | Show
