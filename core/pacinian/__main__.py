"""The entry point of the command `pacinian` and of `python -m pacinian`."""

from __future__ import annotations

import contextlib
import os
import signal
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from types import FrameType


def main() -> NoReturn:
    """Run the command line.

    While it is imported, Ctrl-C ends the process at once: a KeyboardInterrupt would print a traceback, or be lost in
    a callback of an import. Later, `pacinian.cli.interrupts` handles it.
    """
    if caught := signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    from pacinian.cli.interrupts import interrupt
    from pacinian.cli.main import main as run

    if caught:
        signal.signal(signal.SIGINT, interrupt)
    run()


def _end(number: int, frame: FrameType | None) -> NoReturn:
    """End as later interrupts do: see `pacinian.cli.main.main`."""
    with contextlib.suppress(OSError):
        os.write(2, b"interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    main()
