"""Generates the C# statements that read and write a field, for each type."""

from __future__ import annotations

from typing import TYPE_CHECKING

from csharp_types import declare_type, number
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
    from model import Type

MOST = "int.MaxValue"


def write(t: Type, name: str) -> list[str]:
    """Return statements that write a field."""
    match t:
        case Int():
            return [f"w.Whole({name});"]
        case Float() | Maybe(item=Float()):
            return [f"w.Real({name});"]
        case Bool():
            return [f"w.Bool({name});"]
        case Text():
            return [f"w.Text({name});"]
        case Words():
            return [f"w.Word(Words.{t.name}[(int){name}]);"]
        case Bin():
            return [f"w.Binary({name});"]
        case Fixed():
            return [f"w.Fixed({name});"]
        case Scalar() | Anything():
            return [f"{name}.Write(w);"]
        case Part() | Union() | Maybe():
            return [f"w.Message({name});"]
        case Array():
            item = write(t.item, f"{name}[i]")
            return [f"w.Array({name}.Count);", *_each(name, item)]
        case Map():
            item = [f"w.Text({name}.Key(i));", *write(t.item, f"{name}.Value(i)")]
            return [f"w.Map({name}.Count);", *_each(name, item)]


def _each(name: str, statements: list[str]) -> list[str]:
    return [
        f"for (int i = 0; i < {name}.Count; i++)",
        "{",
        *(f"    {line}" for line in statements),
        "}",
    ]


def read(t: Type, name: str) -> str:
    """Return an expression that reads a single value; it is false if the value is not valid."""
    match t:
        case Int() if t.low is None:
            return f"r.Whole(ref {name})"
        case Int():
            return f"r.Whole(ref {name}, {t.low}, {t.high})"
        case (Float() as real) | Maybe(item=Float() as real):
            return f"r.Real(ref {name}{_range(real)})"
        case Bool():
            return f"r.Bool(ref {name})"
        case Text():
            return f"r.Text(ref {name}, {_lengths(t)})"
        case Bin():
            return f"r.Binary(ref {name}, {_lengths(t)})"
        case Fixed():
            bounds = _range(t.item)
            return f"r.Fixed(ref {name}{bounds})"
        case Scalar():
            return f"r.Scalar(ref {name}{_range(t.real)}, {_lengths(t.text)})"
        case Anything():
            return f"r.Any(ref {name})"
        case Part():
            return f"({name} = {name} ?? new {t.name}()).Read(r)"
        case Union() | Words():
            return f"{'Unions' if isinstance(t, Union) else 'Words'}.Read(r, ref {name})"
        case Array(item=Text() as item):
            return f"r.Texts({name}, {_lengths(t)}, {_lengths(item)})"
        case _:
            raise TypeError(f"{t}: not read in one go")


def generate_read(t: Type, name: str) -> list[str]:
    """Return statements that read a field, and return whether it is valid."""
    match t:
        case Maybe() if not isinstance(t.item, Float):
            return [
                "if (r.Nil())",
                "{",
                f"    {name} = null;",
                "    return true;",
                "}",
                f"return {read(t.item, name)};",
            ]
        case Array() | Map() if not (isinstance(t, Array) and isinstance(t.item, Text)):
            return [f"return Read{name}(r);"]
        case _:
            return [f"return {read(t, name)};"]


def loop(t: Type, name: str) -> list[str]:
    """Return a method that reads the items of an array or map; nothing for other types."""
    if not isinstance(t, (Array, Map)) or (isinstance(t, Array) and isinstance(t.item, Text)):
        return []
    head = (
        f"Array(out count, {_lengths(t)})"
        if isinstance(t, Array)
        else f"Map(out count, {_format_limit(t)})"
    )
    make = f" ?? new {t.item.name}()" if isinstance(t.item, Part) else ""
    value = read(t.item, "item") if not isinstance(t.item, Part) else "item.Read(r)"
    body = [f"{declare_type(t.item)} item = {name}.Spare(){make};"]
    if isinstance(t, Map):
        body = [
            f"string key = {name}.SpareKey();",
            f"if (!{read(t.key, 'key')})",
            "{",
            "    return false;",
            "}",
            *body,
        ]
    within, add = ("i", "item") if isinstance(t, Array) else ('"[...]"', "key, item")
    body += [
        f"if (!{value})",
        "{",
        f"    return r.Within({within});",
        "}",
        f"{name}.{'Add' if isinstance(t, Array) else 'Set'}({add});",
    ]
    return [
        f"private bool Read{name}(Reader r)",
        "{",
        "    int count;",
        f"    {name}.Clear();",
        f"    if (!r.{head})",
        "    {",
        "        return false;",
        "    }",
        "    for (int i = 0; i < count; i++)",
        "    {",
        *(f"        {line}" for line in body),
        "    }",
        "    return true;",
        "}",
    ]


def _range(t: Int | Float) -> str:
    if t.low is None or t.high is None:
        return ""
    above = ", true" if isinstance(t, Float) and t.above else ""
    return f", {number(t.low)}, {number(t.high)}{above}"


def _lengths(t: Text | Bin | Array) -> str:
    return f"{t.least}, {MOST if t.most is None else t.most}"


def _format_limit(t: Map) -> str:
    return "Reader.MostKeys" if t.most is None else str(t.most)
