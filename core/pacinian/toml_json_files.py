"""TOML and JSON files, decoded and validated by msgspec."""

from __future__ import annotations

import codecs
import difflib
import functools
import inspect
import json
import re
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
from msgspec import Struct

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
        raise SceneFileError(path, key, problem + _advice(kind, problem, key, raw)) from error
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


def _advice(kind: type[Struct], problem: str, key: str, raw: object) -> str:
    """Suggest a correction for an unknown key, type or word; raw: the file's contents."""
    tags = _list_tags(kind, key, raw)
    if tags and problem.startswith("Expected `object`"):
        return f': write {{ type = "...", ... }}, where the type is one of {", ".join(tags)}'
    unknown = re.search(r"unknown field `(.*)`|Invalid (?:enum )?value '(.*)'", problem)
    if not unknown:
        return ""
    word = next(group for group in unknown.groups() if group is not None)
    if tags and key.endswith(".type"):
        if close := difflib.get_close_matches(word, tags, 1, 0.6):
            return f": did you mean `{close[0]}`?"
        return f": there are {', '.join(tags)}"
    values = _list_values(kind, key, raw) if "enum" in problem else []
    keys = [] if "enum" in problem else _list_keys(kind, key, raw)
    words = values or keys or _words(kind, re.split(r"[.\[]", key + ".")[1])
    if close := difflib.get_close_matches(word, words, 1, 0.6):
        return f": did you mean `{close[0]}`?"
    if not values and kind.__name__ == "SceneFile":
        return ": see `pacinian schema` for what there is"
    return f": there are {', '.join(words)}"


def _list_tags(kind: type[Struct], key: str, raw: Any) -> list[str]:
    """Return the types that are allowed at a key such as `$.objects[0].shape.type`; none if it has no types."""
    return list(_find_tags(_find_node(kind, key.removesuffix(".type"), raw)[0]))


def _list_keys(kind: type[Struct], key: str, raw: Any) -> list[str]:
    """Return the keys of the object at a key, other than `type`; none if it is no object."""
    node, raw = _find_node(kind, key, raw)
    try:
        return sorted(set(_find_properties(kind, node, raw)) - {"type"})
    except (LookupError, TypeError, ValueError, AttributeError):
        return []


def _list_values(kind: type[Struct], key: str, raw: Any) -> list[str]:
    """Return the words that are allowed at a key; none if it has others than words."""
    node, _ = _find_node(kind, key, raw)
    return [
        word
        for part in (node, *node.get("anyOf", ()))
        for word in part.get("enum", ())
        if isinstance(word, str)
    ]


def _find_node(kind: type[Struct], key: str, raw: Any) -> tuple[dict[str, Any], Any]:
    """Return the part of the schema at a key, an empty one if there is none, and the contents there."""
    node: Any = {"$ref": _schema(kind)["$ref"]}
    try:
        for name, index in re.findall(r"\.([\w-]+)|\[(\d+)\]", key):
            if index:
                node, raw = node["items"], raw[int(index)]
                continue
            node = _find_properties(kind, node, raw)[name]
            raw = raw.get(name)
    except (LookupError, TypeError, ValueError, AttributeError):
        return {}, None
    return (node, raw) if isinstance(node, dict) else ({}, None)


def _find_properties(kind: type[Struct], node: Any, raw: Any) -> dict[str, Any]:
    """Return the properties of an object by key.

    raw: its contents. Raises LookupError, TypeError, ValueError or AttributeError if it is no object.
    """
    if mapping := _find_tags(node):
        reference = mapping[raw["type"]]
    else:
        parts = node, *node.get("anyOf", ())
        (reference,) = (part["$ref"] for part in parts if "$ref" in part)
    definitions = _schema(kind)["$defs"]
    found: dict[str, Any] = definitions[reference.removeprefix("#/$defs/")]["properties"]
    return found


def _find_tags(node: Any) -> dict[str, str]:
    """Return the types that a part of a schema distinguishes, each with its definition."""
    if "discriminator" in node:
        found: dict[str, str] = node["discriminator"]["mapping"]
        return found
    return {tag: way for part in node.get("anyOf", ()) for tag, way in _find_tags(part).items()}


@functools.cache
def _schema(kind: type[Struct]) -> dict[str, Any]:
    return msgspec.json.schema(kind)


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


@functools.cache
def _words(kind: type[Struct], part: str) -> list[str]:
    """Return the keys and words allowed in a part of the file, such as "medium"; the top-level keys for ""."""
    schema = msgspec.json.schema(kind)
    definitions = schema["$defs"]  # by name, which includes the module if two share a name
    root = definitions[schema["$ref"].removeprefix("#/$defs/")]["properties"]
    if part not in root:
        return sorted(root)
    words: set[str] = set()
    seen: set[str] = set()
    waiting = [json.dumps(root[part])]
    while waiting:
        text = waiting.pop()
        for name in set(re.findall(r'"#/\$defs/([^"]+)"', text)) - seen:
            seen.add(name)
            properties = definitions[name].get("properties", {})
            words |= properties.keys()
            for values in properties.values():
                for one in values.get("anyOf", [values]):
                    words |= {word for word in one.get("enum", ()) if isinstance(word, str)}
            waiting.append(json.dumps(properties))
    return sorted(words)
