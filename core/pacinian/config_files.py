"""Configuration, scene, device and study files in TOML or JSON: msgspec decodes and checks them. Their JSON Schemas."""

from __future__ import annotations

import codecs
import inspect
import json
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
from msgspec import Struct

from pacinian.config_key_advice import suggest_correction
from pacinian.errors import SceneFileError, shorten

if TYPE_CHECKING:
    from pathlib import Path

S = TypeVar("S", bound=Struct)

MAX_BYTES = 64 << 20  # size of a file [bytes]


def decode_document(path: Path, kind: type[S]) -> S:
    """Decode a TOML or JSON file to a struct. Raises SceneFileError, which names the file, the key and the fix."""
    text = read_bytes(path, ".toml", ".json")
    decode = msgspec.toml.decode if path.suffix == ".toml" else msgspec.json.decode
    try:
        file: S = decode(text, type=kind)
        if path.suffix == ".json":
            json.loads(text, object_pairs_hook=_refuse_duplicates)  # msgspec accepts them
    except msgspec.ValidationError as error:
        problem, _, key = str(error).rpartition(" - at `$")
        problem, key = (problem, "$" + key.rstrip("`")) if problem else (str(error), "")
        raw = _decode_plain(path, text)
        raise SceneFileError(
            path, key, problem + suggest_correction(kind, problem, key, raw)
        ) from error
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        raise SceneFileError(path, "", f"is not {path.suffix[1:].upper()}: {error}") from error
    return file


def read_bytes(path: Path, *suffixes: str, largest: int = MAX_BYTES) -> bytes:
    """Read a file and strip a byte order mark.

    suffixes: allowed suffixes; any if none are given. largest: largest size [bytes]. Raises SceneFileError, which does
    not reveal the file's contents.
    """
    if suffixes and path.suffix not in suffixes:
        raise SceneFileError(path, "", f"must end in {' or '.join(suffixes)}")
    try:
        if not path.is_file():
            raise SceneFileError(path, "", "cannot be read: it is not there, or not a file")
        with path.open("rb") as file:
            text = file.read(largest + 1)
    except OSError as error:
        raise SceneFileError(path, "", f"cannot be read: {error.strerror}") from error
    except ValueError as error:
        if isinstance(error, SceneFileError):
            raise
        raise SceneFileError(path, "", f"cannot be a path: {error}") from error
    if len(text) > largest:
        raise SceneFileError(path, "", f"is larger than {largest >> 20} MiB")
    return text.removeprefix(codecs.BOM_UTF8)


def _refuse_duplicates(pairs: list[tuple[str, Any]]) -> None:
    """Raise ValueError if two members of a JSON object have the same key."""
    keys = [key for key, _ in pairs]
    if len(set(keys)) < len(keys):
        twice = next(key for i, key in enumerate(keys) if key in keys[:i])
        raise ValueError(f"an object has the key {shorten(repr(twice))} twice")


def _decode_plain(path: Path, text: bytes) -> object:
    """Return a file's contents without types; None if only a part of it is TOML or JSON."""
    try:
        return (msgspec.toml.decode if path.suffix == ".toml" else msgspec.json.decode)(text)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return None


def json_schema(kind: type[Struct], title: str) -> dict[str, Any]:
    """Return the JSON Schema of files of a kind. Docstrings lose their indent, which depends on the Python version."""
    made = _dedent_descriptions(msgspec.json.schema(kind))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **made}


def _dedent_descriptions(made: Any) -> Any:
    if isinstance(made, list):
        return [_dedent_descriptions(item) for item in made]
    if not isinstance(made, dict):
        return made
    return {
        key: inspect.cleandoc(value)
        if key == "description" and isinstance(value, str)
        else _dedent_descriptions(value)
        for key, value in made.items()
    }
