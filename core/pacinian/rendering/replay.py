"""Plays a recording on a backend."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from pacinian.errors import RecordingError
from pacinian.rendering.clock import Clock, SystemClock

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend
    from pacinian.rendering.recording import Recording


PAUSE = 3600.0  # [s] between two frames that is no longer believed


def replay(recording: Recording, backend: Backend, array: Array, clock: Clock | None = None) -> int:
    """Send the recorded frames at the times they had, then silence; return how many.

    Raises RecordingError if array or levels are not those of the recording; what the backend raises.
    """
    clock = clock or SystemClock()
    can, had = backend.capability, recording.capability
    if can != replace(had, watchdog=can.watchdog):
        raise RecordingError(recording.path, f"is for {had}, and {backend.name!r} has {can}")
    if len(array) != len(recording.positions):
        raise RecordingError(
            recording.path, f"is of {len(recording.positions)} transducers, not {len(array)}"
        )
    count, offset, last = 0, 0.0, math.inf
    backend.open(array)
    try:
        for frame in recording:
            if not count:
                offset = clock.now() - frame.time
            if frame.time - last > PAUSE:
                raise RecordingError(recording.path, f"pauses for {frame.time - last:.0f} s")
            last = frame.time
            clock.wait_until(frame.time + offset)
            backend.send(frame)
            count += 1
    finally:
        try:
            backend.silence()
        finally:
            backend.close()
    return count
