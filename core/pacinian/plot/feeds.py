"""Reads time series from the viewer's recording of a server."""

from __future__ import annotations

from contextlib import closing, suppress
from typing import TYPE_CHECKING, NamedTuple

import msgspec
import numpy as np

from pacinian.errors import RecordingError
from pacinian.viewing.feed_file import FeedFile
from pacinian.viewing.messages import WRONG, ArrayMessage
from pacinian.wire.codec import decode_state
from pacinian.wire.state import FrameState

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Floats
    from pacinian.wire.state import State

SILENCE = 0.0, 0.0


class Watched(NamedTuple):
    """Time series, times from the start [s]. drive: time, mean and largest amplitude as shares of full drive, (F, 3).

    states: time, error (NaN without targets), median, 99th percentile and maximum of the tick durations of the last
    second [s], and the tick period [s], (S, 6).
    """

    drive: Floats
    states: Floats


def read_feed(path: Path) -> Watched:
    """Read a file; skip damaged messages. Raises RecordingError."""
    drive, states = list[tuple[float, ...]](), list[tuple[float, ...]]()
    sizes = b""
    with closing(FeedFile(path)) as recorded:
        for at, kind, data in ((e.at, e.kind, recorded.data(e)) for e in recorded.entries):
            with suppress(*WRONG):
                if kind == "array":
                    sound = msgspec.msgpack.decode(data, type=ArrayMessage).sound
                    sizes = b"" if sound is None else sound.sizes
                elif kind in ("frame", "state"):
                    message = decode_state(data)
                    if isinstance(message, FrameState):
                        drive.append((at, *_amplitudes(message, sizes)))
                    else:
                        states.append((at, *_state(message)))
    if not states:
        raise RecordingError(path, "has no state of a server")
    return Watched(np.array(drive).reshape(-1, 3), np.array(states))


def _amplitudes(frame: FrameState, sizes: bytes) -> tuple[float, float]:
    level = np.frombuffer(frame.amplitude, "<u2")
    if not level.size:
        return SILENCE
    table = np.frombuffer(sizes, "<f4") if sizes else np.linspace(0.0, 1.0, frame.amplitudes)
    amplitude = table[level]
    return float(amplitude.mean()), float(amplitude.max())


def _state(state: State) -> tuple[float, ...]:
    error = state.error if state.points and state.output == "sounding" else np.nan
    ticks = np.array(state.tick_ms) if any(state.tick_ms) else np.full(3, np.nan)  # not measured
    return error, *(1e-3 * ticks).tolist(), 1.0 / state.rate if state.rate else np.nan
