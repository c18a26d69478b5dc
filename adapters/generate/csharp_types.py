"""C# types of the fields: names and defaults."""

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
    from model import Field, Message, Type

REALS, WHOLES = {2: "Vec2", 3: "Vec3", 4: "Quat"}, {2: "Int2", 3: "Int3"}
RENAMED = {("Hands", "hands"): "All", ("Pressures", "pressures"): "Values"}  # not the class name


def pascal(name: str) -> str:
    """Return a name in Pascal case."""
    return "".join(part[:1].upper() + part[1:] for part in name.replace("-", "_").split("_"))


def member(message: Message, field: Field) -> str:
    """Return the name of a field."""
    return RENAMED.get((message.name, field.name), pascal(field.name))


def union(t: Union) -> str:
    """Return the common base or interface of a union's messages."""
    return t.base or f"I{t.name.removeprefix('Any')}"


def declare_type(t: Type) -> str:
    """Return the type of a field."""
    match t:
        case Bool():
            return "bool"
        case Int():
            return "long"
        case Float():
            return "double"
        case Text():
            return "string"
        case Words() | Part():
            return t.name
        case Bin():
            return "Bulk"
        case Fixed():
            return (REALS if isinstance(t.item, Float) else WHOLES)[t.count]
        case Array():
            return f"Items<{declare_type(t.item)}>"
        case Map():
            return f"Table<{declare_type(t.item)}>"
        case Union():
            return union(t)
        case Scalar() | Anything():
            return "Value"
        case Maybe():
            return declare_type(t.item) + ("?" if isinstance(t.item, Float) else "")


def number(value: float) -> str:
    """Return a number as C# code."""
    return repr(value)


def default(t: Type, value: Any) -> str:
    """Return the default of a field that has one."""
    match t:
        case Words():
            return f"{t.name}.{pascal(value)}"
        case Fixed():
            return f"new {declare_type(t)}({', '.join(map(number, value))})"
        case Union() if isinstance(value, str):
            assert t.words
            return f"new Named{t.name} {{ Value = {default(t.words, value)} }}"
        case Part() | Union():
            return f"new {value.name}()"
        case Maybe():
            assert value is None
            return "null"
        case Bool():
            return str(value).lower()
        case Text():
            assert not value
            return '""'
        case _:
            return number(value)
