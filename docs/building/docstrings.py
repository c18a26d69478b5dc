"""Docstrings as they are written here, `name: what it is [unit], shape`, for Sphinx: arguments become a list."""

from __future__ import annotations

import inspect
import re
from contextlib import suppress
from typing import Any

CODE = re.compile(r"(`[^`]*`)")
SPECIAL = re.compile(r"([\\*|]|_(?=\W|$))")


def setup(app: Any) -> dict[str, bool]:
    """Sphinx's entry point."""
    app.connect("autodoc-process-docstring", process)
    return {"parallel_read_safe": True}


def process(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Rewrite `lines` in place; a module's are for who reads the source, and its page says the rest."""
    if what == "module":
        lines.clear()
    known = arguments(thing)
    made: list[str] = []
    for paragraph in "\n".join(lines).split("\n\n"):
        text = " ".join(line.strip() for line in paragraph.splitlines())
        made += [*listed(text, known), ""]
    lines[:] = made


def arguments(thing: Any) -> set[str]:
    """Names that a docstring explains: a function's arguments, a class's fields."""
    names: set[str] = set()
    if inspect.isclass(thing):
        for base in thing.__mro__:
            names |= set(inspect.get_annotations(base))
    with suppress(TypeError, ValueError):
        names |= set(inspect.signature(thing).parameters)
    return names


def listed(text: str, known: set[str]) -> list[str]:
    """A paragraph; from the first `name: ` or `name, other: ` on that explains arguments, a list of them."""
    if not known:
        return [safe(text)]
    one = "|".join(sorted(map(re.escape, known), key=len, reverse=True))
    starts = list(re.finditer(rf"(?:^|(?<=[.;] ))((?:{one})(?:, (?:{one}))*): ", text))
    if not starts:
        return [safe(text)]
    made = [safe(text[: starts[0].start()]), ""] if starts[0].start() else []
    ends = [*(found.start() for found in starts[1:]), len(text)]
    for found, end in zip(starts, ends, strict=True):
        said = text[found.end() : end].strip()
        said, raises, rest = said.partition(" Raises ")
        names = ", ".join(f"``{name}``" for name in found[1].split(", "))
        made.append(f"- {names}: {safe(said)}")
        if raises:
            made += ["", safe(f"Raises {rest}")]
    return made


def safe(text: str) -> str:
    """Text as reStructuredText: single backquotes are code, nothing else is markup."""
    parts = CODE.split(text)
    parts[::2] = [SPECIAL.sub(r"\\\1", part) for part in parts[::2]]
    parts[1::2] = [f"`{part}`" for part in parts[1::2]]
    return "".join(parts)
