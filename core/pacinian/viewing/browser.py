"""Opens a page in the user's browser without showing its address to other users of the machine."""

from __future__ import annotations

import html
import os
import sys
import tempfile
import webbrowser
from pathlib import Path

PAGE = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0;url={url}"><title>Pacinian</title>\n'


def open_browser(url: str) -> Path | None:
    """Open the page if there is a display. Return a file to remove later; None if there is no display.

    The file, which only the user can read, passes the address to the browser. Anybody can read a program's arguments.
    """
    if sys.platform == "linux" and not any(
        os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY")
    ):
        return None
    file, name = tempfile.mkstemp(prefix="pacinian-", suffix=".html")  # created with mode 0600
    with os.fdopen(file, "w", encoding="utf-8") as stream:
        stream.write(PAGE.format(url=html.escape(url)))
    webbrowser.open(Path(name).as_uri())
    return Path(name)
