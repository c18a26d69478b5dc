"""Generates the published files of the wire: pages and byte vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.serving.settings import Safety
from pacinian.wire.protocol_pages import make_guide, make_reference
from pacinian_lab.vectors.vectors import make_text, make_vectors

if TYPE_CHECKING:
    from model import Model


def generate(model: Model) -> dict[str, str]:
    """Return the files of docs/ and of tests/wire/."""
    return {
        "docs/wire.md": make_guide(Safety().lease),
        "docs/wire-messages.md": make_reference(),
    } | {f"tests/wire/{name}.json": make_text(made) for name, made in make_vectors().items()}
