"""Shared memory between processes: the newest value wins, no side waits, and any side may be killed.

One process writes, any number read. A file is mapped: in memory where the system has such a folder. A value
goes to the next of some slots and is then published by its number; a reader that was overtaken while copying sees
that by the slot's number or by the checksum, in which the number is: so also on machines that reorder stores.
"""

from __future__ import annotations

import contextlib
import mmap
import os
import secrets
import shutil
import stat
import tempfile
import time
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar

from pacinian.errors import ServerError
from pacinian.serving.ipc.file_lock import FileLock

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import TracebackType

T = TypeVar("T")

PREFIX, LOCK = "pacinian-memory-", ".lock"  # of the folders' names, of the locks beside them
LOOK = 0.005  # [s] between two tries to remove a folder

MAGIC = 0x504143494E49414E
SLOTS = 4
WORD = 8  # [bytes], aligned: stored and loaded at once
HEAD = 3  # words: magic, capacity, published number
SLOT = 3  # words before each value: number, length, checksum
TRIES = 100


@contextlib.contextmanager
def folder() -> Generator[Path]:
    """A new private folder for shared memory, removed at the end. Removes those that killed processes have left, too.

    A lock lies beside it, made before it and removed after it. This process holds it as long as it lives.
    """
    root = Path("/dev/shm" if os.access("/dev/shm", os.W_OK) else tempfile.gettempdir())
    for lock in root.glob(f"{PREFIX}*{LOCK}"):
        remove(lock.with_suffix(""))
    made = root / f"{PREFIX}{secrets.token_hex(8)}"
    with FileLock(made.with_suffix(LOCK)):
        made.mkdir(mode=0o700)
        try:
            yield made
        finally:
            shutil.rmtree(made, ignore_errors=True)


def remove(left: Path, patience: float = 0.0) -> None:
    """Remove a folder of shared memory whose maker has gone; wait for its end for so long [s]."""
    lock, due = left.with_suffix(LOCK), time.monotonic() + patience
    while _is_ours(lock):
        with contextlib.suppress(ServerError), FileLock(lock):
            if _is_ours(left):
                shutil.rmtree(left, ignore_errors=True)
            return
        if time.monotonic() >= due:
            return
        time.sleep(LOOK)


def _is_ours(path: Path) -> bool:
    """Whether it belongs to this user, and is no link."""
    try:
        status = path.lstat()
    except OSError:
        return False
    return os.name != "posix" or (status.st_uid == os.getuid() and not stat.S_ISLNK(status.st_mode))


class SharedRegister:
    """A value of at most `capacity` [bytes]; a context manager. Made by `create`, then `attach`ed to by others.

    A writer that was killed in the middle of a value has not changed what is read; a new one that attaches
    goes on with the numbers.
    """

    def __init__(self, path: Path, mapped: mmap.mmap) -> None:
        self.path, self._map = path, mapped
        self._words = memoryview(mapped).cast("Q")
        self.capacity = self._words[1]

    @classmethod
    def create(cls, path: Path, capacity: int) -> SharedRegister:
        """New, for values of at most `capacity` [bytes]. Raises ServerError."""
        room = -(-max(1, capacity) // WORD) * WORD
        mapped = _mapped(path, os.O_CREAT | os.O_EXCL, _size(room))
        with memoryview(mapped) as view, view.cast("Q") as words:
            words[1], words[0] = room, MAGIC
        return cls(path, mapped)

    @classmethod
    def attach(cls, path: Path) -> SharedRegister:
        """What another process has made. Raises ServerError."""
        mapped = _mapped(path, 0, 0)
        if len(mapped) >= WORD * HEAD and len(mapped) % WORD == 0:
            with memoryview(mapped) as view, view.cast("Q") as words:
                ours = words[0] == MAGIC and len(mapped) == _size(words[1])
            if ours:
                return cls(path, mapped)
        mapped.close()
        raise ServerError(f"{path}: is no shared memory of this version")

    @property
    def number(self) -> int:
        """Of the newest value; 0 before the first."""
        return self._words[2]

    def write(self, *parts: bytes | memoryview) -> int:
        """Publish a value, given in contiguous parts; return its number. Raises ServerError if it is too long."""
        views = [view.cast("B") for view in [memoryview(part) for part in parts] if view.nbytes]
        length = sum(map(len, views))
        if length > self.capacity:
            raise ServerError(f"{self.path.name}: {length} bytes are more than {self.capacity}")
        number = self.number + 1
        word, at = self._place(number)
        self._words[word] = 0
        crc = number & 0xFFFFFFFF
        for view in views:
            self._map[at : at + len(view)] = view
            crc, at = zlib.crc32(view, crc), at + len(view)
        self._words[word + 1], self._words[word + 2] = length, crc
        self._words[word] = number
        self._words[2] = number
        return number

    def read(self, after: int = 0) -> tuple[int, bytes] | None:
        """The newest value and its number; None if that is not above `after`."""
        for _ in range(TRIES):
            number = self.number
            if number <= after:
                return None
            word, at = self._place(number)
            length, crc = self._words[word + 1], self._words[word + 2]
            if self._words[word] == number and length <= self.capacity:
                data = self._map[at : at + length]
                whole = zlib.crc32(data, number & 0xFFFFFFFF) == crc
                if whole and self._words[word] == number:
                    return number, data
        return None

    def _place(self, number: int) -> tuple[int, int]:
        """Of a value: the word and the byte where its slot and it begin."""
        begin = WORD * HEAD + (number % SLOTS) * (WORD * SLOT + self.capacity)
        return begin // WORD, begin + WORD * SLOT

    def close(self) -> None:
        """Unmap it; may be called twice."""
        self._words.release()
        self._map.close()

    def __enter__(self) -> SharedRegister:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _size(room: int) -> int:
    return WORD * HEAD + SLOTS * (WORD * SLOT + room)


def _mapped(path: Path, flags: int, size: int) -> mmap.mmap:
    """A file in memory; of a new one all is set apart now: a full disk is found here, not by a crash later."""
    try:
        file = os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0) | flags, 0o600)
        try:
            if size:
                os.ftruncate(file, size)
                if hasattr(os, "posix_fallocate"):
                    os.posix_fallocate(file, 0, size)
            return mmap.mmap(file, 0)
        finally:
            os.close(file)
    except (OSError, ValueError) as error:
        raise ServerError(f"{path}: shared memory: {error}") from error


class RegisterReader(Generic[T]):
    """The newest value of a file, decoded once. decode: of its bytes. value: what holds until there is one."""

    def __init__(self, file: SharedRegister, decode: Callable[[bytes], T], value: T) -> None:
        self.value = value
        self._file, self._decode = file, decode
        self._number = 0

    def look(self) -> bool:
        """Whether there was something new. Raises what `decode` raises, once for each value."""
        if self._file.number == self._number:
            return False
        read = self._file.read(self._number)
        if read is None:
            return False
        self._number, data = read
        self.value = self._decode(data)
        return True

    def skip(self) -> None:
        """What is there now is old."""
        self._number = self._file.number
