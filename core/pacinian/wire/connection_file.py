"""The connection file, by which a program on this machine finds the server and authenticates itself."""

from __future__ import annotations

import os
import stat
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Literal

import msgspec
from msgspec import Struct

from pacinian.errors import ServerError

VARIABLE = "PACINIAN_CONNECTION"
START_SERVER = "is `pacinian serve` running?"
MAX_BYTES = 1 << 16  # size of the file [bytes]


class Connection(Struct, frozen=True, kw_only=True):
    """The contents of the file.

    pid: process of the server; 0 if it runs on another machine. control, command, state: addresses of the sockets.
    token: password on loopback. server_key, public_key, secret_key: CURVE keys (Z85) for other machines. stop: address
    on this machine for an emergency stop that needs no connection.
    """

    format: Literal["pacinian connection"] = "pacinian connection"
    version: Literal[1] = 1
    pid: int
    control: str
    command: str
    state: str
    token: str = ""
    server_key: str = ""
    public_key: str = ""
    secret_key: str = ""
    stop: str = ""

    @property
    def secret(self) -> str:
        """Secret that proves that a program has read the file."""
        return self.token or self.secret_key

    def __repr__(self) -> str:
        return f"Connection(pid={self.pid}, control={self.control!r})"  # no secrets in logs

    def write(self, path: str | Path = "") -> Path:
        """Write the file atomically, readable by this user only. Returns its path. Raises ServerError."""
        path = locate_connection(path)
        try:
            make_folder(path.parent)
            file, name = tempfile.mkstemp(prefix=f".{path.name}", dir=path.parent)  # made 0600
            try:
                with os.fdopen(file, "wb") as stream:
                    stream.write(msgspec.json.format(msgspec.json.encode(self)) + b"\n")
                Path(name).replace(path)
            except BaseException:
                Path(name).unlink(missing_ok=True)
                raise
        except OSError as error:
            raise ServerError(f"{path}: cannot be written: {error.strerror}") from error
        return path

    def remove(self, path: str | Path = "") -> None:
        """Remove the file, unless its contents have changed."""
        path = locate_connection(path)
        with suppress(ServerError, OSError):
            if _read_connection(path) == self:
                path.unlink()

    @classmethod
    def read(cls, path: str | Path = "", *, require_private: bool = True) -> Connection:
        """Read the file of a running server. Raises ServerError, which names the remedy.

        require_private: whether to refuse a file that others can read or change.
        """
        path = locate_connection(path)
        made = _read_connection(path, require_private)
        if made.pid and not _runs(made.pid):
            raise ServerError(
                f"{path}: the server that wrote it (process {made.pid}) has gone; {START_SERVER}"
            )
        return made


def locate_connection(path: str | Path = "") -> Path:
    """Return the path of the file: `path`, else the environment variable PACINIAN_CONNECTION, else the default.

    Raises ServerError if there is no folder for the default.
    """
    if given := path or os.environ.get(VARIABLE):
        return Path(given)
    import platformdirs

    # without a runtime folder, one in /tmp is safe enough: only this user can read the file
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return platformdirs.user_runtime_path("pacinian") / "connection.json"
        except OSError as error:  # somebody else's folder is in its place
            raise ServerError(
                f"there is no folder for the connection file ({error}): name a file with `--connection`, or in the "
                f"environment variable {VARIABLE}"
            ) from error


def make_folder(folder: Path) -> None:
    """Make a folder and its missing parents, for this user only. Raises OSError."""
    for part in reversed([part for part in (folder, *folder.parents) if not part.exists()]):
        part.mkdir(mode=0o700, exist_ok=True)
    folder.mkdir(exist_ok=True)  # says what is wrong if it is no folder


def check_replaceable(path: Path) -> None:
    """Refuse to overwrite a file that no server on this machine has written. Raises ServerError."""
    try:
        text = _read_file(path)[1]
    except FileNotFoundError:
        return
    if text and not _decode_connection(path, text).pid:
        raise ServerError(f"{path}: belongs to a server on another machine: choose another file")


def check_folder(folder: Path) -> None:
    """Refuse a folder in which other users could remove or replace the connection file. Raises ServerError."""
    if os.name != "posix":
        return
    there = folder.resolve()
    for part in (there, *there.parents):
        status = part.stat()
        advice = "who could remove the connection file: choose another one with `--connection`"
        if status.st_uid not in (os.getuid(), 0):
            raise ServerError(f"{part} belongs to another user, {advice}")
        sticky = status.st_mode & stat.S_ISVTX
        if status.st_mode & stat.S_IWOTH and not sticky:
            raise ServerError(f"{part} can be changed by every user, {advice}")
        own = os.getgid(), 0  # a user's first group is usually their own
        if status.st_mode & stat.S_IWGRP and not sticky and status.st_gid not in own:
            raise ServerError(f"{part} can be changed by a group of users, {advice}")


def _read_connection(path: Path, require_private: bool = True) -> Connection:
    try:
        status, text = _read_file(path)
    except FileNotFoundError:
        raise ServerError(f"{path}: no connection file; {START_SERVER}") from None
    if require_private and os.name == "posix" and status.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise ServerError(
            f"{path}: others can read or change it, so its keys are not secret: run `chmod 600 {path}`. "
            "If others may have read it, then start the server again, which makes new keys"
        )
    if os.name == "posix" and status.st_uid not in (os.getuid(), 0):
        raise ServerError(f"{path}: belongs to another user, whose server may not be yours")
    return _decode_connection(path, text)


def _read_file(path: Path) -> tuple[os.stat_result, bytes]:
    """Return the file's status and contents. Raises FileNotFoundError, ServerError."""
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise ServerError(f"{path}: cannot be read: it is not a file")
            return status, file.read(MAX_BYTES)
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or error
        raise ServerError(f"{path}: cannot be read: {problem}") from error


def _open_at_once(path: str, flags: int) -> int:
    """Open a file. A named pipe in its place does not wait for a writer."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _decode_connection(path: Path, text: bytes) -> Connection:
    try:
        return msgspec.json.decode(text, type=Connection)
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        raise ServerError(f"{path}: is no connection file: {error}") from error


def _runs(pid: int) -> bool:
    import psutil

    return pid > 0 and psutil.pid_exists(pid)
