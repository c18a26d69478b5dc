"""The console on standard output, for people: colours in a terminal only, and none if NO_COLOR is set."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

UNSEEN_WIDTH = 160  # width of lines that no terminal shows, unless COLUMNS is set [characters]


def make_console() -> Console:
    """Return a console. In a pipe or file, lines are as wide as COLUMNS says, or wide enough for whole sentences."""
    from rich.console import Console

    console = Console(highlight=False)
    if console.is_terminal or os.environ.get("COLUMNS", "").isdigit():
        return console
    return Console(highlight=False, width=UNSEEN_WIDTH)
