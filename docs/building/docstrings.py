"""Convert docstrings for Sphinx: arguments written as `name: meaning [unit], shape` become a list."""

from __future__ import annotations

import inspect
import re
from contextlib import suppress
from typing import Any

CODE = re.compile(r"(`[^`]*`)")
SPECIAL = re.compile(r"([\\*|]|_(?=\W|$))")


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("autodoc-process-docstring", process)
    return {"parallel_read_safe": True}


def process(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Rewrite `lines` in place. Drop the docstrings of modules: they are for readers of the source."""
    if what == "module":
        lines.clear()
    known = find_arguments(thing)
    made: list[str] = []
    for paragraph in "\n".join(lines).split("\n\n"):
        text = " ".join(line.strip() for line in paragraph.splitlines())
        made += [*format_paragraph(text, known), ""]
    lines[:] = made


def find_arguments(thing: Any) -> set[str]:
    """Return the names that a docstring may explain: a function's arguments, a class's fields."""
    names: set[str] = set()
    if inspect.isclass(thing):
        for base in thing.__mro__:
            names |= set(inspect.get_annotations(base))
    with suppress(TypeError, ValueError):
        names |= set(inspect.signature(thing).parameters)
    return names


def format_paragraph(text: str, known: set[str]) -> list[str]:
    """Escape a paragraph. From the first `name: ` or `name, other: ` of an argument on, make a list of it."""
    if not known:
        return [escape(text)]
    one = "|".join(sorted(map(re.escape, known), key=len, reverse=True))
    starts = list(re.finditer(rf"(?:^|(?<=[.;] ))((?:{one})(?:, (?:{one}))*): ", text))
    if not starts:
        return [escape(text)]
    made = [escape(text[: starts[0].start()]), ""] if starts[0].start() else []
    ends = [*(found.start() for found in starts[1:]), len(text)]
    for found, end in zip(starts, ends, strict=True):
        said = text[found.end() : end].strip()
        said, raises, rest = said.partition(" Raises ")
        names = ", ".join(f"``{name}``" for name in found[1].split(", "))
        made.append(f"- {names}: {escape(said)}")
        if raises:
            made += ["", escape(f"Raises {rest}")]
    return made


def escape(text: str) -> str:
    """Convert text to reStructuredText: single backquotes mark code, and everything else is plain text."""
    parts = CODE.split(text)
    parts[::2] = [SPECIAL.sub(r"\\\1", part) for part in parts[::2]]
    parts[1::2] = [f"`{part}`" for part in parts[1::2]]
    return "".join(parts)
