"""A lock on a file: whoever holds it lives, as the system lets go of it however its holder ends."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from pacinian.errors import ServerError

if TYPE_CHECKING:
    from pathlib import Path

if sys.platform == "win32":
    import msvcrt

    FAR = 1 << 30  # where a byte is locked: a locked one cannot be read

    def _try_lock(file: int) -> bool:
        os.lseek(file, FAR, os.SEEK_SET)
        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        os.lseek(file, 0, os.SEEK_SET)
        return True
else:
    import fcntl

    def _try_lock(file: int) -> bool:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True


FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
MAX_PID_BYTES = 32


class LockHeld(ServerError):
    """Another process holds the lock. pid: its number; 0 where it has not said so yet."""

    def __init__(self, path: Path, pid: int) -> None:
        super().__init__(f"{path} is locked by process {pid or 'unknown'}")
        self.pid = pid


class FileLock:
    """The only lock on a file, from now until `close`, or until this process ends. A context manager.

    The file is made for this user only, tells the process's number, and is removed at the end. Raises Locked;
    ServerError where the file cannot be made or locked.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._file = _open(path)
            while (
                not self._is_there()
            ):  # its last holder has removed it between our opening and locking
                os.close(self._file)
                self._file = _open(path)
            os.ftruncate(self._file, 0)
            os.write(self._file, str(os.getpid()).encode())
        except OSError as error:
            raise ServerError(f"{path}: cannot be locked: {error.strerror}") from error

    def _is_there(self) -> bool:
        """Whether the path still names the file that is locked."""
        try:
            return os.path.samestat(os.fstat(self._file), self.path.lstat())
        except FileNotFoundError:
            return False

    def close(self) -> None:
        """Let go of it."""
        with suppress(OSError):  # while it is held: so nobody else's is removed
            self.path.unlink()
        os.close(self._file)
        if os.name != "posix":  # Windows removes no file that is open, another's neither
            with suppress(OSError):
                self.path.unlink()

    def __enter__(self) -> FileLock:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _open(path: Path) -> int:
    """The file, locked. Raises Locked, OSError."""
    file = os.open(path, FLAGS, 0o600)
    try:
        if _try_lock(file):
            return file
        told = os.read(file, MAX_PID_BYTES)
        raise LockHeld(path, int(told) if told.isdigit() else 0)
    except BaseException:
        os.close(file)
        raise
