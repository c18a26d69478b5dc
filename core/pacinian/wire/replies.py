"""Replies: what the server sends back, each with the `id` of what it answers; 0 where nothing was asked."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from pacinian.wire.protocol import Id, Name, Seconds, Session, Text

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
    lease: from the last renewal to silence, at most [s]. link: from the last heartbeat to silence,
    at most, with a TTL of 0.2 s [s].
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

    name: by which it is. summary: what it is good for. options: its settings and their defaults, where simple.
    """

    name: Name
    summary: Text = ""
    options: dict[str, Any] = {}


class Abilities(Reply, frozen=True, kw_only=True, tag="abilities"):
    """To `capabilities`. solvers, backends: that can be selected. techniques, presets: that there are.

    positions, normals: of the transducers, (N, 3) float32 [m]. frequency: of the ultrasound [Hz]. wavelength: [m].
    phases, amplitudes: levels of the device. device_rate: frames per second that it takes [Hz]. rate: ticks per
    second [Hz]. limits: what no client can exceed, by name.
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


class Pressures(Reply, frozen=True, kw_only=True, tag="pressures"):
    """To `field`. pressures: complex sound pressure, (K, 2) float32: real and imaginary part [Pa].

    time: of the frame that was emitted, by the server's clock [s].
    """

    pressures: bytes
    time: Seconds


REPLIES = Welcome, Ok, Error, Renewed, Abilities, Pressures
AnyReply = Welcome | Ok | Error | Renewed | Abilities | Pressures
