"""Documentation of the message classes from their docstrings and annotations: fields, types, bounds, meanings."""

from __future__ import annotations

import inspect
import re
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import msgspec
from msgspec.inspect import (
    AnyType,
    BoolType,
    BytesType,
    DictType,
    FloatType,
    IntType,
    LiteralType,
    Metadata,
    NoneType,
    StrType,
    StructType,
    TupleType,
    Type,
    UnionType,
    VarTupleType,
)

from pacinian.wire import modulation, objects, shapes

if TYPE_CHECKING:
    from msgspec import Struct

GROUPS: dict[str, Any] = {  # unions that have their own section
    "objects": objects.Object,
    "shells": shapes.Shell,
    "solids": shapes.Solid,
    "primitive solids": shapes.Primitive,
    "curves": shapes.Curve,
    "envelopes": modulation.Envelope,
    "techniques": modulation.Technique,
}
PLAIN: dict[type[Type], str] = {
    IntType: "int",
    FloatType: "float",
    StrType: "str",
    BytesType: "bin",
    BoolType: "bool",
}

UNITS: dict[type[Type], str] = {StrType: " characters", BytesType: " bytes"}


class FieldSaid(NamedTuple):
    """Texts on a field: name, type in Markdown, bounds with unit, default or "", and meaning."""

    name: str
    type: str
    bounds: str
    default: str
    meaning: str


def name_class(kind: type[Struct]) -> str:
    """Return the name of a class on the wire: its `type`, or the class name of a part that has none."""
    return str(kind.__struct_config__.tag or kind.__name__)


def link_class(kind: type[Struct]) -> str:
    """Return the name of a class, linked to its section."""
    return f"[`{name_class(kind)}`](#{name_class(kind).lower()})"


def list_classes(group: Any) -> list[type[Struct]]:
    """Return the classes of a union."""
    return [kind for kind in get_args(group) if isinstance(kind, type)]


def summarise(kind: type[Struct]) -> str:
    """Return the description of a class, without its fields."""
    return _split(kind)[0]


def describe_fields(kind: type[Struct], *, but: type[Struct] | None = None) -> list[FieldSaid]:
    """Describe all fields of a class, except those of its base `but`."""
    left = set(but.__struct_fields__) if but else set()
    info: Any = msgspec.inspect.type_info(kind)
    return [_field(kind, field) for field in info.fields if field.name not in left]


def _field(kind: type[Struct], field: Any) -> FieldSaid:
    text = ""
    for base in reversed(kind.__mro__):
        if issubclass(base, msgspec.Struct) and base is not msgspec.Struct:
            text = _split(base)[1].get(field.name, text)
    bounds, notes = _bounds(field.type)
    default = "" if field.required else _default(field)
    return FieldSaid(field.name, _type(field.type), bounds, default, text or notes)


def _split(kind: type[Struct]) -> tuple[str, dict[str, str]]:
    """Split a docstring into its summary and the meaning of each field."""
    text = " ".join(inspect.cleandoc(vars(kind).get("__doc__") or "").split())
    names = kind.__struct_fields__
    parts = re.split(r"(?:^|(?<=[.;] ))((?:\w+, )*\w+): ", text)
    found: dict[str, str] = {}
    head = parts[0]
    last: list[str] = []
    for given, said in zip(parts[1::2], parts[2::2], strict=True):
        listed = given.split(", ")
        if set(listed) <= set(names):
            last = listed
            found |= dict.fromkeys(listed, said.strip())
        elif last:
            found |= {name: f"{found[name]} {given}: {said.strip()}" for name in last}
        else:
            head += f"{given}: {said}"
    return head.strip(), {name: said.rstrip(". ") for name, said in found.items()}


def _default(field: Any) -> str:
    value = field.default
    if value is msgspec.NODEFAULT:
        value = field.default_factory()
    if isinstance(value, msgspec.Struct):
        return f"`{name_class(type(value))}`"
    if value is None or isinstance(value, bool):
        return {None: "nil", True: "true", False: "false"}[value]
    if isinstance(value, (int, float)):
        return f"{value:.6g}"
    if not value:
        return "empty"
    return f'`"{value}"`' if isinstance(value, str) else ", ".join(f"{v:g}" for v in value)


def _type(t: Type) -> str:
    if isinstance(t, Metadata):
        return _type(t.type)
    if isinstance(t, UnionType):
        return _union(t)
    if isinstance(t, StructType):
        return link_class(t.cls)
    if isinstance(t, LiteralType):
        return " or ".join(f'`"{value}"`' for value in t.values) if len(t.values) < 6 else "str"
    if isinstance(t, TupleType):
        return f"{len(t.item_types)} × {_type(t.item_types[0])}"
    if isinstance(t, VarTupleType):
        return f"array of {_type(t.item_type)}"
    if isinstance(t, DictType):
        return f"map of {_type(t.key_type)} to {_type(t.value_type)}"
    if isinstance(t, (NoneType, AnyType)):
        return "nil" if isinstance(t, NoneType) else "any"
    return PLAIN[type(t)]


def _union(t: UnionType) -> str:
    left = {part.cls for part in t.types if isinstance(part, StructType)}
    words = [_type(part) for part in t.types if not isinstance(part, StructType)]
    for name, group in GROUPS.items():
        kinds = set(list_classes(group))
        if kinds <= left:
            left -= kinds
            texts = {_type(msgspec.inspect.type_info(t)) for t in set(get_args(group)) - kinds}
            words = [f"[{name}](#{name.replace(' ', '-')})", *(w for w in words if w not in texts)]
    words += sorted(link_class(kind) for kind in left)
    return " or ".join(sorted(words, key=lambda word: word == "nil"))


def _bounds(t: Type) -> tuple[str, str]:
    """Return the bounds of a type with their unit, and any other note on it."""
    if isinstance(t, Metadata):
        note = (t.extra_json_schema or {}).get("description", "")
        bounds, more = _bounds(t.type)
        return (
            (f"{bounds} {note}".strip(), more) if note.startswith("[") else (bounds, note or more)
        )
    if isinstance(t, UnionType):
        each = [_bounds(part) for part in t.types if not isinstance(part, StructType)]
        return next((b for b in each if b != ("", "")), ("", ""))
    if isinstance(t, TupleType):
        return _bounds(t.item_types[0])
    if isinstance(t, (IntType, FloatType)):
        return _range(t), ""
    if isinstance(t, (StrType, BytesType, VarTupleType, DictType)):
        return _lengths(t), ""
    return "", ""


def _range(t: IntType | FloatType) -> str:
    least, most = (t.ge if t.gt is None else t.gt), t.le
    if least is None or most is None:
        return ""
    low, high = (f"{v:,d}" if isinstance(v, int) else f"{v:g}" for v in (least, most))
    return f"{low} to {high}" if t.gt is None else f"more than {low}, at most {high}"


def _lengths(t: StrType | BytesType | VarTupleType | DictType) -> str:
    unit = UNITS.get(type(t), "")
    if t.max_length is None:
        return ""
    if t.min_length == t.max_length:
        return f"{t.max_length:,}{unit}"
    return f"{t.min_length or 0:,} to {t.max_length:,}{unit}"
