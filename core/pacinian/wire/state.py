"""State: the messages that the server publishes on the topics `state` and `frame`, the first part of a message."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.notebook import Card, card
from pacinian.wire.protocol import Id, Name, Seconds, Text

STATE, FRAME = b"state", b"frame"

Output = Literal[
    "silent",
    "sounding",
    "stale",
    "stopped",
    "faulted",
]
OUTPUTS: dict[Output, str] = {
    "silent": "no client has armed the output, or there is nothing to feel",
    "stale": "the renderer is late, so the output is silent until it catches up",
    "sounding": "the array emits something that can be felt",
    "stopped": "emergency stop, until `reset`",
    "faulted": "a plug-in or device failed, until `reset` has recovered it; or there is no device",
}
"""Meanings of the values of `output`, which is the last of these that applies."""


class ClientState(Struct, frozen=True, kw_only=True):
    """A client. name, scene: names from its `hello`. owner: whether it owns the output.

    objects: number of its objects. commands: number of commands so far. errors: number of errors so far. dropped:
    number of commands that were too old, or were replaced by newer ones while they waited. age: age of its newest
    command when that was applied [s]. renewed: time since its last renewal [s].
    """

    name: Name
    scene: Name
    owner: bool
    objects: int
    commands: int
    errors: int
    dropped: int
    age: float
    renewed: float


class TouchState(Struct, frozen=True, kw_only=True):
    """A hand that feels an object. object: its name. hand: name of the hand, or its side if it has none.

    position: mean of the samples on this hand, weighted by their pressure [m]. pressure: highest target radiation
    pressure [Pa]. strength: that pressure over the object's own, 0..1. All are at full envelope.
    """

    object: str
    hand: str
    position: tuple[float, float, float]
    pressure: float
    strength: float


class State(Struct, frozen=True, kw_only=True, tag_field="type", tag="state"):
    """The emitted output and the health of the server. Published, and sent as the answer to `status`.

    id: `id` of the `status` that it answers; 0 if it is published. sequence: increases with each message. time: reading
    of the server's clock [s]. output: one of the values below. armed: whether the output may sound. owner: name of the
    client that owns the output; empty if there is none. scene: name of the active scene. solver, backend: name of the
    plug-in in use. technique: technique in use. intensity: factor on all radiation pressures. points: positions of the
    samples, (M, 3) float32 [m]. normals: normals of the samples, (M, 3) float32. asked: target radiation pressure of
    each sample, (M,) float32 [Pa]. achieved: radiation pressure of each sample from the gains as emitted, (M,) float32
    [Pa]. index: index into `objects` of each sample, (M,) little-endian int32. objects: names of the rendered objects.
    hands: joints of the rendered hands, (hands, 26, 3) float32 [m]. error: relative error of the sound
    pressures at the samples, as emitted. felt: quality of each of `objects` between its samples, (objects, 4)
    little-endian float32: force over target force; rms error over rms target; share of the region with less than half
    of its target; highest radiation pressure 3 to 5 mm beside the region over the mean target. Computed from the gains
    as emitted at the last evaluations; NaN for an object without a region; since protocol 1.1. status: status of the
    last tick. ticks: number of ticks so far. late: number of late ticks. rate: ticks per second [Hz]. tick_ms: median,
    99th percentile and maximum of the tick times of the last second [ms]. frames: number of frames that the device has
    accepted. longest_gap: longest time between two frames while armed [s]. skipped: number of skipped samples by
    reason. faults: texts of the last faults, newest last. fault_count: number of all faults. restarts: number of
    restarts of each process of the server, by name. inputs: each hand update that reached the device since the last
    state, (K, 4) little-endian float64: sequence, client's time, and times of receipt and emission by the server's
    clock [s]. clients: clients that are connected. tick_counts: histogram of the tick times of the last second, (64,)
    little-endian uint32; bin k counts ticks of 10^(k/16 - 2) to 10^((k+1)/16 - 2) ms, and the first and last bins also
    those beyond; since protocol 1.1. cause: why the output is silent, for programs, as in the table below; empty if it
    sounds; since protocol 1.1. why: the same with what to do, for people; since protocol 1.1. touches: hands that feel
    an object; none while the output is silent; since protocol 1.1.
    """

    id: Id = 0
    sequence: int
    time: Seconds
    output: Output
    armed: bool
    owner: Text
    scene: Text
    solver: Text
    backend: Text
    technique: Text
    intensity: float
    points: bytes = b""
    normals: bytes = b""
    asked: bytes = b""
    achieved: bytes = b""
    index: bytes = b""
    objects: tuple[str, ...] = ()
    hands: bytes = b""
    error: float = 0.0
    felt: bytes = b""
    status: Text = ""
    ticks: int = 0
    late: int = 0
    rate: float = 0.0
    tick_ms: tuple[float, float, float] = (0.0, 0.0, 0.0)
    frames: int = 0
    longest_gap: float = 0.0
    skipped: dict[str, int] = {}
    faults: tuple[str, ...] = ()
    fault_count: int = 0
    restarts: dict[str, int] = {}
    inputs: bytes = b""
    clients: tuple[ClientState, ...] = ()
    tick_counts: bytes = b""
    cause: Text = ""
    why: Annotated[str, Meta(max_length=1000)] = ""
    touches: tuple[TouchState, ...] = ()

    def __repr__(self) -> str:
        from pacinian.wire.state_summary import describe_state

        return f"<State {self.sequence}: {describe_state(self)}>"

    @card
    def _repr_html_(self) -> Card:
        from pacinian.wire.state_summary import summarise_state

        return Card(f"State {self.sequence}", summarise_state(self))


class FrameState(Struct, frozen=True, kw_only=True, tag_field="type", tag="frame"):
    """The emitted levels of one row of a frame, another row each time; empty in silence.

    Frames are published at uneven times, `state_rate` times a second on average, so that no modulation keeps step with
    them. sequence: increases with each message. time: reading of the server's clock [s]. phases, amplitudes: number of
    levels of the device. phase, amplitude: level of each transducer, (N,) little-endian uint16.
    """

    sequence: int
    time: Seconds
    phases: int
    amplitudes: int
    phase: bytes
    amplitude: bytes

    def __repr__(self) -> str:
        row = f"a row of {len(self.phase) // 2} levels" if self.phase else "silent"
        return f"<FrameState {self.sequence}: {row}>"


STATES = State, FrameState
AnyState = State | FrameState
