"""Writes and reads feed files: append-only streams of MessagePack, readable up to any point where they are cut."""

from __future__ import annotations

import time
from contextlib import suppress
from datetime import datetime
from typing import IO, TYPE_CHECKING, NamedTuple

import msgpack

from pacinian.errors import RecordingError
from pacinian.viewing.messages import Recording

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from pacinian.viewing.hub import Hub, View

FORMAT, VERSION = "pacinian feed", 1
KINDS = "array", "lost", "scenery", "poses", "histogram", "frame", "state"  # recorded kinds
MAX_TIME = 1e6  # upper bound of the times in a file [s]
MAX_MESSAGE_BYTES = 1 << 28  # maximum size of a message [bytes]
SUFFIX = ".feed"


class FeedWriter:
    """Appends messages to a new file. Raises RecordingError."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._pack = msgpack.Packer().pack
        try:
            self._file: IO[bytes] = path.open("xb")
        except OSError as error:
            raise RecordingError(path, f"cannot be written: {error.strerror}") from error
        self._write({"format": FORMAT, "version": VERSION})

    def write(self, at: float, kind: str, data: bytes) -> None:
        """Write a message that was sent `at` [s] after the beginning."""
        self._write([at, kind, data])

    def _write(self, value: object) -> None:
        try:
            self._file.write(self._pack(value) or b"")
        except (OSError, ValueError) as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error

    def close(self) -> None:
        """Close the file. Raises RecordingError."""
        try:
            self._file.close()
        except OSError as error:
            raise RecordingError(self.path, f"cannot be written: {error.strerror}") from error


class FeedRecorder:
    """Receives the feed as a page does, and writes each recording to a new file in `folder`."""

    def __init__(self, hub: Hub, folder: Path) -> None:
        self._hub, self._folder, self._begin = hub, folder, 0.0
        self._writer: FeedWriter | None = None
        self._view: View | None = None
        hub.record = self.record

    def record(self, page: int, on: bool) -> None:
        """Start or end a recording for a page; report a failure to that page."""
        if on == (self._writer is not None):
            return
        try:
            self._open() if on else self.close()
        except RecordingError as error:
            self._hub.refuse(page, "record", str(error))

    def _open(self) -> None:
        name = f"pacinian-{datetime.now():%Y%m%d-%H%M%S-%f}{SUFFIX}"
        self._writer, self._begin = (
            FeedWriter((self._folder / name).absolute()),
            time.perf_counter(),
        )
        self._view = self._hub.join(self._write)
        self._hub.put("record", Recording(on=True, file=str(self._writer.path)))

    def _write(self) -> None:
        if self._writer is None or self._view is None:
            return
        at = time.perf_counter() - self._begin
        try:
            for kind, data in self._view.take():
                if kind in KINDS:
                    self._writer.write(at, kind, data)
        except RecordingError as error:
            with suppress(RecordingError):
                self.close()
            self._hub.refuse(0, "record", str(error), "is the disk full?")

    def close(self) -> None:
        """End the recording. Raises RecordingError if its last part cannot be written."""
        writer, self._writer = self._writer, None
        if writer is None:
            return
        if self._view is not None:
            self._hub.leave(self._view)
        self._hub.put("record", Recording(on=False, file=str(writer.path)))
        writer.close()


class Entry(NamedTuple):
    """A message in the file. at: time when it was sent [s]. place, size: offset and size of its data [bytes]."""

    at: float
    kind: str
    place: int
    size: int


class FeedFile:
    """Reads a feed file. entries: messages in order. duration: [s].

    An incomplete last message is left out. Raises RecordingError if the file is not a feed file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._file: IO[bytes] = path.open("rb")
        except OSError as error:
            raise RecordingError(path, f"cannot be read: {error.strerror}") from error
        try:
            self.entries = list(self._entries())
            if not self.entries:
                raise RecordingError(path, "is empty")
        except BaseException:
            self._file.close()
            raise
        self.duration = self.entries[-1].at

    def data(self, entry: Entry) -> bytes:
        """Read the bytes of a message. Raises RecordingError."""
        try:
            self._file.seek(entry.place)
            return self._file.read(entry.size)
        except (OSError, ValueError) as error:
            raise RecordingError(self.path, f"cannot be read: {error}") from error

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _entries(self) -> Iterator[Entry]:
        reader = msgpack.Unpacker(self._file, max_buffer_size=MAX_MESSAGE_BYTES)
        last = 0.0
        try:
            head = next(reader, None)
            if not isinstance(head, dict) or head.get("format") != FORMAT:
                raise RecordingError(self.path, "is no recording of a viewer or of a renderer")
            if head.get("version") != VERSION:
                raise RecordingError(self.path, f"has version {head['version']}: update Pacinian")
            for at, kind, data in reader:
                if not (isinstance(kind, str) and isinstance(data, bytes) and 0.0 <= at < MAX_TIME):
                    raise ValueError("a message that cannot be")
                last = max(last, float(at))
                yield Entry(last, kind, reader.tell() - len(data), len(data))
        except RecordingError:
            raise
        except Exception as error:  # damaged bytes can raise anything
            raise RecordingError(self.path, f"is damaged: {error}") from error
