"""Messages between the server's processes, each in its own `SharedRegister` in the server's private folder.

    file                 writer    readers                value
    permit               control   guard, render          Permit
    sessions             control   bus                    SessionTable
    selections           control   render, guard          Selections
    changes              bus       render                 Changes, each only after the last was acknowledged
    changes_ack          render    bus                    ChangesAck
    frame                render    guard, control, bus    FrameHead, then the levels
    renderer_status      render    control                RendererStatus
    device               guard     control, render, bus   DeviceStatus
    bus_status           bus       control                BusStatus

A new value in any but `renderer_status` and `bus_status` also wakes those that wait for it: `open_wakes`.

All are MessagePack arrays, except for `permit` and `frame`, which are read each tick and packed by `struct`. All times
are of `time.perf_counter`, which all processes of one machine share.
"""

from __future__ import annotations

import struct
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
import numpy as np
from msgspec import Struct

from pacinian.plugins.backend import Capability
from pacinian.rendering.row_times import MAX_SERVER_ROWS
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.ipc.scheduling import ANY_CORE
from pacinian.serving.ipc.wake_pipe import WakePipe
from pacinian.wire.control import Choice
from pacinian.wire.modulation import Technique
from pacinian.wire.replies import Plugin

if TYPE_CHECKING:
    from pathlib import Path

# Capacities of the files [bytes]. That of `frame` depends on the array: see `compute_frame_capacity`.
CAPACITIES = {
    "permit": 64,
    "sessions": 1 << 20,
    "selections": 1 << 18,
    "changes": 4 << 20,
    "changes_ack": 64,
    "renderer_status": 2 << 20,
    "device": 1 << 19,
    "bus_status": 1 << 20,
}
# The processes that wait for a new value of each file. Other readers check it at intervals.
WAITING_PROCESSES = {
    "permit": ("guard", "render"),
    "frame": ("guard",),
    "selections": ("guard", "render"),
    "changes": ("render",),
    "device": ("render",),
    "changes_ack": ("bus",),
    "sessions": ("bus",),
}

HEAD_BYTES = 96  # size of a frame's head, before its levels [bytes]


def compute_frame_capacity(transducers: int) -> int:
    """Return the capacity of the file `frame` [bytes]."""
    return HEAD_BYTES + 4 * MAX_SERVER_ROWS * transducers


def open_wake_pipe(folder: Path, process: str) -> WakePipe:
    """Open the pipe on which a process waits. folder: of the shared memory."""
    return WakePipe(folder / f"{process}.wake")


def open_wakes(file: Path) -> tuple[WakePipe, ...]:
    """Open the pipes of the processes that wait for a file, for its writer."""
    return tuple(
        open_wake_pipe(file.parent, process) for process in WAITING_PROCESSES.get(file.name, ())
    )


class PermitState(IntEnum):
    """What a permit allows: nothing; sound; or only that the sound fades out."""

    SILENT = 0
    ARMED = 1
    FADING = 2


class Permit(NamedTuple):
    """The permit to sound.

    armed: a `PermitState`. until: when it expires [s]. epoch: counts the permits given; only frames of the same epoch
    are let through. stopped: 1 after an emergency stop or the server's end. scene: number of the scene that may be
    rendered. A scene that ends and begins again has another number.
    """

    armed: int = PermitState.SILENT
    until: float = 0.0
    epoch: int = 0
    stopped: int = 0
    scene: int = 0

    def pack(self) -> bytes:
        """Return the permit as bytes."""
        return _PERMIT.pack(*self)

    @classmethod
    def unpack(cls, data: bytes) -> Permit:
        """Return the permit from bytes."""
        return cls(*_PERMIT.unpack(data))


_PERMIT = struct.Struct("<qdqqq")


class FrameHead(NamedTuple):
    """The head of a frame. The levels follow: phase, then amplitude, each (rows, columns) little-endian uint16.

    sequence, time: as in `pacinian.Frame`. epoch: the permit's. device: the generation of the device that the frame is
    for. rows: 0 for silence. input: sequence number of the newest hand update in the frame; sent: its time by the
    client's clock [s]; received: its time by the server's clock [s]. start: time at which the scene's time was 0
    [s]. part: which frame of a cycle the first row is, from 0; parts: number of frames in the cycle, which the rows
    play in turn; 0 if it is not known.
    """

    sequence: int
    time: float
    epoch: int
    device: int
    rows: int
    columns: int
    input: int = 0
    sent: float = 0.0
    received: float = 0.0
    start: float = 0.0
    part: int = 0
    parts: int = 0

    def pack(self) -> bytes:
        """Return the head as bytes."""
        return _FRAME.pack(*self)

    @classmethod
    def unpack(cls, data: bytes) -> FrameHead:
        """Return the head from the first bytes of a frame."""
        return cls(*_FRAME.unpack_from(data))


_FRAME = struct.Struct("<qdqqqqqdddqq")
# A hand update in `DeviceStatus.inputs` and `State.inputs`: sequence number; times at which it was sent, received and
# emitted [s].
HAND_UPDATE = struct.Struct("<4d")


class SessionInfo(Struct, frozen=True, array_like=True):
    """A client that may send commands. user: as authenticated. number: of its scene, as in `Permit`."""

    key: bytes
    name: str
    scene: str
    user: str
    number: int = 0


class SessionTable(Struct, frozen=True, array_like=True):
    """The sessions that may send commands. owned: the owner's scene, or ""."""

    sessions: tuple[SessionInfo, ...] = ()
    owned: str = ""


SUPERSEDED = "replaced by a newer selection"  # result of a selection that was not carried out


class Selections(Struct, frozen=True, array_like=True):
    """The newest selections, each with its number, so that it is carried out once. `results` then has its result.

    solver, backend: None before the first selection. technique, intensity: the current ones. reset: number of resets.
    """

    solver: tuple[int, Choice | None] = (0, None)
    backend: tuple[int, Choice | None] = (0, None)
    technique: tuple[int, Technique | None] = (0, None)
    intensity: tuple[int, float] = (0, 1.0)
    reset: int = 0


class Change(Struct, frozen=True, array_like=True, tag=True):
    """One change of the rendered scene."""


class ResetScene(Change, frozen=True):
    """Drop the whole scene.

    The changes that follow belong to another scene, or to the same scene again. scene: its number.
    """

    scene: int = 0


class PutObject(Change, frozen=True):
    """Put an object of `pacinian.scene`, encoded. default: the object has no technique of its own."""

    name: str
    item: bytes
    default: bool


class MoveObject(Change, frozen=True):
    """Set a pose: position [m], rotation; velocities or None; seen at `time` [s]."""

    name: str
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    velocity: tuple[float, float, float] | None
    angular_velocity: tuple[float, float, float] | None
    time: float


class SetEnvelope(Change, frozen=True):
    """Set an object's envelope, encoded."""

    name: str
    envelope: bytes


class RemoveObject(Change, frozen=True):
    """Remove an object."""

    name: str


class HandInfo(Struct, frozen=True, array_like=True):
    """A hand: arrays as float32, as on the wire. name: unique among the hands of all clients."""

    side: str
    name: str
    joints: bytes
    radii: bytes
    velocities: bytes
    time: float


class SetHands(Change, frozen=True):
    """Set all hands of all clients of the scene.

    felt: whether any client tracks hands; otherwise whole objects are rendered. input, sent, received: of the newest
    hand update, as in `FrameHead`.
    """

    hands: tuple[HandInfo, ...]
    felt: bool
    input: int
    sent: float
    received: float


class SetQuiet(Change, frozen=True):
    """Set all quiet zones: position [m], maximum sound pressure [Pa] and radius [m] of each."""

    zones: tuple[tuple[tuple[float, float, float], float, float], ...] = ()


AnyChange = ResetScene | PutObject | MoveObject | SetEnvelope | RemoveObject | SetHands | SetQuiet


class Changes(Struct, frozen=True, array_like=True):
    """Changes in order. number: counts up from 1; a restarted bus starts from 1 again."""

    number: int
    run: int
    """A random number that identifies this run of the bus."""
    changes: tuple[AnyChange, ...]


class ChangesAck(Struct, frozen=True, array_like=True):
    """The last changes that the renderer took.

    number, bus: their `number` and `run`. run: a random number that identifies this run of the renderer. To a new run,
    the bus sends the whole scene.
    """

    number: int
    run: int
    bus: int


class RendererStatus(Struct, frozen=True, array_like=True):
    """The status of the renderer.

    state: fields of `pacinian.wire.state.State`. results: of selections, by "kind number": "" if done, otherwise
    the reason. halted: the fault that keeps it silent, or "". refused: names of objects that could not be put, and why.
    """

    heartbeat: float
    state: dict[str, Any]
    results: dict[str, str] = {}
    halted: str = ""
    refused: dict[str, str] = {}
    solvers: tuple[Plugin, ...] = ()
    """The solvers that can be selected."""


class DeviceStatus(Struct, frozen=True, array_like=True):
    """The status of the device.

    generation: counts devices; a frame must name the generation it is for; 0: there is no device. next_generation: the
    one that takes over with the first frame for it, or 0. phases, amplitudes: numbers of levels; rate [rows/s]: of
    `next_generation` if there is one, otherwise of `generation`. heartbeat: when the guard ran its last round [s].
    fault: of the device, or "". frames: number of frames that the device took. silences: number of times sound was
    ended; reasons: the same by reason. longest_gap: longest time between frames since the output was last armed [s].
    inputs: the last hand updates, as in `State`; input_count: number of hand updates so far. results: of selections and
    resets, by "backend number" and "reset number": "" if done, otherwise the reason. sizes: amplitude of each level,
    float32; empty if they are evenly spaced. processor: the core that the guard is bound to, or `ANY_CORE`. choice:
    that of `generation`; or, if another guard had the device and died, of the device that may still sound.
    """

    generation: int
    next_generation: int
    name: str
    phases: int
    amplitudes: int
    rate: float
    watchdog: float | None
    heartbeat: float
    sounding: bool
    fault: str = ""
    frames: int = 0
    silences: int = 0
    stale: bool = False
    longest_gap: float = 0.0
    inputs: bytes = b""
    input_count: int = 0
    results: dict[str, str] = {}
    backends: tuple[Plugin, ...] = ()
    """The backends that can be selected."""
    reasons: dict[str, int] = {}
    sizes: bytes = b""
    processor: int = ANY_CORE
    choice: PluginConfig | None = None

    @property
    def capability(self) -> Capability:
        """The capability of the device. Raises ArgumentError for values that no device can have."""
        table = tuple(np.frombuffer(self.sizes, "<f4").tolist())
        return Capability(self.phases, table or self.amplitudes, self.rate, self.watchdog)


NO_DEVICE = DeviceStatus(0, 0, "", 0, 0, 0.0, None, -float("inf"), sounding=False)


class BusStatus(Struct, frozen=True, array_like=True):
    """The status of the bus. clients: by session key in hex: objects, commands, errors, dropped, age of the newest [s].

    port: where the bus listens; 0 until it does. waiting: number of changes that the renderer has not taken yet.
    """

    heartbeat: float
    clients: dict[str, tuple[int, int, int, int, float]] = {}
    received: int = 0
    superseded: int = 0
    refused: int = 0
    waiting: int = 0
    port: int = 0


def pack(value: Struct) -> bytes:
    """Return a message as bytes."""
    return msgspec.msgpack.encode(value)
