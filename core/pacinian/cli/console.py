"""The console on standard output, for people: colours in a terminal only, and none if NO_COLOR is set."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

UNSEEN_WIDTH = 160  # width of lines that no terminal shows [characters]


def make_console() -> Console:
    """Return a console. In a pipe or file, lines are wide, so that programs find whole sentences."""
    from rich.console import Console

    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=UNSEEN_WIDTH)
