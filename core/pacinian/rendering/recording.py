"""Recordings: the frames that were emitted, in a file that survives an interruption.

A stream of MessagePack maps: one header, then one map per frame. It is only ever appended to, so a
file that was cut off is whole up to its last complete frame.
"""

from __future__ import annotations

from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import msgpack
import numpy as np

from pacinian.errors import RecordingError
from pacinian.plugins.backend import Capability, Frame

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.acoustics.array import Array
    from pacinian.types import Floats

FORMAT = "pacinian recording"
VERSION = 1
LARGEST = 1 << 26  # [bytes] one map
LATEST = 1e9  # [s]


class Recorder:
    """Writes a recording. Raises RecordingError if the file cannot be made."""

    def __init__(self, path: str | Path, array: Array, capability: Capability) -> None:
        self.path = Path(path)
        try:
            self._file: IO[bytes] = self.path.open("wb")
        except (OSError, ValueError) as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error
        self._pack = msgpack.Packer(use_single_float=False).pack
        self._write(
            {
                "format": FORMAT,
                "version": VERSION,
                "positions": array.positions.astype("<f8").tobytes(),
                "normals": array.normals.astype("<f8").tobytes(),
                "phases": capability.phases,
                "amplitudes": capability.amplitudes,
                "rate": capability.rate,
            }
        )

    def write(self, frame: Frame) -> None:
        """Append a frame."""
        self._write(
            {
                "sequence": frame.sequence,
                "time": frame.time,
                "phase": frame.phase.astype("<u2", copy=False).tobytes(),
                "amplitude": frame.amplitude.astype("<u2", copy=False).tobytes(),
            }
        )

    def close(self) -> None:
        """End the file; may be called twice."""
        try:
            self._file.close()
        except OSError as error:
            raise RecordingError(self.path, f"cannot be written: {error.strerror}") from error

    def _write(self, values: dict[str, Any]) -> None:
        try:
            self._file.write(self._pack(values))
        except OSError as error:
            raise RecordingError(self.path, f"cannot be written: {error.strerror}") from error


class Recording:
    """A recording to read: the array's layout, the device's capability, and the frames.

    Raises RecordingError if the file is not one; a cut-off last frame is left out.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        header = next(self._maps(), None)
        if header is None or header.get("format") != FORMAT:
            raise RecordingError(self.path, "is not a Pacinian recording")
        if header.get("version") != VERSION:
            raise RecordingError(
                self.path, f"has version {header.get('version')}, not {VERSION}: update Pacinian"
            )
        try:
            self.positions: Floats = np.frombuffer(header["positions"], "<f8").reshape(-1, 3)
            self.normals: Floats = np.frombuffer(header["normals"], "<f8").reshape(-1, 3)
            self.capability = Capability(header["phases"], header["amplitudes"], header["rate"])
            if len(self.normals) != len(self.positions) or not len(self.positions):
                raise ValueError("positions and normals do not fit")
        except (KeyError, ValueError, TypeError) as error:
            raise RecordingError(self.path, f"has a damaged header: {error}") from error

    def __iter__(self) -> Iterator[Frame]:
        """The frames, one at a time."""
        maps = self._maps()
        next(maps)
        for values in maps:
            try:
                yield self._frame(values)
            except (KeyError, ValueError, TypeError) as error:
                raise RecordingError(self.path, f"has a damaged frame: {error}") from error

    def _frame(self, values: dict[str, Any]) -> Frame:
        N, can = len(self.positions), self.capability
        phase, amplitude = (
            np.frombuffer(values[k], "<u2").reshape(-1, N) for k in ("phase", "amplitude")
        )
        if phase.shape != amplitude.shape or not phase.size:
            raise ValueError("phases and amplitudes do not fit")
        if phase.max() >= can.phases or amplitude.max() >= can.amplitudes:
            raise ValueError("levels beyond the device's")
        time = float(values["time"])
        if not abs(time) < LATEST:
            raise ValueError(f"its time is {time} s")
        return Frame(int(values["sequence"]), time, phase, amplitude)

    def _maps(self) -> Iterator[dict[str, Any]]:
        if not self.path.is_file():
            raise RecordingError(self.path, "is not there, or not a file")
        try:
            with self.path.open("rb") as file:
                for values in msgpack.Unpacker(file, max_buffer_size=LARGEST):
                    if not isinstance(values, dict):
                        raise RecordingError(self.path, "is not a Pacinian recording")
                    yield values
        except RecordingError:
            raise
        except OSError as error:
            raise RecordingError(self.path, f"cannot be read: {error.strerror}") from error
        except (ValueError, msgpack.UnpackException) as error:
            raise RecordingError(self.path, f"is damaged: {error}") from error
