"""The file descriptors that this process has open."""

from __future__ import annotations

import contextlib
import os


def list_file_descriptors() -> list[int]:
    """Return the open file descriptors except the standard ones. Raises OSError if the system has no list."""
    found = []
    for number in map(int, os.listdir("/dev/fd")):
        with contextlib.suppress(OSError):  # the list's own, which is closed again
            os.fstat(number)
            found.append(number)
    return [number for number in found if number > 2]
