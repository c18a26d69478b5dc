"""The protocol's version, its limits, the heartbeats of clients, and the types of its fields.

A message is one MessagePack map with a key `type`. Newer minor versions only add optional fields, which older
readers ignore. Any other change makes a new major version. Lengths are in metres and times in seconds; the world's
frame is right-handed. Bulk numbers are little-endian in a `bin`: float32, unless the field says otherwise.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

MAJOR, MINOR = 1, 1
MAX_COMMAND_BYTES = 1 << 20  # size of a message on the command socket [bytes]
MAX_CONTROL_BYTES = 1 << 16  # size of a message on the control socket [bytes]
MAX_REPLY_BYTES = 1 << 20  # size of a reply or state [bytes]
SESSION_BYTES = 16  # size of a session key [bytes]

HEARTBEAT_INTERVAL_MS = 50  # time between two ZMTP heartbeats of a client [ms]
HEARTBEAT_TIMEOUT_MS = 1500  # longest silence of the server after a heartbeat [ms]

MAX_OBJECTS = 256  # objects in one message
MAX_HANDS = 8  # hands in one message
MAX_ZONES = 16  # quiet zones of all clients of one scene
MAX_SHOWN = 1024  # objects in the answer to `show`
MAX_POINTS = 65_536  # points in one field query
MAX_VERTICES = 50_000  # vertices of a mesh or polyline
MAX_FACES = 50_000  # faces of a mesh
MAX_VALUES = 200_000  # values of a texture, height map, voxel grid or wave
MAX_PARTICLES = 10_000  # points of one `particles` object
MAX_PARTS = 16  # parts of a union, intersection or difference
MAX_OPTIONS = 32  # options of a solver or backend
MAX_TIME_TO_LIVE = 60.0  # time to live of a command [s]
MAX_COORDINATE = 10.0  # absolute value of a coordinate of a position [m]
MAX_SPEED = 100.0  # speed [m/s], and angular speed [rad/s]

Name = Annotated[str, Meta(min_length=1, max_length=64, description="a name")]
Text = Annotated[str, Meta(max_length=200, description="a text")]
Id = Annotated[int, Meta(ge=0, le=2**32 - 1, description="repeated in the reply; 0: no reply")]
Sequence = Annotated[int, Meta(ge=1, le=2**53, description="increases with each message")]
Session = Annotated[
    bytes,
    Meta(min_length=SESSION_BYTES, max_length=SESSION_BYTES, description="key from `welcome`"),
]
Seconds = Annotated[float, Meta(ge=-1e12, le=1e12, description="[s]")]
Lifetime = Annotated[float, Meta(ge=0.0, le=MAX_TIME_TO_LIVE, description="[s]")]
Coordinate = Annotated[float, Meta(ge=-MAX_COORDINATE, le=MAX_COORDINATE, description="[m]")]
Length = Annotated[float, Meta(gt=0.0, le=10.0, description="[m]")]
Share = Annotated[float, Meta(ge=0.0, le=1.0, description="0..1")]
Part = Annotated[float, Meta(ge=-1.01, le=1.01, description="of a unit quaternion")]
Speed = Annotated[float, Meta(ge=-MAX_SPEED, le=MAX_SPEED, description="[m/s] or [rad/s]")]
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
