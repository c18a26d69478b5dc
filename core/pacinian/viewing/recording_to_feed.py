"""Converts a recording of `pacinian render --record` to a feed: the contents of 30 ticks per second.

The recording contains no samples. They are computed by rendering all ticks again.
"""

from __future__ import annotations

import itertools
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import msgspec
from msgspec import Raw
from msgspec.structs import replace

from pacinian.errors import PacinianError
from pacinian.rendering.rerender import iterate_rerendered
from pacinian.serving.control.state_builder import describe_sound
from pacinian.serving.render import renderer_status
from pacinian.viewing.messages import ArrayMessage, encode_message
from pacinian.viewing.recording_tick_stats import TickStats
from pacinian.viewing.scene_mirror import SceneMirror
from pacinian.wire.binary_arrays import pack
from pacinian.wire.convert import to_wire
from pacinian.wire.replies import Plugin
from pacinian.wire.state import FrameState, State

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.rendering.recording import Recording, Tick
    from pacinian.rendering.renderer import Renderer
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.objects import Object
    from pacinian.scene.scene import Scene

TICK_INTERVAL = 1.0 / 30.0  # interval between two converted ticks [s]


def convert_recording(
    recording: Recording, *, samples: bool = False
) -> Iterator[tuple[float, str, bytes]]:
    """Yield time [s], kind and message. samples: include them, by rendering again. Raises RecordingError."""
    yield 0.0, "array", encode_message(_array(recording))
    stage, begin, due, past = FeedState(), None, 0.0, TickStats(1.0 / recording.tick_rate)
    numbers = itertools.count()
    made = (
        iterate_rerendered(recording) if samples else ((tick, None) for tick in recording.ticks())
    )
    for tick, renderer in made:
        past.add(tick, renderer)
        begin = tick.frame.time if begin is None else begin
        at = tick.frame.time - begin
        if at < due:
            continue
        due = at + TICK_INTERVAL
        encode = msgspec.msgpack.encode
        yield at, "frame", encode(_frame(recording, tick, next(numbers), renderer))
        yield at, "state", encode(_state(recording, tick, past, renderer))
        yield at, "histogram", encode_message(past.histogram)
        if (news := stage.show(tick)) is not None:
            yield at, *news


class FeedState:
    """Tracks the objects of the scenes. Each object is sent once, and again when its shape or modulation changes."""

    def __init__(self) -> None:
        self._scenery = SceneMirror()
        self._known: dict[str, tuple[object, ...]] = {}

    def show(self, tick: Tick) -> tuple[str, bytes] | None:
        """Return what is new in a tick's scene, as kind and message; None if nothing is."""
        if tick.asked is None:
            return None
        new: dict[str, Raw] = {}
        poses: dict[str, bytes] = {}
        for name, item in _iterate_objects(tick.asked.scene):
            shape = getattr(item, "shape", getattr(item, "positions", None))
            now = type(item), shape, item.envelope, item.technique
            before = self._known.get(name, ())
            if len(before) != len(now) or any(a is not b for a, b in zip(now, before, strict=True)):
                self._known[name] = now
                # a shape that no message can hold, such as a function, is left out
                with suppress(PacinianError):
                    new[name] = Raw(msgspec.msgpack.encode(to_wire(item)))
            pose = item.pose if item.motion is None else item.motion.pose(item.pose, tick.time)
            poses[name] = pack([*pose.position, *pose.rotation])
        since, scenery = self._scenery.version, self._scenery.with_("", new, poses)
        if scenery is self._scenery:
            return None
        self._scenery = scenery
        return scenery.encode(since)


def _iterate_objects(scene: Scene) -> Iterator[tuple[str, Object]]:
    for i, item in enumerate(scene.objects):
        yield item.name or f"object {i + 1}", item


def _array(recording: Recording) -> ArrayMessage:
    settings, can, medium = recording.settings, recording.capability, recording.medium
    array = recording.array  # raises RecordingError if the transducers are damaged
    kind: dict[str, Any] = settings["transducer"]
    sound = None
    if isinstance(kind["directivity"], str):  # others have no name on the wire
        sizes = b"" if can.uniform else pack(can.sizes)
        sound = replace(describe_sound(array, medium), sizes=sizes)
    return ArrayMessage(
        server=f"recording {recording.path.name}",
        positions=pack(recording.positions),
        normals=pack(recording.normals),
        frequency=kind["frequency"],
        wavelength=medium.wavelength(kind["frequency"]),
        phases=can.phases,
        amplitudes=len(can.sizes),
        device_rate=can.rate,
        rate=recording.tick_rate,
        limits={},
        solvers=(),
        backends=(Plugin(name="recorded"),),
        techniques=(),
        presets=(),
        fields=sound is not None,
        sound=sound,
    )


def _frame(recording: Recording, tick: Tick, number: int, renderer: Renderer | None) -> FrameState:
    """Return one row of the tick's frame; `number` selects the rows in turn, as a server does."""
    frame, can = tick.frame, recording.capability
    row = number % len(frame.phase)
    phase, amplitude = frame.phase[row], frame.amplitude[row]
    loud = bool(amplitude.any())
    part, parts = (0, 0) if renderer is None else renderer.modulator.place_in_cycle
    return FrameState(
        sequence=frame.sequence,
        time=frame.time,
        phases=can.phases,
        amplitudes=len(can.sizes),
        phase=phase.astype("<u2").tobytes() if loud else b"",
        amplitude=amplitude.astype("<u2").tobytes() if loud else b"",
        part=(part + row) % max(parts, 1),
        parts=parts,
        scene_time=tick.time + row / len(frame.phase) / recording.tick_rate,
    )


def _state(recording: Recording, tick: Tick, past: TickStats, renderer: Renderer | None) -> State:
    """Return the state, from the recording and, if there is one, from the renderer."""
    asked = tick.asked
    hands = [] if asked is None else [_joints(hand) for hand in asked.scene.hands]
    fields: dict[str, Any] = {
        "solver": "" if asked is None else asked.solver.name,
        "objects": ()
        if asked is None
        else tuple(name for name, _ in _iterate_objects(asked.scene)),
        "hands": b"".join(hands),
        "rate": recording.tick_rate,
    }
    if renderer is not None:
        fields |= renderer_status.make_status(renderer, tick.time) | {"tick_counts": b""}
    if past.different:
        fields["faults"] = (f"{past.different} frames, rendered again, differ from what was sent",)
    fields |= {
        "ticks": past.ticks,
        "frames": past.ticks,
        "late": past.late,
        "tick_ms": past.tick_ms,
    }
    return State(
        sequence=past.ticks,
        time=tick.frame.time,
        output="sounding" if tick.frame.amplitude.any() else "silent",
        armed=True,
        owner="",
        scene="",
        backend="recorded",
        technique="",
        intensity=1.0,
        **fields,
    )


def _joints(hand: Hand) -> bytes:
    """Return a hand's joints, (26, 3) float32; empty if the hand is lost or has no joints."""
    if hand.lost or hand.joints is None:
        return b""
    return pack(hand.joints)
