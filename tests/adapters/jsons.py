"""JSON objects, valid and not, and what msgspec finds in them, for readers in other languages."""

from __future__ import annotations

import json
import random
import re
from typing import TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    from collections.abc import Iterator

VALUES: list[Any] = [
    *("", "a", "tcp://127.0.0.1:5555", 'q"\\/\n\t\x7f', "ü𝄞", 0, -7, 2**40, 2**70, 1.5, -0.0, 1e30),
    *(True, False, None, [], {}, [1, [2.5, {"a": "b"}]], {"pid": 3}),
]
EXTRA = ["", "0", "-", ".", "e", "+", '"', "\\u", "\\ud800", "\\udc00", ",", "}", "]", ":", "\x01"]
OVERFLOWING = re.compile(r"\de\d{3}")  # too large for msgspec; a scanner skips them


def cases(count: int) -> Iterator[tuple[str, str]]:
    """Return at most `count` texts, always the same, each with a name to look for."""
    choose = random.Random(1)
    for _ in range(count):
        text, name = _text(choose), choose.choice(["pid", "token", "ü"])
        if not OVERFLOWING.search(text):
            yield text, name


def _text(choose: random.Random) -> str:
    """Return a JSON object, usually with a wrong or a missing part."""
    names = ["pid", "token", "ü", "control", ""]
    made = {choose.choice(names): choose.choice(VALUES) for _ in range(choose.randrange(5))}
    text = json.dumps(made, ensure_ascii=choose.random() < 0.5, indent=choose.choice([None, 1]))
    at = choose.randrange(len(text) + 1)
    extra = choose.choice(EXTRA)
    return text[:at] + extra + text[at + choose.randrange(2) :] if choose.random() < 0.6 else text


def found(text: str, name: str) -> str:
    """Return what msgspec finds in it."""
    try:
        value = msgspec.json.decode(text.encode()).get(name)
    except (msgspec.DecodeError, ValueError, AttributeError):
        return "refused"
    if isinstance(value, str):
        return f"text {value.encode().hex()}".rstrip()
    return f"int {value}" if type(value) is int and abs(value) < 2**63 else "nothing"
