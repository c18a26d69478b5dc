"""Replies: the server's answers, each with the `id` of the message that it answers; 0 if it answers none."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from pacinian.wire.binary_arrays import Rows, check_arrays
from pacinian.wire.objects import Object
from pacinian.wire.protocol import MAX_SHOWN, Id, Name, Seconds, Session, Text

MAX_LISTED_NAMES = 8  # names of objects in the text of a `Shown`
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
    "malformed": "not a message of this protocol; `path` names the wrong field",
    "version": "another major version; `advice` says which side to update",
    "session": "this connection has no session with that key: send `hello`",
    "sequence": "the sequence number is not above the last one",
    "stale": "older than its time to live",
    "argument": "a valid message with an invalid value; `path` names the field",
    "unknown": "no object, solver or backend has that name",
    "limit": "more than the server allows",
    "owner": "another client owns the output",
    "armed": "not possible while the output is armed, or while it is not armed",
    "stopped": "not possible after an emergency stop or a fault: reset first",
    "expired": "the lease, armed without `resume`, was not renewed in time: arm again",
    "fault": "a plug-in or device failed",
    "busy": "too many messages: slow down",
}


class Reply(Struct, frozen=True, kw_only=True, tag_field="type"):
    """Fields of all replies. id: `id` of the message that it answers; 0 if it answers none."""

    id: Id = 0


class Welcome(Reply, frozen=True, kw_only=True, tag="welcome"):
    """Answer to `hello`. session: key for all further messages. protocol: the server's version, major and minor.

    server: name and version of the server, for people. time: reading of the server's clock. scene: name of this
    client's scene. lease: longest time from the last renewal to silence [s]. link: longest time from the loss of the
    connection to silence [s]. rate: ticks per second [Hz].
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
    """The request was carried out."""


class Error(Reply, frozen=True, kw_only=True, tag="error"):
    """The request was refused or has failed. code: one of the table of errors. message: explanation, for people.

    path: path of the field that is wrong, such as `$.objects[...].shape`. advice: remedy, for people.
    """

    code: Code
    message: Annotated[str, Meta(max_length=1000)]
    path: Text = ""
    advice: Annotated[str, Meta(max_length=1000)] = ""


class Renewed(Reply, frozen=True, kw_only=True, tag="renewed"):
    """Answer to `renew`, with its `id`. With `id` 0 it only probes whether the client is still connected.

    sequence, time: the values of the renewal. server_time: reading of the server's clock [s]. until: end of the lease
    by that clock [s]. owner: whether this client owns the output. armed: whether the output may sound.
    """

    sequence: int
    time: Seconds
    server_time: Seconds
    until: Seconds
    owner: bool
    armed: bool


class Plugin(Struct, frozen=True, kw_only=True):
    """A solver or backend that can be selected.

    name: name of the plug-in. summary: one line on its use. options: options that clients may set, with their defaults
    if these are plain values.
    """

    name: Name
    summary: Text = ""
    options: dict[str, Any] = {}


class Sound(Struct, frozen=True, kw_only=True):
    """Parameters of the field: the sum over transducers of g s P0 D(cos theta) r^-n exp(-(absorption + j k) r).

    pressure: P0, sound pressure of one transducer at full drive, on its axis at 1 m [Pa]. directivity: D, "omni" or
    "t4010a1"; empty if it is not known. response: s, factor by which each transducer differs from its kind, real and
    imaginary part, (N, 2) float32; empty if none differs. sizes: amplitude of each level, 0..1, float32; empty if they
    are evenly spaced. speed_of_sound: speed of sound [m/s]. density: density of the air [kg/m^3]. power: n, exponent of
    the distance. absorption: absorption of the amplitude [1/m]. temperature: temperature of the air, configured or
    assumed [degC]; nil if only a speed of sound is configured.
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
    """Answer to `capabilities`. solvers, backends: plug-ins that can be selected. techniques, presets: available names.

    positions: positions of the transducers, (N, 3) float32 [m]. normals: unit normals of the transducers, (N, 3)
    float32. frequency: frequency of the ultrasound [Hz]. wavelength: wavelength of the ultrasound [m]. phases,
    amplitudes: number of levels of the device. device_rate: rows per second that the device plays [Hz]. rate: ticks
    per second [Hz]. limits: limits that no client can exceed, by name. sound: parameters of the field; since protocol
    1.1.
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

    def __repr__(self) -> str:
        solvers, backends = (
            ", ".join(p.name for p in some) for some in (self.solvers, self.backends)
        )
        return (
            f"<Abilities: {len(self.positions) // 12} transducers, {self.rate:g} Hz; solvers {solvers or 'none yet'}; "
            f"backends {backends or 'none yet'}>"
        )


class Pressures(Reply, frozen=True, kw_only=True, tag="pressures"):
    """Answer to `field`. pressures: complex sound pressure, real and imaginary part, (K, 2) float32 [Pa].

    time: time of the emitted frame, by the server's clock [s].
    """

    pressures: bytes
    time: Seconds

    def __repr__(self) -> str:
        return f"<Pressures at {len(self.pressures) // 8} points, time {self.time:.3f} s>"


class Shown(Reply, frozen=True, kw_only=True, tag="shown"):
    """Answer to `show`. scene: name of the active or last active scene; empty before the first.

    version: version of the scene up to which objects were sent. names: names of the objects in the scene, at most
    1024. poses: newest pose of each of these, x, y, z [m] and quaternion x, y, z, w, (K, 7) float32. objects: objects
    that are new since the version asked for, by name, as they were put. If there are many, the answer holds only some:
    ask again. Objects of nearly 1 MiB are left out.
    """

    scene: Annotated[str, Meta(max_length=64)]
    version: int
    names: Annotated[tuple[Name, ...], Meta(max_length=MAX_SHOWN)]
    poses: Annotated[bytes, Meta(max_length=28 * MAX_SHOWN)]
    objects: Annotated[dict[Name, Object], Meta(max_length=MAX_SHOWN)]

    BULK = (Rows("poses", 7, each="names"),)

    def __post_init__(self) -> None:
        check_arrays(self)

    def __repr__(self) -> str:
        names = ", ".join(self.names[:MAX_LISTED_NAMES])
        more = ", ..." if len(self.names) > MAX_LISTED_NAMES else ""
        return (
            f"<Shown: scene {self.scene!r}, version {self.version}, {len(self.names)} objects ({names}{more}), "
            f"{len(self.objects)} of them new>"
        )


REPLIES = Welcome, Ok, Error, Renewed, Abilities, Pressures, Shown
AnyReply = Welcome | Ok | Error | Renewed | Abilities | Pressures | Shown
