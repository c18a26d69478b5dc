"""A device that logs everything it receives, in a file that outlives its process. It can be unplugged."""

from __future__ import annotations

import mmap
import os
import struct
import time
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

import pacinian as pc
from pacinian.closeable import Closeable

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

FOLDER = "PACINIAN_FAULTS"  # environment variable: folder of the devices' files
UNPLUGGED = "unplugged"  # while this file exists, all devices are unplugged
BLOCKED = "blocked"  # if this file exists, a device removes it and blocks in its next frame
BLOCK = 8.0  # [s] length of the block
EVENT = np.dtype([("time", "<f8"), ("sounds", "<i8")])
MAX_EVENTS = 1 << 20  # capacity in events; the newest are kept
HEAD = 8  # [bytes] number of events


class Log(Closeable):
    """Log of when a device sounded: each frame that sounds, and each end of sound. A context manager."""

    def __init__(self, path: Path) -> None:
        with path.open("a+b") as file:
            size = HEAD + MAX_EVENTS * EVENT.itemsize
            if file.seek(0, os.SEEK_END) < size:
                file.truncate(size)
            self._map = mmap.mmap(file.fileno(), size)
        # written whole; struct would clear the bytes first
        self._count = memoryview(self._map)[:HEAD].cast("q")

    @property
    def count(self) -> int:
        """Number of events so far."""
        return int(self._count[0])

    def write(self, sounds: bool, at: float | None = None) -> None:
        """Log one event, now or at a time [s]."""
        count = self.count
        place = HEAD + count % MAX_EVENTS * EVENT.itemsize
        _EVENT.pack_into(self._map, place, time.perf_counter() if at is None else at, sounds)
        self._count[0] = count + 1

    def read(self, after: int = 0) -> NDArray[np.void]:
        """Return the events from number `after` on, as far as they are kept: fields `time` [s], `sounds`."""
        count = self.count
        first = max(after, count - MAX_EVENTS + 1, 0)
        ring = np.frombuffer(self._map[HEAD:], EVENT) if count - first > MAX_EVENTS // 8 else None
        if ring is not None:
            return ring[np.arange(first, count) % MAX_EVENTS]
        parts = [self._map[at : at + EVENT.itemsize] for at in _places(first, count)]
        return np.frombuffer(b"".join(parts), EVENT)

    def close(self) -> None:
        """Unmap the file."""
        self._count.release()
        self._map.close()


def _places(first: int, count: int) -> Iterable[int]:
    return (HEAD + n % MAX_EVENTS * EVENT.itemsize for n in range(first, count))


_EVENT = struct.Struct("<dq")


class Probe(pc.Backend):
    """A device without a watchdog: it sounds until it is silenced, or opened again."""

    name: ClassVar[str] = "probe"

    def __init__(self) -> None:
        self._folder = Path(os.environ[FOLDER])
        self._log: Log | None = None
        self._sounds = True

    @property
    def capability(self) -> pc.Capability:
        """256 levels of amplitude and phase, 1 kHz."""
        return pc.Capability()

    def open(self, array: pc.Array) -> None:
        """Open the device, silent. Raises BackendError while unplugged."""
        self._require()
        self._log = Log(self._folder / self.name)
        self._sounds = True
        self.silence()

    def send(self, frame: pc.Frame) -> None:
        """Sound or fall silent, as the frame says, or block. Raises BackendError while unplugged."""
        self._require()
        if os.path.exists(self._folder / BLOCKED):
            os.unlink(self._folder / BLOCKED)
            time.sleep(BLOCK)
        if not frame.amplitude.any():
            self.silence()
        elif self._log is not None:
            self._log.write(True)
            self._sounds = True

    def silence(self) -> None:
        """End the sound."""
        if self._sounds and self._log is not None:
            self._log.write(False)
            self._sounds = False

    def close(self) -> None:
        """End the sound and close the log."""
        self.silence()
        if self._log is not None:
            self._log.close()
            self._log = None

    def _require(self) -> None:
        if os.path.exists(self._folder / UNPLUGGED):
            self.silence()  # without its power the device is silent
            raise pc.BackendError("unplugged")


class Other(Probe):
    """A second such device, for swaps."""

    name: ClassVar[str] = "probe-other"


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return both devices."""
    return [Probe, Other]
