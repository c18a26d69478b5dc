"""Opens a page in the user's browser without showing its address to others on the machine."""

from __future__ import annotations

import html
import os
import sys
import tempfile
import webbrowser
from pathlib import Path

PAGE = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0;url={url}"><title>Pacinian</title>\n'


def open_browser(url: str) -> Path | None:
    """Open it, if there is a screen; return a file to be removed later, or None if there is none.

    The address goes through that file, which only the user can read: a program's arguments anybody can.
    """
    if sys.platform == "linux" and not any(
        os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY")
    ):
        return None
    file, name = tempfile.mkstemp(prefix="pacinian-", suffix=".html")  # made 0600
    with os.fdopen(file, "w", encoding="utf-8") as stream:
        stream.write(PAGE.format(url=html.escape(url)))
    webbrowser.open(Path(name).as_uri())
    return Path(name)
