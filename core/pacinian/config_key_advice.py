"""Suggests the intended key, type or word for a wrong one in a configuration, scene, device or study file."""

from __future__ import annotations

import difflib
import functools
import json
import re
from typing import TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    from msgspec import Struct


def suggest_correction(kind: type[Struct], problem: str, key: str, raw: object) -> str:
    """Return what to write instead of an unknown key, type or word, to append to an error; "" if nothing is known.

    kind: of the file. problem, key: from msgspec's error; the key as in `$.objects[0].shape`. raw: the file's contents.
    """
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
