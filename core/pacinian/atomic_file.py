"""Files that are replaced as a whole: whoever reads one finds the old contents or the new, never a part."""

from __future__ import annotations

import contextlib
import os
import shutil
import uuid
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path


@contextlib.contextmanager
def replace_file(path: Path) -> Generator[IO[bytes]]:
    """Open a file to write, which replaces `path` at the end of the `with` statement. Raises OSError.

    The new contents are on the disk by then. If the body raises, or the disk is full, `path` stays as it was. A pipe or
    a device, such as /dev/stdout, is written directly. Errors name `path`.
    """
    path = path.resolve()  # a link stays a link
    if path.exists() and not path.is_file():
        with path.open("wb") as file:
            yield file
        return
    beside = path.with_name(f".{uuid.uuid4().hex}.part")
    try:
        with beside.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, beside)
        beside.replace(path)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(beside)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        beside.unlink(missing_ok=True)
