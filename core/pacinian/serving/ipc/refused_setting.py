"""A setting that only another process can check: that process reports it, and the control process names it."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NoReturn

import msgspec
from msgspec import Struct

from pacinian.errors import describe_error

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

NAME = "refused_setting"  # name of the file, in the folder of the shared memory


class RefusedSetting(Struct, frozen=True):
    """A setting with which the server cannot start. key: in the configuration file, such as `solver`."""

    key: str
    problem: str


def refuse_setting(folder: Path, key: str, problem: str) -> NoReturn:
    """In a child process, report a wrong setting, and end. Raises SystemExit."""
    problem = problem.encode("utf-8", "replace").decode()  # it may name a path that is not Unicode
    try:
        (folder / NAME).write_bytes(msgspec.json.encode(RefusedSetting(key, problem)))
    except OSError:  # such as a full disk: at least standard error gets the text
        raise SystemExit(f"{key}: {problem}") from None
    raise SystemExit(1)


@contextlib.contextmanager
def blame_setting(folder: Path, key: str) -> Generator[None]:
    """In a child process, take every error in the body of the `with` statement for the fault of a setting."""
    try:
        yield
    except (Exception, SystemExit) as error:  # a plug-in can raise anything
        refuse_setting(folder, key, describe_error(error))


def take_refused_setting(folder: Path) -> RefusedSetting | None:
    """In the control process, return what a child has reported since the last call."""
    path = folder / NAME
    try:
        found = msgspec.json.decode(path.read_bytes(), type=RefusedSetting)
        path.unlink()
    except (OSError, msgspec.MsgspecError):
        return None
    return found
