"""Find each part of a text that the page replaces in the sources of server and viewer: reworded, it would be lost."""

from __future__ import annotations

import ast
import re
from functools import cache

import pytest

from .browser import ROOT

SOURCES = "serving", "viewing", "wire"
PANELS = ROOT / "viewer/src/panels"
PAIR = re.compile(r'\[\s*"([^"]+)",\s*"[^"]+",?\s*\]')


def _read_parts(file: str, table: str) -> list[str]:
    """Return the first text of each pair of a table of the page."""
    source = (PANELS / file).read_text(encoding="utf-8")
    begin = source.index(f"const {table}: [string, string][] = [")
    parts = PAIR.findall(source[begin : source.index("\n];", begin)])
    assert len(parts) > 3
    return [str(part) for part in parts]


@cache
def _read_texts() -> tuple[str, ...]:
    """Return all string literals of the sources but docstrings."""
    found: list[str] = []
    for folder in SOURCES:
        for path in (ROOT / "core/pacinian" / folder).rglob("*.py"):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
            found += [
                node.value
                for node in ast.walk(tree)
                if isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and id(node) not in docs
            ]
    return tuple(found)


@pytest.mark.parametrize(
    ("file", "table"), [("advice.ts", "BY_MESSAGE"), ("silence.ts", "PAGE_WORDS")]
)
def test_the_page_replaces_only_what_server_or_viewer_says(file: str, table: str) -> None:
    lost = [
        part for part in _read_parts(file, table) if not any(part in text for text in _read_texts())
    ]
    assert not lost
