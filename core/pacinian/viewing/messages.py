"""Messages between pages and the viewer's server: MessagePack maps with a key `type`, in both directions.

`State` and `FrameState` of `pacinian.wire` are passed on to the pages unchanged. docs/viewer-feed.md describes all
messages.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Raw, Struct

from pacinian.errors import PacinianError, WireError
from pacinian.wire.control import Choice
from pacinian.wire.modulation import Technique
from pacinian.wire.protocol import Length, Part, Position, Share
from pacinian.wire.replies import Plugin, Sound

VERSION = 2
MAX_BYTES = 1 << 16  # maximum size of a message from a page [bytes]
MAX_POINTS = 1 << 18  # maximum number of points of a slice or volume
WRONG = msgspec.MsgspecError, PacinianError, ValueError, IndexError  # from a damaged message
PERPENDICULAR = 1e-3  # tolerance of the dot product u v, and of the lengths of u and v

Over = Literal["mean", "peak", "instant"]  # how the recent frames are combined
Id = Annotated[int, Meta(ge=1, le=2**53)]
Side = Annotated[int, Meta(ge=2, le=1024)]
Direction = tuple[Part, Part, Part]


class PageMessage(Struct, frozen=True, kw_only=True, tag_field="type", forbid_unknown_fields=False):
    """Base of the messages from a page."""


class Plane(PageMessage, frozen=True, kw_only=True):
    """Base of the requests for a plane, answered now and whenever the emission changes, until `hide`.

    The point of row i and column j is centre + ((j + 1/2) / cols - 1/2) w u + ((i + 1/2) / rows - 1/2) h v.
    u, v: unit vectors at a right angle. size: w, h [m]. shape: rows, cols.
    """

    id: Id
    centre: Position
    u: Direction
    v: Direction
    size: tuple[Length, Length]
    shape: tuple[Side, Side]

    def __post_init__(self) -> None:
        _check_point_count(self.shape)
        lengths = math.hypot(*self.u), math.hypot(*self.v)
        along = sum(a * b for a, b in zip(self.u, self.v, strict=True))
        if max(abs(along), *(abs(length - 1.0) for length in lengths)) > PERPENDICULAR:
            raise ValueError("`u` and `v` must be unit vectors at a right angle")


class Slice(Plane, frozen=True, kw_only=True, tag="slice"):
    """Request the field in a plane.

    of: radiation pressure, or its error on regions (delivered minus target). over: mean or maximum over the recent
    frames, or the newest frame alone; the error is always that of the mean.
    """

    of: Literal["pressure", "error"] = "pressure"
    over: Over = "mean"


class Skin(Plane, frozen=True, kw_only=True, tag="skin"):
    """Request the mean radiation pressure on regions and its target, seen from a plane before them."""


class Volume(PageMessage, frozen=True, kw_only=True, tag="volume"):
    """Request the field in a box, as `Slice`. The point (i, j, k) is origin + spacing (i, j, k), with k fastest."""

    id: Id
    origin: Position
    spacing: Length
    shape: tuple[Side, Side, Side]
    over: Over = "mean"

    def __post_init__(self) -> None:
        _check_point_count(self.shape)


FieldRequest = Slice | Skin | Volume


class Hide(PageMessage, frozen=True, kw_only=True, tag="hide"):
    """End the updates of a slice, volume or skin."""

    what: Literal["slice", "volume", "skin"]


class FieldAck(PageMessage, frozen=True, kw_only=True, tag="seen"):
    """Acknowledge the slice, skin or volume with that id, so that the next one is sent."""

    id: Id


class BatchAck(PageMessage, frozen=True, kw_only=True, tag="ready"):
    """Acknowledge a `batch`, so that the next values are sent."""


class Select(PageMessage, frozen=True, kw_only=True, tag="select"):
    """Select as with the wire's `select`; the server's rules apply."""

    solver: Choice | None = None
    backend: Choice | None = None
    technique: Technique | None = None
    intensity: Share | None = None


class Arm(PageMessage, frozen=True, kw_only=True, tag="arm"):
    """Arm, after a click, for as long as this page sends `alive`. scene: its name; empty for the viewer's own scene."""

    scene: Annotated[str, Meta(max_length=64)] = ""
    take: bool = False


class Alive(PageMessage, frozen=True, kw_only=True, tag="alive"):
    """Say that the page is still visible, which keeps the lease or the demonstration alive."""


class Disarm(PageMessage, frozen=True, kw_only=True, tag="disarm"):
    """Fade to silence and disarm."""


class Stop(PageMessage, frozen=True, kw_only=True, tag="stop"):
    """Stop the output at once: an emergency stop."""


class Reset(PageMessage, frozen=True, kw_only=True, tag="reset"):
    """Allow arming again after an emergency stop or a fault."""


class Demonstrate(PageMessage, frozen=True, kw_only=True, tag="demonstrate"):
    """Start or end the demonstration. It plays only while nobody else owns the output and this page sends `alive`."""

    on: bool


class Record(PageMessage, frozen=True, kw_only=True, tag="record"):
    """Start or end the recording of the feed."""

    on: bool


class Replay(PageMessage, frozen=True, kw_only=True, tag="replay"):
    """Control the playback of a recording. time: jump to this time [s]. playing: play or pause. speed: factor."""

    time: Annotated[float, Meta(ge=0.0, le=1e9)] | None = None
    playing: bool | None = None
    speed: Annotated[float, Meta(ge=0.05, le=20.0)] | None = None


AnyPageMessage = (
    FieldRequest
    | Hide
    | FieldAck
    | BatchAck
    | Select
    | Arm
    | Alive
    | Disarm
    | Stop
    | Reset
    | Record
    | Replay
    | Demonstrate
)


class ServerMessage(Struct, frozen=True, kw_only=True, tag_field="type"):
    """Base of the messages to a page."""


class Hello(ServerMessage, frozen=True, kw_only=True, tag="hello"):
    """The first message. recording: name of the file that is played; empty if a server is watched."""

    version: int = VERSION
    viewer: str
    recording: str = ""


class ArrayMessage(ServerMessage, frozen=True, kw_only=True, tag="array"):
    """The server's properties, as in the wire's `abilities`: sent when it connects, and when they change.

    fields: whether slices and volumes are available. sound: data that they are computed from.
    """

    server: str
    positions: bytes
    normals: bytes
    frequency: float
    wavelength: float
    phases: int
    amplitudes: int
    device_rate: float
    rate: float
    limits: dict[str, float]
    solvers: tuple[Plugin, ...]
    backends: tuple[Plugin, ...]
    techniques: tuple[str, ...]
    presets: tuple[str, ...]
    fields: bool
    sound: Sound | None = None


class SessionMessage(ServerMessage, frozen=True, kw_only=True, tag="session"):
    """The viewer's session with the server. name: the owner's name in `state` while the viewer owns the output.

    armed: whether a page of this viewer armed the output. mine: whether the receiving page did; then it must send
    `alive` several times per `lease` [s].
    """

    name: str
    scene: str
    lease: float
    armed: bool
    mine: bool


class SceneryMessage(ServerMessage, frozen=True, kw_only=True, tag="scenery"):
    """The objects of the rendered scene. objects: objects that are new since the last scenery, as wire objects.

    poses: poses of all objects that exist, x, y, z [m], quaternion x, y, z, w, (7,) float32 each. Objects without a
    pose are gone.
    """

    version: int
    scene: str
    objects: dict[str, Raw]
    poses: dict[str, bytes]


class SliceMessage(ServerMessage, frozen=True, kw_only=True, tag="slice"):
    """The reply to `Slice`. pressure: radiation pressure, or its error, (rows, cols) float32 [Pa].

    time: time of the newest frame [s]. frames: number of frames that count; 1 if all recent frames are equal.
    """

    id: int
    centre: Position
    u: Direction
    v: Direction
    size: tuple[float, float]
    shape: tuple[int, int]
    of: str
    over: str = "mean"
    frames: int = 1
    pressure: bytes
    time: float


class SkinMessage(ServerMessage, frozen=True, kw_only=True, tag="skin"):
    """The reply to `Skin`. felt: radiation pressure on the skin. asked: its target. Both are means over the modulation.

    Both are (rows, cols) float32 [Pa], NaN where nothing is felt. time: time of the newest frame [s].
    """

    id: int
    centre: Position
    u: Direction
    v: Direction
    size: tuple[float, float]
    shape: tuple[int, int]
    felt: bytes
    asked: bytes
    time: float


class VolumeMessage(ServerMessage, frozen=True, kw_only=True, tag="volume"):
    """The reply to `Volume`. pressure: radiation pressure (nx, ny, nz) float32 [Pa]. time: time of the frame [s]."""

    id: int
    origin: Position
    spacing: float
    shape: tuple[int, int, int]
    pressure: bytes
    time: float


class Histogram(ServerMessage, frozen=True, kw_only=True, tag="histogram"):
    """Tick times of the last second. edges_ms: (B + 1) [ms]. counts: (B); the outer bins include all values beyond."""

    edges_ms: tuple[float, ...]
    counts: tuple[int, ...]
    deadline_ms: float


class SilenceMessage(ServerMessage, frozen=True, kw_only=True, tag="silence"):
    """Why the output is silent, as `pacinian status` says it, and what to do. Both are empty while it sounds."""

    cause: str = ""
    text: str = ""


class History(ServerMessage, frozen=True, kw_only=True, tag="history"):
    """Values of a recording before the time shown, for the charts. NaN where there is no value.

    times: times by the server's clock, (K,) float64 [s]. drive_mean, drive_max: mean and maximum of the amplitudes,
    0..1. error: error of the sound pressures at the samples. (K,) float32 each.
    """

    times: bytes
    drive_mean: bytes
    drive_max: bytes
    error: bytes


class Lost(ServerMessage, frozen=True, kw_only=True, tag="lost"):
    """There is no server, or the connection was lost. An `array` follows when the server is back."""

    reason: str


class BatchEnd(ServerMessage, frozen=True, kw_only=True, tag="batch"):
    """The end of what was new. The next values are sent once the page has answered `ready`."""


class Refused(ServerMessage, frozen=True, kw_only=True, tag="refused"):
    """A request was refused. action: `type` of the request."""

    action: str
    message: str
    advice: str = ""


class Recording(ServerMessage, frozen=True, kw_only=True, tag="record"):
    """State of the recording. on: whether the feed is being recorded. file: path of the file."""

    on: bool
    file: str = ""


class PlaybackState(ServerMessage, frozen=True, kw_only=True, tag="replay"):
    """State of the playback. time, duration: [s]."""

    time: float
    duration: float
    playing: bool
    speed: float


_decoder: msgspec.msgpack.Decoder[AnyPageMessage] = msgspec.msgpack.Decoder(AnyPageMessage)
_encoder = msgspec.msgpack.Encoder()


def decode_message(data: bytes) -> AnyPageMessage:
    """Decode a message from a page. Raises WireError."""
    try:
        return _decoder.decode(data)
    except (msgspec.MsgspecError, ValueError, RecursionError, MemoryError) as error:
        raise WireError(str(error)[:300]) from error


def encode_message(message: ServerMessage) -> bytes:
    """Encode a message to a page."""
    return _encoder.encode(message)


def _check_point_count(shape: tuple[int, ...]) -> None:
    if math.prod(shape) > MAX_POINTS:
        raise ValueError(f"`shape` must be at most {MAX_POINTS:,} points")
