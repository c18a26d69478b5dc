"""Commands: the messages from a client to the command socket.

Each command has a session key, an increasing sequence number, the client's time and a time to live. The server drops
and counts a command that it would apply later than `ttl` after `time`. If several commands for one object wait, the
newest wins. The server answers a command that has an `id` with `ok` or `error`. For a command without one it reports
only errors, and not all of them.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.argument_checks import HEAD_RADIUS
from pacinian.wire.binary_arrays import Rows, check_arrays
from pacinian.wire.modulation import Envelope
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
    Seconds,
    Sequence,
    Session,
)

Names = Annotated[tuple[Name, ...], Meta(max_length=MAX_OBJECTS)]


class Command(Struct, frozen=True, kw_only=True, tag_field="type"):
    """Fields of all commands. time: reading of the client's own steady clock. ttl: time to live of the command."""

    session: Session
    sequence: Sequence
    time: Seconds
    ttl: Lifetime = 1.0
    id: Id = 0


class Put(Command, frozen=True, kw_only=True, tag="put"):
    """Add objects, or replace those that have the same name. objects: the objects by name."""

    objects: Annotated[dict[Name, Object], Meta(max_length=MAX_OBJECTS)]


class Move(Command, frozen=True, kw_only=True, tag="move"):
    """Move existing objects. names: names of the objects.

    poses: x, y, z [m] and quaternion x, y, z, w of each object, (K, 7) float32. velocities: linear [m/s] and
    angular [rad/s] velocity of each, (K, 6) float32; empty if they are not known.
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
    """Remove objects. names: names of the objects; unknown names are no error."""

    names: Names


class Clear(Command, frozen=True, kw_only=True, tag="clear"):
    """Remove all objects, hands and quiet zones of this client."""


class Envelopes(Command, frozen=True, kw_only=True, tag="envelope"):
    """Change the envelope of existing objects. names: names of the objects. envelope: new envelope of all of them."""

    names: Names
    envelope: Envelope


class HandFrame(Struct, frozen=True, kw_only=True):
    """A hand at the command's time. side: left or right. name: distinguishes several hands of one side.

    joints: joint positions in OpenXR's order, (26, 3) float32 [m]; empty or NaN if the tracker has lost the hand.
    radii: joint radii, (26,) float32 [m]; empty for those of an adult. velocities: joint velocities, (26, 3), or one
    for all joints, (1, 3), float32 [m/s]; empty if they are not known.
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
    """Replace the hands that this client tracks.

    From the first such command on, only hands feel the scene: without a hand, the output is silent. hands: all hands
    that are tracked now; empty if there are none.
    """

    hands: Annotated[tuple[HandFrame, ...], Meta(max_length=MAX_HANDS)]


class Zone(Struct, frozen=True, kw_only=True):
    """A ball that must stay quiet. position: centre. pressure: largest sound pressure. radius: radius of the ball."""

    position: Position
    pressure: Annotated[float, Meta(gt=0.0, le=1e6, description="[Pa]")]
    radius: Annotated[float, Meta(ge=0.0, le=1.0, description="[m]; 0 for a point")] = HEAD_RADIUS


class Quiet(Command, frozen=True, kw_only=True, tag="quiet"):
    """Replace the quiet zones of this client. The zones of the server's configuration stay.

    zones: all quiet zones.
    """

    zones: Annotated[tuple[Zone, ...], Meta(max_length=MAX_ZONES)]


class Field(Command, frozen=True, kw_only=True, tag="field"):
    """Request the sound pressure that is emitted now at given points. points: positions, (K, 3) float32 [m]."""

    points: Annotated[bytes, Meta(max_length=12 * MAX_POINTS)]

    BULK = (Rows("points", 3),)

    def __post_init__(self) -> None:
        check_arrays(self)


class Show(Command, frozen=True, kw_only=True, tag="show"):
    """Request the objects of the active or last active scene, whichever client put them; since protocol 1.1.

    scene: name of the scene from the last answer. since: `version` from the last answer; the server leaves out
    objects that it has sent already.
    """

    scene: Annotated[str, Meta(max_length=64)] = ""
    since: Annotated[int, Meta(ge=0, le=2**53)] = 0


COMMANDS = Put, Move, Remove, Clear, Envelopes, Hands, Quiet, Field, Show
AnyCommand = Put | Move | Remove | Clear | Envelopes | Hands | Quiet | Field | Show
