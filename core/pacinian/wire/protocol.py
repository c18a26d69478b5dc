"""The protocol's version, its limits, and the types of its fields.

A message is one MessagePack map with a key `type`. Newer minor versions only add optional fields, which older
readers ignore; anything else is a new major version. Lengths are in metres, time in seconds, all in the
world's right-handed frame. Bulk numbers are little-endian float32 in a `bin`.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

MAJOR, MINOR = 1, 1
MAX_COMMAND_BYTES = 1 << 20  # [bytes] of a message on the command socket
MAX_CONTROL_BYTES = 1 << 16  # [bytes] of a message on the control socket
MAX_REPLY_BYTES = 1 << 20  # [bytes] of a reply or state
SESSION = 16  # [bytes] of a session's key

MAX_OBJECTS = 256  # in one message
MAX_HANDS = 8
MAX_ZONES = 16
MAX_SHOWN = 1024  # objects of a scene that is looked at
MAX_POINTS = 65_536  # of a query for the field
MAX_VERTICES = 50_000  # of a mesh
MAX_FACES = 50_000
MAX_VALUES = 200_000  # of a texture, height map, voxel grid or wave
MAX_PARTICLES = 10_000
MAX_PARTS = 16  # of a union, intersection or difference
MAX_OPTIONS = 32  # of a solver or backend
MAX_TIME_TO_LIVE = 60.0  # [s] that a command may live

Name = Annotated[str, Meta(min_length=1, max_length=64, description="a name")]
Text = Annotated[str, Meta(max_length=200, description="a text")]
Id = Annotated[int, Meta(ge=0, le=2**32 - 1, description="given back in the reply; 0: no reply")]
Sequence = Annotated[int, Meta(ge=1, le=2**53, description="counts up with each message")]
Session = Annotated[
    bytes, Meta(min_length=SESSION, max_length=SESSION, description="key from `welcome`")
]
Seconds = Annotated[float, Meta(ge=-1e12, le=1e12, description="[s]")]
Lifetime = Annotated[float, Meta(ge=0.0, le=MAX_TIME_TO_LIVE, description="[s]")]
Coordinate = Annotated[float, Meta(ge=-10.0, le=10.0, description="[m]")]
Length = Annotated[float, Meta(gt=0.0, le=10.0, description="[m]")]
Share = Annotated[float, Meta(ge=0.0, le=1.0, description="0..1")]
Part = Annotated[float, Meta(ge=-1.01, le=1.01, description="of a unit quaternion")]
Speed = Annotated[float, Meta(ge=-100.0, le=100.0, description="[m/s] or [rad/s]")]
Pressure = Annotated[float, Meta(ge=0.0, le=1e6, description="[Pa]")]
Force = Annotated[float, Meta(ge=0.0, le=1e3, description="[N]")]
Frequency = Annotated[float, Meta(ge=0.0, le=20_000.0, description="[Hz]")]
Priority = Annotated[int, Meta(ge=-1_000_000, le=1_000_000)]
Duration = Annotated[float, Meta(gt=0.0, le=1e6, description="[s]")]
Angle = Annotated[float, Meta(ge=-1e6, le=1e6, description="[deg]")]
Turns = Annotated[int, Meta(ge=1, le=100)]
Side = Annotated[int, Meta(ge=1, le=MAX_VALUES, description="numbers along one side of a grid")]
Position = tuple[Coordinate, Coordinate, Coordinate]
Rotation = tuple[Part, Part, Part, Part]
Extent = tuple[Length, Length, Length]
Velocity = tuple[Speed, Speed, Speed]
