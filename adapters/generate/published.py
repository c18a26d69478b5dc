"""What is published of the wire and of scene files: the page, the schemas and the byte vectors."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from pacinian.scene.file import make_schema
from pacinian.wire.asyncapi import make_asyncapi
from pacinian.wire.markdown import make_page
from pacinian_lab.vectors.vectors import make_text, make_vectors

if TYPE_CHECKING:
    from model import Model


def generate(model: Model) -> dict[str, str]:
    """The files of docs/ and of tests/wire/."""
    return {
        "docs/wire.md": make_page(),
        "docs/wire.asyncapi.json": json.dumps(make_asyncapi(), indent=2) + "\n",
        "docs/scene.schema.json": json.dumps(make_schema(), indent=2) + "\n",
    } | {f"tests/wire/{name}.json": make_text(made) for name, made in make_vectors().items()}
