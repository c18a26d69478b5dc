"""Play a recording on a backend."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import RecordingError
from pacinian.rendering.clock import Clock, SystemClock

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend
    from pacinian.rendering.recording import Recording


MAX_FRAME_GAP = 0.1  # gap between frames above which the device is silenced [s]
MAX_GAP = 3600.0  # gap between frames above which a recording is taken to be damaged [s]


class Replayed(NamedTuple):
    """A recording that was played. frames: number of frames. late: how many were sent after the next was due."""

    frames: int
    late: int


def replay(
    recording: Recording,
    backend: Backend,
    array: Array,
    clock: Clock | None = None,
    *,
    strict: bool = False,
) -> Replayed:
    """Send the recorded frames at their original times, then silence the device.

    The device is also silent where the renderer was silent: after a fault, and between two runs.
    Raises RecordingError if the number of transducers or the device's levels differ from those of the recording, and
    any exception of the backend. strict: raise RecordingError if the array differs in any way; the error names the
    difference.
    """
    clock = clock or SystemClock()
    can, had = backend.capability, recording.capability
    if can != replace(had, watchdog=can.watchdog):
        raise RecordingError(recording.path, f"was made for {had}, but {backend.name!r} has {can}")
    if len(array) != len(recording.positions):
        raise RecordingError(
            recording.path, f"has {len(recording.positions)} transducers, not {len(array)}"
        )
    if strict and (changes := recording.compare_array(array)):
        raise RecordingError(recording.path, f"was made for another array: {'; '.join(changes)}")
    count, late, offset, end = 0, 0, 0.0, 0.0
    backend.open(array)
    try:
        for tick in recording.ticks(frames_only=True):
            frame = tick.frame
            if not count:
                offset = clock.now() - frame.time
            elif frame.time - end > MAX_GAP:
                raise RecordingError(recording.path, f"pauses for {frame.time - end:.0f} s")
            elif tick.begins or frame.time - end > MAX_FRAME_GAP:
                clock.wait_until(min(end, frame.time) + offset)
                backend.silence()
            end = frame.time + len(frame.phase) / had.rate
            clock.wait_until(frame.time + offset)
            backend.send(frame)
            late += clock.now() > end + offset
            count += 1
    finally:
        try:
            backend.silence()
        finally:
            backend.close()
    return Replayed(count, late)
