"""A device that remembers all it was told, in a file that outlives its process, and can be unplugged."""

from __future__ import annotations

import mmap
import os
import struct
import time
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import TracebackType

    from numpy.typing import NDArray

FOLDER = "PACINIAN_FAULTS"  # environment: where the devices keep their files
UNPLUGGED = "unplugged"  # as long as there is such a file, all devices are gone
BLOCKED = "blocked"  # where there is such a file, a device removes it, and does not return from its next frame
BLOCK = 8.0  # [s] for so long
EVENT = np.dtype([("time", "<f8"), ("sounds", "<i8")])
ROOM = 1 << 20  # events, of which the newest stay
HEAD = 8  # [bytes]: how many there were


class Log:
    """When a device sounded: each frame that sounds, and each end of sound. A context manager."""

    def __init__(self, path: Path) -> None:
        with path.open("a+b") as file:
            size = HEAD + ROOM * EVENT.itemsize
            if file.seek(0, os.SEEK_END) < size:
                file.truncate(size)
            self._map = mmap.mmap(file.fileno(), size)

    @property
    def count(self) -> int:
        """Of events so far."""
        return int(_COUNT.unpack_from(self._map)[0])

    def write(self, sounds: bool, at: float | None = None) -> None:
        """One event, now, or at a time [s]."""
        count = self.count
        place = HEAD + count % ROOM * EVENT.itemsize
        _EVENT.pack_into(self._map, place, time.perf_counter() if at is None else at, sounds)
        _COUNT.pack_into(self._map, 0, count + 1)

    def read(self, after: int = 0) -> NDArray[np.void]:
        """Events from number `after` on, at most the newest: fields `time` [s], `sounds`."""
        count = self.count
        first = max(after, count - ROOM + 1, 0)
        ring = np.frombuffer(self._map[HEAD:], EVENT) if count - first > ROOM // 8 else None
        if ring is not None:
            return ring[np.arange(first, count) % ROOM]
        parts = [self._map[at : at + EVENT.itemsize] for at in _places(first, count)]
        return np.frombuffer(b"".join(parts), EVENT)

    def close(self) -> None:
        """Unmap it."""
        self._map.close()

    def __enter__(self) -> Log:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _places(first: int, count: int) -> Iterable[int]:
    return (HEAD + n % ROOM * EVENT.itemsize for n in range(first, count))


_COUNT, _EVENT = struct.Struct("<q"), struct.Struct("<dq")


class Probe(pc.Backend):
    """A device without a watchdog of its own: it sounds on until it is told otherwise, or opened again."""

    name: ClassVar[str] = "probe"

    def __init__(self) -> None:
        self._folder = Path(os.environ[FOLDER])
        self._log: Log | None = None
        self._sounds = True

    @property
    def capability(self) -> pc.Capability:
        """256 levels of each, 1 kHz."""
        return pc.Capability()

    def open(self, array: pc.Array) -> None:
        """Silent from now on. Raises BackendError while unplugged."""
        self._require()
        self._log = Log(self._folder / self.name)
        self._sounds = True
        self.silence()

    def send(self, frame: pc.Frame) -> None:
        """Sound, or not; or block. Raises BackendError while unplugged."""
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
        """No sound."""
        if self._sounds and self._log is not None:
            self._log.write(False)
            self._sounds = False

    def close(self) -> None:
        """No sound, for good."""
        self.silence()
        if self._log is not None:
            self._log.close()
            self._log = None

    def _require(self) -> None:
        if os.path.exists(self._folder / UNPLUGGED):
            self.silence()  # without its drive it is silent
            raise pc.BackendError("unplugged")


class Other(Probe):
    """Another such device, to change to."""

    name: ClassVar[str] = "probe-other"


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Both."""
    return [Probe, Other]
