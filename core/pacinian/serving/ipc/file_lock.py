"""A file lock. While it is held, its holder lives, because the system releases it however the holder ends."""

from __future__ import annotations

import os
import stat
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from pacinian.closeable import Closeable
from pacinian.errors import ServerError
from pacinian.exclusive_lock import try_lock

if TYPE_CHECKING:
    from pathlib import Path

# Flags with which the lock file is opened. If a FIFO is in its place, opening it fails or returns at once.
FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
MAX_PID_BYTES = 32
# How often the holder's process id is read, because the holder writes it only once it holds the lock, and the pause
# between two reads [s].
PID_READS, PID_READ_INTERVAL = 20, 0.01


class LockHeld(ServerError):
    """Another process holds the lock. pid: its process id; 0 if the file does not hold it."""

    def __init__(self, path: Path, pid: int) -> None:
        super().__init__(f"{path} is locked by process {pid or 'unknown'}")
        self.pid = pid


class FileLock(Closeable):
    """An exclusive lock on a file, held until `close` or the end of this process. A context manager.

    The file is readable by this user only, holds the process id if the disk has room, and is removed at the end. Raises
    LockHeld; ServerError if the file cannot be created or locked.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.stays = False
        """Whether the file is not removed at the end."""
        try:
            self._file = _open(path)
            # The last holder removed the file between our opening and our locking it.
            while not self._is_there():
                os.close(self._file)
                self._file = _open(path)
        except OSError as error:
            raise ServerError(f"{path}: cannot be locked: {error.strerror}") from error
        with suppress(OSError):  # on a full disk the lock holds all the same
            os.ftruncate(self._file, 0)
            os.write(self._file, str(os.getpid()).encode())

    def _is_there(self) -> bool:
        """Whether the path still names the locked file."""
        try:
            return os.path.samestat(os.fstat(self._file), self.path.lstat())
        except FileNotFoundError:
            return False

    def close(self) -> None:
        """Remove the file and release the lock."""
        self._remove()  # while the lock is held, the file is ours
        os.close(self._file)
        if os.name != "posix":  # Windows does not remove an open file
            self._remove()

    def _remove(self) -> None:
        if not self.stays:
            with suppress(OSError):
                self.path.unlink()


def _check_owner(path: Path, file: int) -> None:
    """Refuse what another user has put there, and could remove or hold. Raises ServerError."""
    status = os.fstat(file)
    if os.name == "posix" and not (stat.S_ISREG(status.st_mode) and status.st_uid == os.geteuid()):
        raise ServerError(
            f"{path} is not a file of this user: remove it, or choose another folder with `--connection`"
        )


def _open(path: Path) -> int:
    """Return the file, locked. Raises LockHeld, ServerError, OSError."""
    file = os.open(path, FLAGS, 0o600)
    try:
        _check_owner(path, file)
        if try_lock(file):
            return file
        raise LockHeld(path, _read_holder(file))
    except BaseException:
        os.close(file)
        raise


def _read_holder(file: int) -> int:
    """Return the process id of the holder; 0 if it has written none, as on a full disk."""
    for attempt in range(PID_READS):
        if attempt:
            time.sleep(PID_READ_INTERVAL)
        os.lseek(file, 0, os.SEEK_SET)
        content = os.read(file, MAX_PID_BYTES)
        if content.isdigit():
            return int(content)
    return 0
