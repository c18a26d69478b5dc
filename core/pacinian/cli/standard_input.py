"""The end of standard input, which tells a program that the process which started it has ended."""

from __future__ import annotations

import contextlib
import os
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

BLOCK = 4096  # [bytes]


def call_at_end_of_input(action: Callable[[], object], file: int = 0) -> None:
    """Call `action` in a thread when standard input, or another open file, ends; at once if it is closed."""

    def wait() -> None:
        with contextlib.suppress(OSError):
            while os.read(file, BLOCK):
                pass
        action()

    threading.Thread(target=wait, name="standard input", daemon=True).start()
