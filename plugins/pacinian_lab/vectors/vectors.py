"""Byte vectors: messages as bytes, and what they say, for readers and writers in any language.

`python adapters/generate/main.py` writes them to tests/wire; tests/wire/README.md says how to read them.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import msgpack

from pacinian.errors import WireError
from pacinian.wire import codec
from pacinian_lab.vectors.examples import make_examples
from pacinian_lab.vectors.malformed import make_malformed, make_tolerated

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

DECODE: dict[str, Callable[[bytes], Any]] = {
    "command": codec.decode_command,
    "control": codec.decode_control,
    "reply": codec.decode_reply,
    "state": codec.decode_state,
}


def make_lines(value: Any, path: str = "$") -> Iterator[str]:
    """A value as lines of path, kind and content, in the order of its bytes."""
    if isinstance(value, dict):
        yield f"{path} map {len(value)}"
        for key, item in value.items():
            yield from make_lines(item, f"{path}.{key}")
    elif isinstance(value, list):
        yield f"{path} array {len(value)}"
        for i, item in enumerate(value):
            yield from make_lines(item, f"{path}[{i}]")
    elif isinstance(value, bytes):
        yield f"{path} bin {value.hex()}".rstrip()
    elif value is None:
        yield f"{path} nil"
    elif isinstance(value, str):
        yield f"{path} str {value}".rstrip()
    elif isinstance(value, bool):
        yield f"{path} bool {str(value).lower()}"
    else:
        yield f"{path} {type(value).__name__} {value!r}"


def make_vectors() -> dict[str, list[dict[str, Any]]]:
    """All vectors, by the file that they are in."""
    files: dict[str, list[dict[str, Any]]] = {
        name: [] for name in ("command", "control", "reply", "state", "tolerated", "malformed")
    }
    for name, socket, message in make_examples():
        data = codec.encode(message)
        files[socket].append(_vector(name, socket, data))
    for name, socket, data in make_tolerated():
        meant = codec.encode(DECODE[socket](data))
        files["tolerated"].append(_vector(name, socket, data) | {"meant": meant.hex()})
    for name, socket, data in make_malformed():
        files["malformed"].append(
            {"name": name, "socket": socket, "path": _path(socket, data), "hex": data.hex()}
        )
    return files


def _vector(name: str, socket: str, data: bytes) -> dict[str, Any]:
    value = list(make_lines(msgpack.unpackb(data, strict_map_key=False)))
    return {"name": name, "socket": socket, "hex": data.hex(), "value": value}


def _path(socket: str, data: bytes) -> str:
    try:
        DECODE[socket](data)
    except WireError as error:
        return error.path
    raise ValueError(f"{data!r} is a valid message")


def make_text(made: list[dict[str, Any]]) -> str:
    """The content of a file."""
    return json.dumps(made, indent=1, ensure_ascii=False) + "\n"
