"""State: what the server publishes, on the topics `state` and `frame`; the topic is the first part of a message."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

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
    "silent": "nobody has armed it, or there is nothing to feel",
    "stale": "the renderer is late: silent until it goes on",
    "sounding": "something can be felt",
    "stopped": "emergency stop, until `reset`",
    "faulted": "a plug-in or device failed, until `reset` has mended it; or there is no device",
}
"""What is said of the output: the last of these that is true."""


class ClientState(Struct, frozen=True, kw_only=True):
    """A client. name, scene: as in its `hello`. owner: whether the output is its own.

    objects: that it has. commands, errors, dropped: how many so far; dropped were too old, or replaced while they
    waited. age: of its newest command when it was applied [s]. renewed: since its last renewal [s].
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


class State(Struct, frozen=True, kw_only=True, tag_field="type", tag="state"):
    """What is emitted, and how the server is: published, and the answer to `status`.

    id: of the `status` that it answers; 0 where it is published. sequence: counts up. time: of the server's clock
    [s]. output: as in the table below. armed: whether it may sound. owner: name of the client that owns the output,
    or empty. scene: that is felt. solver, backend, technique: in use. intensity: factor on all radiation pressures.
    points: where samples are, (M, 3) float32 [m]. normals: (M, 3) float32. asked, achieved: radiation pressure, (M,)
    float32 [Pa]; achieved by the gains as emitted. index: which of `objects` each sample is of, (M,) little-endian
    int32. objects: names. hands: joints of the hands as they are rendered, (hands, 26, 3) float32 [m]. error: of the
    sound pressures at the samples, as emitted. felt: of each of `objects` between its samples, (objects, 4)
    little-endian float32: force over what was asked, rms of the difference over that of what was asked, share with
    less than half, highest radiation pressure 3 to 5 mm beside it over the mean asked; as emitted, of the last looks;
    NaN without a region; since protocol 1.1. status: of the last tick. ticks: so far. late: of these. rate: ticks per
    second [Hz]. tick_ms: median, 99 % and maximum of the last second [ms]. frames: that the device took. longest_gap:
    between two frames while armed [s]. skipped: samples by reason. faults: the last ones, newest last. fault_count: of
    all. restarts: of the server's processes, by name. inputs: of each hand update that reached the device since the
    last state, (K, 4) little-endian float64: sequence, the client's time, when it was received and when it was
    emitted, by the server's clock [s]. clients: that are there.
    tick_counts: how many ticks of the last second took 10^(k/16 - 2) to 10^((k+1)/16 - 2) ms, (64,) little-endian
    uint32; the first and last count what is beyond, too; since protocol 1.1.
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


class FrameState(Struct, frozen=True, kw_only=True, tag_field="type", tag="frame"):
    """The levels that are emitted: of one row of a frame, another one each time; empty in silence.

    Frames are published at uneven times, `state_rate` times a second on average, so that no modulation keeps step with
    them. sequence: counts up. time: of the server's clock [s]. phases, amplitudes: levels that the device has. phase,
    amplitude: of each transducer, (N,) little-endian uint16.
    """

    sequence: int
    time: Seconds
    phases: int
    amplitudes: int
    phase: bytes
    amplitude: bytes


STATES = State, FrameState
AnyState = State | FrameState
