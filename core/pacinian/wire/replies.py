"""Replies: what the server sends back, each with the `id` of what it answers; 0 where nothing was asked."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Rows, check_arrays
from pacinian.wire.objects import Object
from pacinian.wire.protocol import MAX_SHOWN, Id, Name, Seconds, Session, Text

Code = Literal[
    "malformed",
    "version",
    "session",
    "sequence",
    "stale",
    "argument",
    "unknown",
    "limit",
    "owner",
    "armed",
    "stopped",
    "expired",
    "fault",
    "busy",
]

CODES: dict[Code, str] = {
    "malformed": "no message of this protocol; `path` says where",
    "version": "another major version; `advice` says which side to update",
    "session": "no session of that key on this connection: say hello",
    "sequence": "not above the last: seen already",
    "stale": "older than its time to live",
    "argument": "understood, and cannot be meant; `path` says where",
    "unknown": "no object, solver or backend of that name",
    "limit": "more than the server allows",
    "owner": "another client owns the output",
    "armed": "cannot be while the output is armed, or while it is not",
    "stopped": "after an emergency stop or a fault: reset first",
    "expired": "the lease was not renewed in time: silence; arm again",
    "fault": "a plug-in or device failed",
    "busy": "too many messages: slow down",
}


class Reply(Struct, frozen=True, kw_only=True, tag_field="type"):
    """What all replies have. id: of what it answers; 0 where nothing was asked."""

    id: Id = 0


class Welcome(Reply, frozen=True, kw_only=True, tag="welcome"):
    """To `hello`. session: key for all that follows. protocol: the server's major, minor.

    server: name and version, for people. time: of the server's clock. scene: the one that this client is in.
    lease: from the last renewal to silence, at most [s]. link: from when the connection is closed or cut off
    to silence, at most [s].
    rate: ticks per second [Hz].
    """

    session: Session
    protocol: tuple[int, int]
    server: Text
    time: Seconds
    scene: Name
    lease: float
    link: float
    rate: float


class Ok(Reply, frozen=True, kw_only=True, tag="ok"):
    """Done."""


class Error(Reply, frozen=True, kw_only=True, tag="error"):
    """Not done. code: as in the table of errors. message: what is wrong, for people.

    path: of the field that is wrong, as `$.objects[...].shape`. advice: what to do.
    """

    code: Code
    message: Annotated[str, Meta(max_length=1000)]
    path: Text = ""
    advice: Annotated[str, Meta(max_length=1000)] = ""


class Renewed(Reply, frozen=True, kw_only=True, tag="renewed"):
    """To `renew`, with its id; with id 0 only to see whether the client is there.

    sequence, time: as they were sent. server_time: of the server's clock [s]. until: when the lease ends, by that
    clock [s]. owner: whether this client owns the output. armed: whether it may sound.
    """

    sequence: int
    time: Seconds
    server_time: Seconds
    until: Seconds
    owner: bool
    armed: bool


class Plugin(Struct, frozen=True, kw_only=True):
    """A solver or backend that can be selected.

    name: by which it is. summary: what it is good for. options: that clients may set, and their defaults,
    where simple.
    """

    name: Name
    summary: Text = ""
    options: dict[str, Any] = {}


class Sound(Struct, frozen=True, kw_only=True):
    """What the field is computed from: the sum over transducers of g s P0 D(cos theta) r^-n exp(-(absorption + j k) r).

    pressure: P0, of one transducer at full drive, 1 m before it [Pa]. directivity: D, "omni" or "t4010a1"; empty: not
    known. response: s, by which factor each differs from its kind, real and imaginary part, (N, 2) float32; empty: none
    does. sizes: amplitude of each level, 0..1, float32; empty: evenly spaced. speed_of_sound: [m/s].
    density: [kg/m^3]. power: n. absorption: of the amplitude [1/m]. temperature: of the air, as the server
    was told or else assumes [degC]; nil where it was told only a speed of sound.
    """

    pressure: float
    directivity: Text
    response: bytes = b""
    sizes: bytes = b""
    speed_of_sound: float
    density: float
    power: float
    absorption: float
    temperature: Annotated[float, Meta(ge=-80.0, le=100.0)] | None = None


class Abilities(Reply, frozen=True, kw_only=True, tag="abilities"):
    """To `capabilities`. solvers, backends: that can be selected. techniques, presets: that there are.

    positions, normals: of the transducers, (N, 3) float32 [m]. frequency: of the ultrasound [Hz]. wavelength: [m].
    phases, amplitudes: levels of the device. device_rate: frames per second that it takes [Hz]. rate: ticks per
    second [Hz]. limits: what no client can exceed, by name. sound: how it sounds; since protocol 1.1.
    """

    solvers: tuple[Plugin, ...]
    backends: tuple[Plugin, ...]
    techniques: tuple[str, ...]
    presets: tuple[str, ...]
    positions: bytes
    normals: bytes
    frequency: float
    wavelength: float
    phases: int
    amplitudes: int
    device_rate: float
    rate: float
    limits: dict[str, float]
    sound: Sound | None = None


class Pressures(Reply, frozen=True, kw_only=True, tag="pressures"):
    """To `field`. pressures: complex sound pressure, (K, 2) float32: real and imaginary part [Pa].

    time: of the frame that was emitted, by the server's clock [s].
    """

    pressures: bytes
    time: Seconds


class Shown(Reply, frozen=True, kw_only=True, tag="shown"):
    """To `show`. scene: that is felt, or was felt last; empty before the first.

    version: of what was told. names: of the objects that are there, 1024 at most. poses: of these, as they were told
    last, x, y, z [m], quaternion x, y, z, w, (K, 7) float32. objects: as they were put, by name, of those that are new
    since; not all, if that would be much: ask again. An object of nearly 1 MiB is left out.
    """

    scene: Annotated[str, Meta(max_length=64)]
    version: int
    names: Annotated[tuple[Name, ...], Meta(max_length=MAX_SHOWN)]
    poses: Annotated[bytes, Meta(max_length=28 * MAX_SHOWN)]
    objects: Annotated[dict[Name, Object], Meta(max_length=MAX_SHOWN)]

    BULK = (Rows("poses", 7, each="names"),)

    def __post_init__(self) -> None:
        check_arrays(self)


REPLIES = Welcome, Ok, Error, Renewed, Abilities, Pressures, Shown
AnyReply = Welcome | Ok | Error | Renewed | Abilities | Pressures | Shown
