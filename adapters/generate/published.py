"""Generates the published files of the wire and of scene files: pages, schemas and byte vectors."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from pacinian.scene.file import make_schema
from pacinian.wire.asyncapi import make_asyncapi
from pacinian.wire.markdown import make_guide, make_reference
from pacinian_lab.vectors.vectors import make_text, make_vectors

if TYPE_CHECKING:
    from model import Model


def generate(model: Model) -> dict[str, str]:
    """Return the files of docs/ and of tests/wire/."""
    return {
        "docs/wire.md": make_guide(),
        "docs/wire-messages.md": make_reference(),
        "docs/wire.asyncapi.json": json.dumps(make_asyncapi(), indent=2) + "\n",
        "docs/scene.schema.json": json.dumps(make_schema(), indent=2) + "\n",
    } | {f"tests/wire/{name}.json": make_text(made) for name, made in make_vectors().items()}
