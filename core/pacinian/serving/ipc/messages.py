"""What the server's own processes tell each other, each through one `SharedRegister` in the server's private folder.

    file      writer    readers            value
    permit    control   guard, render      Permit
    sessions  control   bus                Sessions
    orders    control   render, guard      Orders
    changes   bus       render             Changes, only when the one before has been taken
    taken     render    bus                Taken
    frame     render    guard, control     FrameHead, then the levels
    report    render    control, bus       Report
    device    guard     control, render    Device
    traffic   bus       control            Traffic

All are MessagePack arrays but the two that are read each tick, which are packed (`struct`). All times are of
`time.perf_counter`, which is the same in all processes of one machine.
"""

from __future__ import annotations

import struct
import zlib
from typing import Any, NamedTuple

import msgspec
import numpy as np
from msgspec import Struct

from pacinian.errors import ArgumentError
from pacinian.plugins.backend import Capability
from pacinian.scene.file import Choice as Configured
from pacinian.serving.ipc.scheduling import ANY
from pacinian.wire.control import Choice
from pacinian.wire.replies import Plugin
from pacinian.wire.time import Technique

CAPACITIES = {  # [bytes]; of `frame` it depends on the array: see `compute_frame_capacity`
    "permit": 64,
    "sessions": 1 << 20,
    "orders": 1 << 18,
    "changes": 4 << 20,
    "taken": 64,
    "report": 2 << 20,
    "device": 1 << 19,
    "traffic": 1 << 20,
}
MAX_ROWS = 64  # of a frame
HEAD = 72  # [bytes] before its levels


def compute_frame_capacity(transducers: int) -> int:
    """Of the file `frame` [bytes]."""
    return HEAD + 4 * MAX_ROWS * transducers


class Permit(NamedTuple):
    """Whether there may be sound.

    until: when it ends, by itself [s]. epoch: counts how often it was given:
    only frames of the same epoch are let through. stopped: an emergency stop, or the end, holds. scene: number of
    the one that may be felt.
    """

    armed: int = 0
    until: float = 0.0
    epoch: int = 0
    stopped: int = 0
    scene: int = 0

    def pack(self) -> bytes:
        """As bytes."""
        return _PERMIT.pack(*self)

    @classmethod
    def unpack(cls, data: bytes) -> Permit:
        """From bytes."""
        return cls(*_PERMIT.unpack(data))


_PERMIT = struct.Struct("<qdqqq")


def number_scene(name: str) -> int:
    """Of a scene: the same in all processes; 0 for none."""
    return zlib.crc32(name.encode()) if name else 0


class FrameHead(NamedTuple):
    """What goes before a frame's levels: phase, then amplitude, each (rows, columns) little-endian uint16.

    sequence, time: as of `pacinian.Frame`. epoch: the permit's. device: the generation of the device that it is
    for. rows: 0 for silence. input: sequence number of the newest hands in it; sent: by the client's clock;
    received: by ours [s].
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

    def pack(self) -> bytes:
        """As bytes."""
        return _FRAME.pack(*self)

    @classmethod
    def unpack(cls, data: bytes) -> FrameHead:
        """From bytes, which go on after it."""
        return cls(*_FRAME.unpack_from(data))


_FRAME = struct.Struct("<qdqqqqqdd")


class SessionInfo(Struct, frozen=True, array_like=True):
    """A client that may send commands. user: as authenticated."""

    key: bytes
    name: str
    scene: str
    user: str


class SessionTable(Struct, frozen=True, array_like=True):
    """Who may send commands, and whose scene is felt: "" for none's."""

    sessions: tuple[SessionInfo, ...] = ()
    owned: str = ""


class RequestedSettings(Struct, frozen=True, array_like=True):
    """What was selected last, numbered so that each is done once; done or failed, it stands in `results`.

    solver, backend: None before any was selected. technique, intensity: of now. reset, reopen: counts.
    """

    solver: tuple[int, Choice | None] = (0, None)
    backend: tuple[int, Choice | None] = (0, None)
    technique: tuple[int, Technique | None] = (0, None)
    intensity: tuple[int, float] = (0, 1.0)
    reset: int = 0


class Change(Struct, frozen=True, array_like=True, tag=True):
    """One change of the scene that is felt."""


class ResetScene(Change, frozen=True):
    """All that was there is gone; what follows is of another scene, or of the same again: its number."""

    scene: int = 0


class PutObject(Change, frozen=True):
    """An object of `pacinian.scene`, encoded; default: it has no technique of its own."""

    name: str
    item: bytes
    default: bool


class MoveObject(Change, frozen=True):
    """A new pose: position [m], rotation; velocities or None; seen at `time` [s]."""

    name: str
    position: tuple[float, float, float]
    rotation: tuple[float, float, float, float]
    velocity: tuple[float, float, float] | None
    angular_velocity: tuple[float, float, float] | None
    time: float


class SetEnvelope(Change, frozen=True):
    """A new envelope for an object, encoded."""

    name: str
    envelope: bytes


class RemoveObject(Change, frozen=True):
    """An object is gone."""

    name: str


class HandInfo(Struct, frozen=True, array_like=True):
    """A hand: float32 as on the wire; name: unique among all clients'."""

    side: str
    name: str
    joints: bytes
    radii: bytes
    velocities: bytes
    time: float


class SetHands(Change, frozen=True):
    """All hands of all clients of the scene. felt: whether any client tracks hands at all: if not, whole.

    input, sent, received: of the newest of them, as in `FrameHead`.
    """

    hands: tuple[HandInfo, ...]
    felt: bool
    input: int
    sent: float
    received: float


class SetQuiet(Change, frozen=True):
    """All quiet zones: position [m], most sound pressure [Pa], radius [m] of each."""

    zones: tuple[tuple[tuple[float, float, float], float, float], ...] = ()


AnyChange = ResetScene | PutObject | MoveObject | SetEnvelope | RemoveObject | SetHands | SetQuiet


class Changes(Struct, frozen=True, array_like=True):
    """Changes in order. number: counts up; the bus starts again from 1 when it does."""

    number: int
    run: int
    """Random: tells a bus that was started anew from the one before."""
    changes: tuple[AnyChange, ...]


class ChangesAck(Struct, frozen=True, array_like=True):
    """Which changes the renderer has taken last. run: the renderer's own, random: another one wants all again."""

    number: int
    run: int
    bus: int


class RendererStatus(Struct, frozen=True, array_like=True):
    """How the renderer is.

    run: random. state: fields of `pacinian.wire.state.State`. results: of orders, by
    "kind number": "" for done, or why not. halted: the fault that holds it silent, or "". refused: names of objects
    that could not be put, and why.
    """

    run: int
    beat: float
    state: dict[str, Any]
    results: dict[str, str] = {}
    halted: str = ""
    refused: dict[str, str] = {}
    solvers: tuple[Plugin, ...] = ()
    """That can be selected."""


class DeviceStatus(Struct, frozen=True, array_like=True):
    """How the device is.

    generation: counts devices; frames must be for it. next: the one that waits to take over
    with the first frame for it, or 0. phases, amplitudes, rate: of `generation`, or of `next` if there is one.
    generation 0: there is none. beat: when the guard last went round [s]. fault: of the device, or "". frames: that it
    took. silences: how often sound was ended; reasons: by what. longest_gap: between frames since the output was armed
    last [s]. inputs: the last ones, as in `State`; inputs_until: how many there have been. results: of orders, by
    "backend number" and "reset number": "" for done, or why not. sizes: amplitude of each level, float32; empty where
    they are even. processor: that the guard keeps to, or `ANY`. choice: what `generation` is of, or, where another
    guard had it and died, what may sound still.
    """

    generation: int
    next: int
    name: str
    phases: int
    amplitudes: int
    rate: float
    watchdog: float | None
    beat: float
    sounding: bool
    fault: str = ""
    frames: int = 0
    silences: int = 0
    stale: bool = False
    longest_gap: float = 0.0
    inputs: bytes = b""
    inputs_until: int = 0
    results: dict[str, str] = {}
    backends: tuple[Plugin, ...] = ()
    """That can be selected."""
    reasons: dict[str, int] = {}
    sizes: bytes = b""
    processor: int = ANY
    choice: Configured | None = None

    @property
    def capability(self) -> Capability:
        """What it can do. Raises ArgumentError for what no device can."""
        table = tuple(np.frombuffer(self.sizes, "<f4").tolist())
        return Capability(self.phases, table or self.amplitudes, self.rate, self.watchdog)


class BusStatus(Struct, frozen=True, array_like=True):
    """How the bus is. clients: by session key in hex: objects, commands, errors, dropped, newest age [s].

    port: where it listens; 0 until it does. waiting: what the renderer does not know yet.
    """

    run: int
    beat: float
    clients: dict[str, tuple[int, int, int, int, float]] = {}
    received: int = 0
    superseded: int = 0
    refused: int = 0
    waiting: int = 0
    port: int = 0


def pack(value: Struct) -> bytes:
    """As bytes."""
    return msgspec.msgpack.encode(value)


def check_rate(device: float, loop: float) -> None:
    """Refuse a device of that rate for a loop of that rate [Hz]. Raises ArgumentError."""
    if not 1.0 - 1e-9 <= device / loop < MAX_ROWS + 0.5:
        raise ArgumentError(
            "backend",
            f"must have 1 to {MAX_ROWS} frames a tick: {device:g} Hz does not fit a loop of {loop:g} Hz",
        )
