"""Links from a page to what is no page: a file is put beside the pages, a folder is named."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[1]
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((\.\./[^)#\s]+)\)")


def setup(app: Any) -> dict[str, bool]:
    """Sphinx's entry point."""
    app.connect("source-read", process)
    return {"parallel_read_safe": True}


def process(app: Any, page: str, source: list[str]) -> None:
    """Rewrite links that lead out of docs."""
    here = (DOCS / page).parent

    def rewritten(found: re.Match[str]) -> str:
        title, link = found.groups()
        target = (here / link).resolve()
        if target.is_relative_to(DOCS):
            return found[0]
        if target.is_file():
            return f"{{download}}`{title} <{link}>`"
        return f"{title} (`{target.relative_to(DOCS.parent)}`)"

    source[0] = LINK.sub(rewritten, source[0])
