"""What pages and the viewer's server say to each other: MessagePack maps with a key `type`, both ways.

`State` and `FrameState` of `pacinian.wire` go to the pages as they are; docs/viewer.md says what the rest is.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Raw, Struct

from pacinian.errors import PacinianError, WireError
from pacinian.wire.control import Choice
from pacinian.wire.protocol import Length, Part, Position, Share
from pacinian.wire.replies import Plugin, Sound
from pacinian.wire.time import Technique

VERSION = 1
MAX_BYTES = 1 << 16  # [bytes] of what a page says
MAX_POINTS = 1 << 18  # of a slice or volume
WRONG = msgspec.MsgspecError, PacinianError, ValueError, IndexError  # what a damaged message raises
PERPENDICULAR = 1e-3  # of u and v, and how far their lengths are from 1

Over = Literal["mean", "peak", "instant"]  # of the field, over the frames of the last moments
Id = Annotated[int, Meta(ge=1, le=2**53)]
Side = Annotated[int, Meta(ge=2, le=1024)]
Direction = tuple[Part, Part, Part]


class PageMessage(Struct, frozen=True, kw_only=True, tag_field="type", forbid_unknown_fields=False):
    """What a page says."""


class Slice(PageMessage, frozen=True, kw_only=True, tag="slice"):
    """The field in a plane is wanted, again whenever what is emitted has changed, until `hide`.

    The point of row i and column j is centre + ((j + 1/2) / cols - 1/2) w u + ((i + 1/2) / rows - 1/2) h v.
    u, v: unit vectors at a right angle. size: w, h [m]. shape: rows, cols. of: radiation pressure, or its error on
    regions: made minus asked. over: mean or largest pressure over the frames of the last moments, or that of the newest
    frame; an error is always that of the mean.
    """

    id: Id
    centre: Position
    u: Direction
    v: Direction
    size: tuple[Length, Length]
    shape: tuple[Side, Side]
    of: Literal["pressure", "error"] = "pressure"
    over: Over = "mean"

    def __post_init__(self) -> None:
        _few(self.shape)
        lengths = math.hypot(*self.u), math.hypot(*self.v)
        along = sum(a * b for a, b in zip(self.u, self.v, strict=True))
        if max(abs(along), *(abs(length - 1.0) for length in lengths)) > PERPENDICULAR:
            raise ValueError("`u` and `v` must be unit vectors at a right angle")


class Skin(Slice, frozen=True, kw_only=True, tag="skin"):
    """What is felt on regions, and what is asked there, as seen from a plane before them; as a slice else."""


class Volume(PageMessage, frozen=True, kw_only=True, tag="volume"):
    """The field in a box is wanted, as a slice is. The point (i, j, k) is origin + spacing (i, j, k), k the fastest."""

    id: Id
    origin: Position
    spacing: Length
    shape: tuple[Side, Side, Side]
    over: Over = "mean"

    def __post_init__(self) -> None:
        _few(self.shape)


class Hide(PageMessage, frozen=True, kw_only=True, tag="hide"):
    """No slice, or no volume, any more."""

    what: Literal["slice", "volume", "skin"]


class Seen(PageMessage, frozen=True, kw_only=True, tag="seen"):
    """The page has the slice or volume of that id: the next may come."""

    id: Id


class Select(PageMessage, frozen=True, kw_only=True, tag="select"):
    """As the wire's `select`, with the server's rules."""

    solver: Choice | None = None
    backend: Choice | None = None
    technique: Technique | None = None
    intensity: Share | None = None


class Arm(PageMessage, frozen=True, kw_only=True, tag="arm"):
    """The user has clicked: that scene is to be felt, for as long as this page says `alive`. scene: by name, or own."""

    scene: Annotated[str, Meta(max_length=64)] = ""
    take: bool = False


class Alive(PageMessage, frozen=True, kw_only=True, tag="alive"):
    """The page that armed is still looked at: the lease goes on."""


class Disarm(PageMessage, frozen=True, kw_only=True, tag="disarm"):
    """Silence, softly."""


class Stop(PageMessage, frozen=True, kw_only=True, tag="stop"):
    """Emergency stop."""


class Reset(PageMessage, frozen=True, kw_only=True, tag="reset"):
    """After an emergency stop or a fault."""


class Demonstrate(PageMessage, frozen=True, kw_only=True, tag="demonstrate"):
    """Play a demonstration on the server, or end it: only while nobody owns the output, and this page says `alive`."""

    on: bool


class Record(PageMessage, frozen=True, kw_only=True, tag="record"):
    """Begin to record, or end it."""

    on: bool


class Replay(PageMessage, frozen=True, kw_only=True, tag="replay"):
    """Of a recording: go to a time [s], play or pause, faster or slower."""

    time: Annotated[float, Meta(ge=0.0, le=1e9)] | None = None
    playing: bool | None = None
    speed: Annotated[float, Meta(ge=0.05, le=20.0)] | None = None


AnyAsked = (
    Skin
    | Slice
    | Volume
    | Hide
    | Seen
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
    """What a page is told."""


class Hello(ServerMessage, frozen=True, kw_only=True, tag="hello"):
    """The first message. recording: of a file that is replayed, its name; empty where a server is watched."""

    version: int = VERSION
    viewer: str
    recording: str = ""


class ArrayMessage(ServerMessage, frozen=True, kw_only=True, tag="array"):
    """There is a server (again), or what it has is new: as the wire's `abilities`.

    fields: whether slices and volumes can be had. sound: what they are computed from.
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


class Session(ServerMessage, frozen=True, kw_only=True, tag="session"):
    """The viewer as the server's client. name: by which it is the owner in `state`. armed: by a page of this viewer.

    mine: by this one, which must say `alive` oftener than `lease` [s].
    """

    name: str
    scene: str
    lease: float
    armed: bool
    mine: bool


class SceneryMessage(ServerMessage, frozen=True, kw_only=True, tag="scenery"):
    """Objects of the scene that is felt. objects: those that are new since the last scenery, as wire objects.

    poses: of all that are there, x, y, z [m], quaternion x, y, z, w, (7,) float32 each; others are gone.
    """

    version: int
    scene: str
    objects: dict[str, Raw]
    poses: dict[str, bytes]


class SliceMessage(ServerMessage, frozen=True, kw_only=True, tag="slice"):
    """As asked; pressure: radiation pressure, or its error, (rows, cols) float32 [Pa].

    time: of the newest frame [s]. frames: how many frames count; 1 where all of the last moments are the same.
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
    """As asked. felt: radiation pressure on the skin, mean over the last frames; asked: (rows, cols) float32 [Pa] each.

    Not numbers where nothing is felt. time: of the newest frame [s].
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
    """As asked; pressure: radiation pressure (nx, ny, nz) float32 [Pa]. time: of the frame [s]."""

    id: int
    origin: Position
    spacing: float
    shape: tuple[int, int, int]
    pressure: bytes
    time: float


class Histogram(ServerMessage, frozen=True, kw_only=True, tag="histogram"):
    """Times of the ticks of the last second. edges_ms: B + 1. counts: B; of the first and last also what is beyond."""

    edges_ms: tuple[float, ...]
    counts: tuple[int, ...]
    deadline_ms: float


class History(ServerMessage, frozen=True, kw_only=True, tag="history"):
    """Of a recording: what was before the time that is shown, for charts. Not numbers where there is none.

    times: by the server's clock, (K,) float64 [s]. drive_mean, drive_max: of the amplitudes, 0..1; error: of the sound
    pressures at the samples, (K,) float32.
    """

    times: bytes
    drive_mean: bytes
    drive_max: bytes
    error: bytes


class Lost(ServerMessage, frozen=True, kw_only=True, tag="lost"):
    """There is no server, or none any more; an `array` tells that it is back."""

    reason: str


class Refused(ServerMessage, frozen=True, kw_only=True, tag="refused"):
    """What was asked is not done. action: `type` of what was asked."""

    action: str
    message: str
    advice: str = ""


class Recording(ServerMessage, frozen=True, kw_only=True, tag="record"):
    """Whether the feed is being recorded, and to which file."""

    on: bool
    file: str = ""


class Replayed(ServerMessage, frozen=True, kw_only=True, tag="replay"):
    """How a replay stands [s]."""

    time: float
    duration: float
    playing: bool
    speed: float


_asked: msgspec.msgpack.Decoder[AnyAsked] = msgspec.msgpack.Decoder(AnyAsked)
_encoder = msgspec.msgpack.Encoder()


def decode_message(data: bytes) -> AnyAsked:
    """What a page says. Raises WireError."""
    try:
        return _asked.decode(data)
    except (msgspec.MsgspecError, ValueError, RecursionError, MemoryError) as error:
        raise WireError(str(error)[:300]) from error


def encode_message(message: ServerMessage) -> bytes:
    """As bytes."""
    return _encoder.encode(message)


def _few(shape: tuple[int, ...]) -> None:
    if math.prod(shape) > MAX_POINTS:
        raise ValueError(f"`shape` must be at most {MAX_POINTS:,} points")
