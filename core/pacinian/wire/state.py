"""State: the messages that the server publishes on the topics `state` and `frame`, the first part of a message."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from pacinian.notebook import Card, card
from pacinian.skip_reasons import split_skips
from pacinian.wire.modulation import Technique
from pacinian.wire.protocol import Id, Name, Seconds, Text
from pacinian.wire.silence_cause import Silence

STATE, FRAME = b"state", b"frame"
MAX_LISTED_FAULTS = 3
PRIVATE_SCENE_PREFIX = "own "  # of the names of private scenes, which no other client may join
HAND_BYTES = 26 * 3 * 4  # size of the joints of one hand in `State.hands` [bytes]

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
"""Meanings of the values of `output`. If several apply, it is the last of them."""


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

    def describe(self) -> str:
        """Return its scene, and how much it has sent."""
        from pacinian.wire.state_wording import count

        words = ["owner"] if self.owner else []
        words += [
            _describe_scene(self.scene),
            count(self.objects, "object"),
            count(self.commands, "command"),
        ]
        words += [count(self.errors, "error")] if self.errors else []
        words += [f"{self.dropped:,} dropped"] if self.dropped else []
        words += [f"newest applied after {1e3 * self.age:.1f} ms"] if self.commands else []
        return ", ".join(words)


class TouchState(Struct, frozen=True, kw_only=True):
    """A hand that feels an object. object: its name. hand: name of the hand, or its side if it has none.

    position: mean of the samples on this hand, weighted by their pressure [m]. pressure: highest target radiation
    pressure [Pa]. strength: that pressure over the object's own, 0..1. All are computed as if every envelope were at
    its maximum.
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
    [Pa]; while the field is steered with an object, where it was solved for. index: index into `objects` of each
    sample, (M,) little-endian int32. objects: names of the rendered objects. hands: joints of the rendered hands,
    (hands, 26, 3) float32 [m]. error: relative error of the sound pressures at the samples, as emitted. felt: quality
    of each of `objects` over all touched skin or, in free air, between its samples, (objects, 4) little-endian float32:
    force over target force; rms error over rms target; share of the region with less than half of its target; highest
    radiation pressure beside the region (3 to 30 mm on skin, 3 to 5 mm in free air) over the mean target. Computed from
    the gains as emitted at the last evaluations; NaN for an object without a region; since protocol 1.1. status: status
    of the last tick. ticks: number of ticks so far. late: number of late ticks. rate: ticks per second [Hz]. tick_ms:
    median, 99th percentile and maximum of the tick times of the last second [ms]. frames: number of frames that the
    device has accepted. longest_gap: longest time between two frames while armed [s]. skipped: counts of work that was
    left out, by reason. faults: objects that could not be put, and the last faults, newest last. fault_count: number of
    all faults. restarts: number of restarts of each process of the server, by name. inputs: each hand update that
    reached the device since the last state, (K, 4) little-endian float64: sequence, client's time, and times of receipt
    and emission by the server's clock [s]. clients: clients that are connected. tick_counts: histogram of the tick
    times of the last second, (64,) little-endian uint32; bin k counts ticks of 10^(k/16 - 2) to 10^((k+1)/16 - 2) ms,
    and the first and last bins also those beyond; since protocol 1.1. cause: why the output is silent, for programs, as
    in the table below; empty if it sounds; since protocol 1.1. why: the same with what to do, for people; since
    protocol 1.1. touches: hands that feel an object, computed as if every envelope were at its maximum, so that the
    list does not flicker with the modulation; since protocol 1.1. presentation: the technique in use with its
    parameters; since protocol 1.1.
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
    presentation: Technique | None = None

    @property
    def silence(self) -> Silence | None:
        """Why the output is silent, and what to do; None if it sounds, or if the server is older than protocol 1.1."""
        return Silence(self.cause, self.why) if self.cause else None

    def describe(self) -> str:
        """Return one line on what the output emits, and for whom."""
        from pacinian.wire.state_wording import count

        if self.output != "sounding":
            return f"{self.output}: {self.silence}" if self.silence else self.output
        hands, samples = len(self.hands) // HAND_BYTES, len(self.asked) // 4
        return (
            f'sounding, armed by "{self.owner}": {count(samples, "sample")} of '
            f"{count(len(self.objects), 'object')}, {count(hands, 'hand')}, error {self.error:.2%}"
        )

    def summarise(self) -> dict[str, str]:
        """Return names and values of what a person wants to know first."""
        from pacinian.wire.felt_regions import read_felt
        from pacinian.wire.state_wording import count, list_counts, share

        hands, samples = len(self.hands) // HAND_BYTES, len(self.asked) // 4
        median, p99, longest = self.tick_ms
        rows = {"output": self.output + (", armed" if self.armed else "")}
        if self.silence is not None:
            rows["why"] = self.silence.text
        rows |= {
            "owner": f"{self.owner}, {_describe_scene(self.scene)}" if self.owner else "nobody",
            "solver, backend": f"{self.solver or 'none'}, {self.backend or 'none'}",
            "technique, intensity": f"{self.technique or 'of each object'}, {self.intensity:.0%}",
            "rendered": f"{count(samples, 'sample')} of {count(len(self.objects), 'object')}, {count(hands, 'hand')}",
        }
        if samples:
            rows["error"] = f"{self.error:.2%} of the target sound pressures, as emitted"
        felt = read_felt(self.objects, self.felt)
        rows |= {f"felt of {name}": str(region) for name, region in felt.items()}
        rows |= {
            "ticks": f"{self.ticks:,} at {self.rate:g} Hz, {share(self.late, self.ticks)} late",
            "tick time": f"median {median:.2f} ms, p99 {p99:.2f} ms, max {longest:.2f} ms",
            "frames": f"{self.frames:,}, longest gap {1e3 * self.longest_gap:.1f} ms",
            "left out": str(split_skips(self.skipped)),
        }
        if restarts := list_counts(self.restarts):
            rows["restarts"] = restarts
        if self.faults:
            rows["faults"] = f"{self.fault_count}; the last, and objects that could not be put:"
            for i, fault in enumerate(reversed(self.faults[-MAX_LISTED_FAULTS:])):
                rows[f"  {i + 1}"] = fault
        return rows | {f"client {client.name}": client.describe() for client in self.clients}

    def __repr__(self) -> str:
        return f"<State {self.sequence}: {self.describe()}>"

    @card
    def _repr_html_(self) -> Card:
        return Card(f"State {self.sequence}", self.summarise())


class FrameState(Struct, frozen=True, kw_only=True, tag_field="type", tag="frame"):
    """The emitted levels of one row of a frame, another row each time; empty in silence.

    Frames are published at irregular times, on average `state_rate` times a second, so that no modulation can be in
    step with them and look constant. sequence: increases with each message. time: reading of the server's clock [s].
    phases, amplitudes: number of levels of the device. phase, amplitude: level of each transducer, (N,) little-endian
    uint16. scene_time: time of the row in the scene, which envelopes and techniques depend on [s]; since protocol 1.1.
    part: which frame of a cycle the row is, from 0; since protocol 1.1. parts: number of frames in the cycle, which
    sound in turn; 0 if it is not known; since protocol 1.1.
    """

    sequence: int
    time: Seconds
    phases: int
    amplitudes: int
    phase: bytes
    amplitude: bytes
    scene_time: float = 0.0
    part: int = 0
    parts: int = 0

    def __repr__(self) -> str:
        row = f"a row of {len(self.phase) // 2} levels" if self.phase else "silent"
        return f"<FrameState {self.sequence}: {row}>"


def _describe_scene(scene: str) -> str:
    return "its own scene" if scene.startswith(PRIVATE_SCENE_PREFIX) else f"scene {scene}"


STATES = State, FrameState
AnyState = State | FrameState
