"""Links that lead out of the pages: to a file beside them, to a folder by name, or to the page that shows the file."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[1]
LINK = re.compile(r"(!?)\[([^\]]+)\]\(([^)#\s:]+)(#[^)\s]+)?\)")
INCLUDE = re.compile(r"```\{include\} (\S+)")
SHOWN = {
    (page.parent / shown).resolve(): page.relative_to(DOCS)
    for page in DOCS.rglob("*.md")
    for shown in INCLUDE.findall(page.read_text(encoding="utf-8"))
}


def setup(app: Any) -> dict[str, bool]:
    """Sphinx's entry point."""
    app.connect("source-read", process)
    app.connect("include-read", include)
    return {"parallel_read_safe": True}


def process(app: Any, page: str, source: list[str]) -> None:
    """Rewrite a page's links that lead out of docs."""
    folder = Path(page).parent
    source[0] = rewritten(source[0], DOCS / folder, folder)


def include(app: Any, path: Path, page: str, source: list[str]) -> None:
    """Rewrite all links of a file that a page shows."""
    file = (DOCS / path).resolve()
    source[0] = rewritten(source[0], file.parent, SHOWN[file].parent)


def rewritten(text: str, origin: Path, folder: Path) -> str:
    """The text with its links, which count from `origin`, as a page in `folder` of docs has them."""

    def link(found: re.Match[str]) -> str:
        image, title, path, anchor = found.groups()
        target = (origin / path).resolve()
        target = DOCS / SHOWN.get(target, target)
        way = Path(os.path.relpath(target, DOCS / folder)).as_posix()
        if image or target.is_relative_to(DOCS):
            return f"{image}[{title}]({way}{anchor or ''})"
        if target.is_file():
            return f"{{download}}`{title} <{way}>`"
        return f"{title} (`{target.relative_to(DOCS.parent)}`)"

    return LINK.sub(link, text)
