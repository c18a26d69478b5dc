"""The connection file: how a program on this machine finds the server, and shows that it may connect."""

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
FIX = "is `pacinian serve` running?"
MAX_BYTES = 1 << 16  # [bytes]


class Connection(Struct, frozen=True, kw_only=True):
    """What the file holds.

    pid: of the server; 0 for one on another machine. token: on loopback. server_key, public_key, secret_key: CURVE
    keys (Z85), elsewhere. stop: where the server on this machine takes an emergency stop that needs no connection.
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
        """What proves that one has read the file."""
        return self.token or self.secret_key

    def __repr__(self) -> str:
        return f"Connection(pid={self.pid}, control={self.control!r})"  # no secrets in logs

    def write(self, path: str | Path = "") -> Path:
        """Write it at once and whole, for this user only; return where. Raises ServerError."""
        path = locate_connection(path)
        try:
            path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
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
        """Remove the file, if it is still this one."""
        path = locate_connection(path)
        with suppress(ServerError, OSError):
            if _decoded(path) == self:
                path.unlink()

    @classmethod
    def read(cls, path: str | Path = "") -> Connection:
        """Read the file of a running server. Raises ServerError, with the fix."""
        path = locate_connection(path)
        made = _decoded(path)
        if made.pid and not _runs(made.pid):
            raise ServerError(
                f"{path}: the server that wrote it (process {made.pid}) has gone; {FIX}"
            )
        return made


def locate_connection(path: str | Path = "") -> Path:
    """The connection file: `path`, or as the environment variable PACINIAN_CONNECTION says, or the default."""
    if given := path or os.environ.get(VARIABLE):
        return Path(given)
    import platformdirs

    with (
        warnings.catch_warnings()
    ):  # where the system has no such folder, one in /tmp does: the file itself is safe
        warnings.simplefilter("ignore")
        return platformdirs.user_runtime_path("pacinian") / "connection.json"


def check_replaceable(path: Path) -> None:
    """Refuse to write over what no server on this machine has written. Raises ServerError."""
    try:
        text = _opened(path)[1]
    except FileNotFoundError:
        return
    if text and not _parsed(path, text).pid:
        raise ServerError(f"{path}: is of a server on another machine: choose another file")


def _decoded(path: Path) -> Connection:
    try:
        status, text = _opened(path)
    except FileNotFoundError:
        raise ServerError(f"{path}: no connection file; {FIX}") from None
    if os.name == "posix" and status.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise ServerError(
            f"{path}: others can read or change it, so its secrets are none: "
            f"`chmod 600 {path}`, then start the server again"
        )
    if os.name == "posix" and status.st_uid not in (os.getuid(), 0):
        raise ServerError(f"{path}: belongs to another user, whose server it may be")
    return _parsed(path, text)


def _opened(path: Path) -> tuple[os.stat_result, bytes]:
    """How the file is, and what is in it. Raises FileNotFoundError, ServerError."""
    try:
        with path.open("rb") as file:
            return os.fstat(file.fileno()), file.read(MAX_BYTES)
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or error
        raise ServerError(f"{path}: cannot be read: {problem}") from error


def _parsed(path: Path, text: bytes) -> Connection:
    try:
        return msgspec.json.decode(text, type=Connection)
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        raise ServerError(f"{path}: is no connection file: {error}") from error


def _runs(pid: int) -> bool:
    import psutil

    return pid > 0 and psutil.pid_exists(pid)
