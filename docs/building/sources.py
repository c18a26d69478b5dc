"""Rewrite links that leave docs: to the page that includes the file, to a download, or to a path as plain text."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[1]
LINK = re.compile(r"(!?)\[([^\]]+)\]\(([^)#\s:]+)(#[^)\s]+)?\)")
INCLUDE = re.compile(r"```\{include\} (\S+)")
INCLUDED_BY = {
    (page.parent / file).resolve(): page.relative_to(DOCS)
    for page in DOCS.rglob("*.md")
    for file in INCLUDE.findall(page.read_text(encoding="utf-8"))
}


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", process)
    app.connect("include-read", include)
    return {"parallel_read_safe": True}


def process(app: Any, page: str, source: list[str]) -> None:
    """Rewrite the links of a page that leave docs."""
    folder = Path(page).parent
    source[0] = rewrite_links(source[0], DOCS / folder, folder)


def include(app: Any, path: Path, page: str, source: list[str]) -> None:
    """Rewrite all links of a file that a page includes."""
    file = (DOCS / path).resolve()
    source[0] = rewrite_links(source[0], file.parent, INCLUDED_BY[file].parent)


def rewrite_links(text: str, origin: Path, folder: Path) -> str:
    """Return the text with its links, which are relative to `origin`, rewritten for a page in `folder` of docs."""

    def link(found: re.Match[str]) -> str:
        image, title, path, anchor = found.groups()
        target = (origin / path).resolve()
        target = DOCS / INCLUDED_BY.get(target, target)
        way = Path(os.path.relpath(target, DOCS / folder)).as_posix()
        if image or target.is_relative_to(DOCS):
            return f"{image}[{title}]({way}{anchor or ''})"
        if target.is_file():
            return f"{{download}}`{title} <{way}>`"
        name = target.relative_to(DOCS.parent).as_posix()
        return title if title.strip("`") == name else f"{title} (`{name}`)"

    return LINK.sub(link, text)
