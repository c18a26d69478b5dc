"""The wire as an AsyncAPI 3 document, whose schemas are JSON Schema (draft 7, as AsyncAPI's own)."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

import msgspec
from msgspec.inspect import BytesType, Metadata, StructType, Type

from pacinian.wire import commands, control, replies, state
from pacinian.wire.message_docs import name_class
from pacinian.wire.protocol import MAJOR, MINOR

if TYPE_CHECKING:
    from collections.abc import Iterable

    from msgspec import Struct

SCHEMAS = "#/components/schemas/"
CHANNELS: dict[str, tuple[str, tuple[type[Struct], ...], tuple[type[Struct], ...]]] = {
    "command": (
        "What is to be felt. ROUTER; a message is one part.",
        commands.COMMANDS,
        (replies.Ok, replies.Error, replies.Pressures, replies.Shown),
    ),
    "control": (
        "Who may, and whether at all. ROUTER; a message is one part.",
        control.CONTROLS,
        (*replies.REPLIES, state.State),
    ),
    "state": ("What is emitted. PUB; two parts: topic, message.", (), state.STATES),
}


def make_asyncapi() -> dict[str, Any]:
    """The document."""
    kinds = list(dict.fromkeys(kind for _, to, back in CHANNELS.values() for kind in (*to, *back)))
    channels, operations = {}, {}
    for name, (text, to, back) in CHANNELS.items():
        messages = {
            name_class(k): {"$ref": f"#/components/messages/{name_class(k)}"} for k in (*to, *back)
        }
        channels[name] = {"address": name, "description": text, "messages": messages}
        for action, sent in (("receive", to), ("send", back)):
            if sent:
                operations[f"{action} {name}"] = _operation(action, name, sent)
    return {
        "asyncapi": "3.0.0",
        "info": {
            "title": "Pacinian",
            "version": f"{MAJOR}.{MINOR}.0",
            "description": "MessagePack over ZeroMQ, as the server sees it. An address is the name of a field "
            "of the connection file. `x-msgpack: bin` marks what is a `bin` in MessagePack; its bounds are bytes.",
        },
        "defaultContentType": "application/msgpack",
        "channels": channels,
        "operations": operations,
        "components": {
            "messages": {name_class(kind): _message(kind) for kind in kinds},
            "schemas": _schemas(kinds),
        },
    }


def _operation(action: str, channel: str, kinds: Iterable[type[Struct]]) -> dict[str, Any]:
    messages = [{"$ref": f"#/channels/{channel}/messages/{name_class(kind)}"} for kind in kinds]
    return {"action": action, "channel": {"$ref": f"#/channels/{channel}"}, "messages": messages}


def _message(kind: type[Struct]) -> dict[str, Any]:
    summary = inspect.cleandoc(kind.__doc__ or "").partition("\n")[0]
    return {"summary": summary, "payload": {"$ref": SCHEMAS + kind.__name__}}


def _schemas(kinds: Iterable[type[Struct]]) -> dict[str, Any]:
    """The schemas of all messages and of all that they hold, by the name of the class."""
    _, found = msgspec.json.schema_components(kinds, ref_template=SCHEMAS + "{name}")
    made = {name: _plain(schema) for name, schema in sorted(found.items())}
    waiting = [msgspec.inspect.type_info(kind) for kind in kinds]
    seen: set[type] = set()
    while waiting:
        held: Any = waiting.pop()
        if isinstance(held, StructType) and held.cls not in seen:
            seen.add(held.cls)
            for field in held.fields:
                t = field.type.type if isinstance(field.type, Metadata) else field.type
                waiting.append(t)
                if isinstance(t, BytesType):
                    made[held.cls.__name__]["properties"][field.name] |= _bin(t)
        inner = [getattr(held, name, None) for name in ("type", "item_type", "value_type")]
        waiting += [t for t in inner if isinstance(t, Type)]
        waiting += getattr(held, "types", ())
    return made


def _bin(t: BytesType) -> dict[str, Any]:
    """The bounds of a `bin` in bytes."""
    bounds = {"minLength": t.min_length, "maxLength": t.max_length}  # as base64 they were others
    return {"x-msgpack": "bin"} | {name: n for name, n in bounds.items() if n is not None}


def _plain(schema: Any) -> Any:
    """A schema without what draft 7 and AsyncAPI do not have: tuples as arrays of one kind."""
    if isinstance(schema, list):
        return [_plain(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    made: dict[str, Any] = {key: _plain(value) for key, value in schema.items()}
    made.pop("contentEncoding", None)
    made.pop("discriminator", None)
    if "prefixItems" in made:
        made["items"] = made.pop("prefixItems")[0]
    if isinstance(made.get("description"), str):
        made["description"] = inspect.cleandoc(made["description"])
    return made
