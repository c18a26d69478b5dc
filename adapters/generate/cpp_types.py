"""C++ types of the fields: how they are declared, read, and reset to their defaults."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from model import (
    Anything,
    Array,
    Bin,
    Bool,
    Fixed,
    Float,
    Int,
    Map,
    Maybe,
    Part,
    Scalar,
    Text,
    Union,
    Words,
)

if TYPE_CHECKING:
    from model import Field, Type

STARTS: dict[type, str] = {Bool: "false", Int: "0", Float: "0.0", Words: "{}", Fixed: "{}"}
CLEARED = Text, Bin, Array, Map  # empty by default, and so with their memory kept


def declare_type(t: Type) -> str:
    """Return the type in C++."""
    match t:
        case Bool():
            return "bool"
        case Int():
            return "std::int64_t"
        case Float():
            return "double"
        case Text():
            return "std::string"
        case Bin():
            return "Bytes"
        case Scalar() | Anything():
            return type(t).__name__
        case Words() | Part() | Union():
            return t.name
        case Fixed():
            return f"std::array<{declare_type(t.item)}, {t.count}>"
        case Array():
            return f"std::vector<{declare_type(t.item)}>"
        case Map():
            return f"Map<{declare_type(t.item)}>"
        case Maybe():
            return f"std::optional<{declare_type(t.item)}>"


def read(t: Type, into: str) -> str:
    """Return an expression that reads a value; it is false if the value is not valid."""
    match t:
        case Words():
            return f"in.choice({into})"
        case Part():
            return f"in.part({into})"
        case Union():
            return f"in.one_of({into})"
        case Fixed():
            return f"in.tuple({into}, {_reader(t.item)})"
        case Array():
            return f"in.items({into}, {_lengths(t)}, {_reader(t.item)})"
        case Map():
            most = _lengths(Array(t.item, 0, t.most))
            return f"in.entries({into}, {_lengths(t.key)}, {most}, {_reader(t.item)})"
        case Maybe():
            return f"in.maybe({into}, {_reader(t.item)})"
        case Int():
            bounds = [] if t.low is None else [str(t.low), str(t.high)]
        case Float():
            bounds = [_range(t)]
        case Scalar():
            return f"get_scalar(in, {into}, {_range(t.real)}, {_lengths(t.text)})"
        case Text() | Bin():
            bounds = [_lengths(t)]
        case Bool() | Anything():
            bounds = []
    return f"in.get({', '.join([into, *(b for b in bounds if b != '{}')])})"


def initial(field: Field) -> str:
    """Return the initialiser of a field; "" if the default of its type suffices."""
    if not field.needed:
        return default(field.type, field.default)
    return STARTS.get(type(field.type), "")


def default(t: Type, value: Any) -> str:
    """Return a default in C++; "" if the type has it by itself."""
    if isinstance(value, Part):
        return f"{value.name}{{}}" if isinstance(t, Union) else ""
    if isinstance(value, str):
        words = t.words if isinstance(t, Union) else t
        return f"{words.name}::{identifier(value)}" if isinstance(words, Words) else ""
    if isinstance(value, tuple):
        return f"{{{', '.join(map(repr, value))}}}" if value else ""
    if isinstance(value, bool):
        return str(value).lower()
    return "" if value is None or isinstance(value, bytes) else repr(value)


def reset(field: Field) -> str:
    """Return a statement that resets a field to its default, without allocation where possible."""
    if isinstance(field.type, CLEARED):
        return f"message.{field.name}.clear();"
    if isinstance(field.type, Maybe):
        return f"message.{field.name}.reset();"
    value = default(field.type, field.default) or f"{declare_type(field.type)}{{}}"
    return f"message.{field.name} = {value};"


def list_names(t: Type) -> list[str]:
    """Return the names of messages, unions and enumerations that a type needs."""
    match t:
        case Words() | Part():
            return [t.name]
        case Union():
            return [t.name, *t.kinds, *([t.words.name] if t.words else [])]
        case Array() | Map() | Maybe():
            return list_names(t.item)
        case _:
            return []


def identifier(word: str) -> str:
    """Return a word of the wire as a name."""
    return word.replace("-", "_")


def _reader(item: Type) -> str:
    return f"[&]({declare_type(item)}& item) {{ return {read(item, 'item')}; }}"


def _range(t: Float) -> str:
    if t.low is None:
        return "{}"
    return f"{{{t.low!r}, {t.high!r}{', true' if t.above else ''}}}"


def _lengths(t: Text | Bin | Array) -> str:
    if t.most is None:
        return f"{{{t.least}}}" if t.least else "{}"
    return f"{{{t.least}, {t.most}}}"
