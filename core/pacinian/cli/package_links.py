"""Makes the Markdown of a package complete: its pictures come along, and links that leave the package become text."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
PICTURES = "pictures"  # folder beside a page, for its pictures


def complete_links(files: Mapping[str, bytes], folder: Path) -> dict[str, bytes]:
    """Return the files of a package by their path, with pages whose links do not leave it, and with their pictures.

    folder: where the files are; other files that the pages link to are looked for from there.
    """
    done = dict(files)
    for path, data in files.items():
        if path.endswith(".md"):
            text, pictures = _complete_page(data.decode("utf-8"), path, folder)
            done |= {path: text.encode("utf-8"), **pictures}
    return done


def _complete_page(text: str, path: str, folder: Path) -> tuple[str, dict[str, bytes]]:
    """Return a page with other links, and the pictures that it needs, by their path in the package."""
    home, pictures = posixpath.dirname(path), dict[str, bytes]()

    def change(link: re.Match[str]) -> str:
        mark, words, target = link.groups()
        place = posixpath.normpath(posixpath.join(home, target.partition("#")[0]))
        if "://" in target or not place.startswith("../"):
            return link[0]
        if not mark:
            return f"{words} (`{_find_place(place, folder)}` in Pacinian's repository)"
        file = folder / place
        if not file.is_file():
            return f"*{words}*"
        new = f"{PICTURES}/{file.name}"
        pictures[posixpath.join(home, new)] = file.read_bytes()
        return f"![{words}]({new})"

    return LINK.sub(change, text), pictures


def _find_place(path: str, folder: Path) -> str:
    """Return the path in the repository of a file, given from the folder of a package in its `adapters`."""
    above = folder.parts[::-1].index("adapters") if "adapters" in folder.parts else 0
    base = "/".join(folder.parts[len(folder.parts) - above - 1 :]) if above else ""
    return re.sub(r"^(\.\./)+", "", posixpath.normpath(posixpath.join(base, path)))
