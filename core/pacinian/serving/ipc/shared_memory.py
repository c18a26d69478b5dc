"""Shared memory between processes. The newest value wins, no side waits, and any side may be killed.

One process writes, any number read. The memory is a mapped file, in RAM if the system has such a folder. The writer
puts a value in the next of several slots, then publishes its number. A reader that was overtaken while copying notices
by the slot's number or by the checksum, which includes the number. This also works on machines that reorder stores.

The sizes are `CAPACITIES` and `compute_frame_capacity` in messages.py.
"""

from __future__ import annotations

import contextlib
import mmap
import os
import shutil
import stat
import tempfile
import time
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar

from pacinian.closeable import Closeable
from pacinian.errors import ServerError
from pacinian.serving.ipc.file_lock import FileLock

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from pacinian.serving.ipc.wake_pipe import WakePipe

T = TypeVar("T")

# Prefix of the names of the shared memory's folders, and suffix of their lock files.
PREFIX, LOCK = "pacinian-memory-", ".lock"
RETRY_INTERVAL = 0.005  # interval between two tries to remove a folder [s]

MAGIC = 0x504143494E49414E
SLOTS = 4
WORD_BYTES = 8  # size of a word [bytes]; aligned words are stored and loaded atomically
HEAD_WORDS = 3  # number of words in the file's head: magic, capacity, published number
SLOT_HEAD_WORDS = 3  # number of words before each value: number, length, checksum
MAX_TRIES = 100  # largest number of tries to read a value that is being overwritten


def find_root() -> Path:
    """Return where the folders for shared memory are: in RAM, or among the temporary files."""
    return Path("/dev/shm" if os.access("/dev/shm", os.W_OK) else tempfile.gettempdir())


@contextlib.contextmanager
def open_folder() -> Generator[Path]:
    """Make a private folder for shared memory; remove it at the end.

    Also removes the folders that killed processes left. A lock file lies beside the new folder, made before it and
    removed after it. This process holds the lock while it lives.
    """
    root = find_root()
    for left in root.glob(f"{PREFIX}*{LOCK}"):
        remove(left.with_suffix(""))
    made = root / f"{PREFIX}{os.urandom(8).hex()}"
    with FileLock(made.with_suffix(LOCK)) as lock:
        made.mkdir(mode=0o700)
        try:
            yield made
        finally:
            _remove_folder(made, lock)


def remove(left: Path, patience: float = 0.0) -> None:
    """Remove a shared-memory folder whose maker has gone; wait at most `patience` [s] for the maker's end."""
    lock, due = left.with_suffix(LOCK), time.monotonic() + patience
    while _is_ours(lock):
        with contextlib.suppress(ServerError), FileLock(lock) as held:
            if _is_ours(left):
                _remove_folder(left, held)
            return
        if time.monotonic() >= due:
            return
        time.sleep(RETRY_INTERVAL)


def _remove_folder(left: Path, lock: FileLock) -> None:
    """Remove a folder. If that fails, its lock's file stays, so that a later start can remove both."""
    shutil.rmtree(left, ignore_errors=True)
    lock.stays = left.exists()


def _is_ours(path: Path) -> bool:
    """Whether the path belongs to this user, and is not a link."""
    try:
        status = path.lstat()
    except OSError:
        return False
    return os.name != "posix" or (status.st_uid == os.getuid() and not stat.S_ISLNK(status.st_mode))


class SharedRegister(Closeable):
    """A value of at most `capacity` [bytes]. A context manager. One process calls `create`, the others `attach`.

    If a writer is killed in the middle of a value, readers keep the value before. A new writer that attaches continues
    the numbers. wakes: for a writer, the pipes of processes that wait for a new value; closed with the register.
    """

    def __init__(self, path: Path, mapped: mmap.mmap, wakes: Sequence[WakePipe] = ()) -> None:
        self.path, self._map, self._wakes = path, mapped, wakes
        self._words = memoryview(mapped).cast("Q")
        self.capacity = self._words[1]

    @classmethod
    def create(cls, path: Path, capacity: int, wakes: Sequence[WakePipe] = ()) -> SharedRegister:
        """Create a register for values of at most `capacity` [bytes]. Raises ServerError."""
        room = -(-max(1, capacity) // WORD_BYTES) * WORD_BYTES
        mapped = _map_file(path, os.O_CREAT | os.O_EXCL, _compute_size(room))
        with memoryview(mapped) as view, view.cast("Q") as words:
            words[1], words[0] = room, MAGIC
        return cls(path, mapped, wakes)

    @classmethod
    def attach(cls, path: Path, wakes: Sequence[WakePipe] = ()) -> SharedRegister:
        """Attach to a register that another process created. Raises ServerError."""
        mapped = _map_file(path, 0, 0)
        if len(mapped) >= WORD_BYTES * HEAD_WORDS and len(mapped) % WORD_BYTES == 0:
            with memoryview(mapped) as view, view.cast("Q") as words:
                ours = words[0] == MAGIC and len(mapped) == _compute_size(words[1])
            if ours:
                return cls(path, mapped, wakes)
        mapped.close()
        raise ServerError(f"{path}: is not shared memory of this version")

    @property
    def number(self) -> int:
        """Number of the newest value; 0 before the first."""
        return self._words[2]

    def write(self, *parts: bytes | memoryview) -> int:
        """Publish a value, given in contiguous parts; return its number. Raises ServerError if it is too long."""
        views = [view.cast("B") for view in [memoryview(part) for part in parts] if view.nbytes]
        length = sum(map(len, views))
        if length > self.capacity:
            raise ServerError(f"{self.path.name}: {length} bytes are more than {self.capacity}")
        number = self.number + 1
        word, at = self._find_place(number)
        self._words[word] = 0
        crc = number & 0xFFFFFFFF
        for view in views:
            self._map[at : at + len(view)] = view
            crc, at = zlib.crc32(view, crc), at + len(view)
        self._words[word + 1], self._words[word + 2] = length, crc
        self._words[word] = number
        self._words[2] = number
        for pipe in self._wakes:
            pipe.wake()
        return number

    def read(self, after: int = 0) -> tuple[int, bytes] | None:
        """Return the newest value and its number; None if the number is not above `after`."""
        for _ in range(MAX_TRIES):
            number = self.number
            if number <= after:
                return None
            word, at = self._find_place(number)
            length, crc = self._words[word + 1], self._words[word + 2]
            if self._words[word] == number and length <= self.capacity:
                data = self._map[at : at + length]
                whole = zlib.crc32(data, number & 0xFFFFFFFF) == crc
                if whole and self._words[word] == number:
                    return number, data
        return None

    def _find_place(self, number: int) -> tuple[int, int]:
        """Return where a value is stored: the word at which its slot begins, and the byte at which the value begins."""
        begin = WORD_BYTES * HEAD_WORDS + (number % SLOTS) * (
            WORD_BYTES * SLOT_HEAD_WORDS + self.capacity
        )
        return begin // WORD_BYTES, begin + WORD_BYTES * SLOT_HEAD_WORDS

    def close(self) -> None:
        """Unmap the memory. May be called twice."""
        self._words.release()
        self._map.close()
        for pipe in self._wakes:
            pipe.close()


def _compute_size(room: int) -> int:
    return WORD_BYTES * HEAD_WORDS + SLOTS * (WORD_BYTES * SLOT_HEAD_WORDS + room)


def _map_file(path: Path, flags: int, size: int) -> mmap.mmap:
    """Map a file.

    A new file is allocated at once, so that a full disk fails here, and does not crash the process later.
    """
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
    """Reads the newest value of a register, decoding each once. value: the newest value, at first the given default."""

    def __init__(self, file: SharedRegister, decode: Callable[[bytes], T], value: T) -> None:
        self.value = value
        self._file, self._decode = file, decode
        self._number = 0

    @property
    def waiting(self) -> bool:
        """Whether there is a value that has not been read. Costs next to nothing."""
        return self._file.number != self._number

    def look(self) -> bool:
        """Read the newest value; return whether it is new. Raises what `decode` raises, once for each value."""
        if not self.waiting:
            return False
        read = self._file.read(self._number)
        if read is None:
            return False
        self._number, data = read
        self.value = self._decode(data)
        return True

    def skip(self) -> None:
        """Ignore the current value."""
        self._number = self._file.number
