"""Reads the model of `pacinian.wire` from its classes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, get_args

import msgspec
from model import (
    Anything,
    Array,
    Bin,
    Bool,
    Field,
    Fixed,
    Float,
    Int,
    Map,
    Maybe,
    Message,
    Model,
    Part,
    Scalar,
    Text,
    Union,
    Words,
)
from msgspec import Struct, inspect

from pacinian.wire import (
    commands,
    control,
    message_docs,
    modulation,
    objects,
    protocol,
    replies,
    shapes,
    state,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from model import Type

WORDS: dict[str, Any] = {
    "PresetName": modulation.PresetName,
    "Code": replies.Code,
    "Output": state.Output,
}
UNIONS: dict[str, Any] = {
    "Shell": shapes.Shell,
    "Primitive": shapes.Primitive,
    "Piece": shapes.Primitive | shapes.Placed,
    "Solid": shapes.Solid,
    "Curve": shapes.Curve,
    "Envelope": modulation.Envelope,
    "Technique": modulation.Technique,
    "Route": Literal["samples", "outline"] | shapes.Curve,
    "Object": objects.Object,
    "AnyCommand": commands.AnyCommand,
    "AnyControl": control.AnyControl,
    "AnyReply": replies.AnyReply | state.State,
    "AnyState": state.AnyState,
}
SOCKETS = {
    "command": ("AnyCommand", protocol.MAX_COMMAND_BYTES),
    "control": ("AnyControl", protocol.MAX_CONTROL_BYTES),
    "reply": ("AnyReply", protocol.MAX_REPLY_BYTES),
    "state": ("AnyState", protocol.MAX_REPLY_BYTES),
}
BASES = commands.Command, control.Request, replies.Reply, objects.HapticObject
WRITTEN = "AnyCommand", "AnyControl"  # by a client
HEARD = "AnyReply", "AnyState", "Object"  # by a client; it reads its own objects to check them


def read() -> Model:
    """Return the model of the whole wire."""
    kinds: dict[type[Struct], None] = {}
    for name, _ in SOCKETS.values():
        for kind in get_args(UNIONS[name]):
            _gather(kind, kinds)
    messages = tuple(_message(kind) for kind in kinds)
    held = [t for message in messages for field in message.fields for t in _within(field.type)]
    sockets: dict[str, tuple[Union, int]] = {}
    for socket, (name, most) in SOCKETS.items():
        union = _type(inspect.type_info(UNIONS[name]), name)
        assert isinstance(union, Union)
        sockets[socket] = union, most
        held.append(union)
    unions = {t.name: t for t in held if isinstance(t, Union)}
    by_name = {message.name: message for message in messages}
    return Model(
        messages,
        bases=tuple(_message(kind) for kind in BASES),
        words=tuple({t.name: t for t in held if isinstance(t, Words)}.values()),
        unions=tuple(unions.values()),
        sockets=sockets,
        constants={name: n for name, n in vars(protocol).items() if isinstance(n, int | float)},
        written=_list_names([unions[name] for name in WRITTEN], by_name),
        heard=_list_names([unions[name] for name in HEARD], by_name),
    )


def _list_names(types: list[Type], messages: dict[str, Message]) -> frozenset[str]:
    """Return the names of all messages, bases, words and unions that some types contain."""
    names: set[str] = set()
    while types:
        for t in _within(types.pop()):
            if not isinstance(t, (Part, Union, Words)) or t.name in names:
                continue
            names.add(t.name)
            kinds = () if isinstance(t, Words) else t.kinds if isinstance(t, Union) else (t.name,)
            for kind in kinds:
                names |= {kind, messages[kind].base}
                types += [field.type for field in messages[kind].fields]
    return frozenset(names - {""})


def _gather(kind: type[Struct], found: dict[type[Struct], None]) -> None:
    """Add a class after all classes that it contains."""
    info: Any = inspect.type_info(kind)
    for field in info.fields:
        for held in _structs(field.type):
            _gather(held, found)
    found[kind] = None


def _structs(t: Any) -> Iterator[type[Struct]]:
    """Return the classes that a type names."""
    if isinstance(t, inspect.StructType):
        yield t.cls
        return
    inner = [getattr(t, name, None) for name in ("type", "item_type", "value_type")]
    for part in (*inner, *getattr(t, "types", ())):
        if isinstance(part, inspect.Type):
            yield from _structs(part)


def _within(t: Type) -> Iterator[Type]:
    """Yield a type, and the types in it."""
    yield t
    if isinstance(t, (Array, Map, Maybe)):
        yield from _within(t.item)
    if isinstance(t, Union) and t.words:
        yield t.words


def _message(kind: type[Struct]) -> Message:
    said = {field.name: field for field in message_docs.describe_fields(kind)}
    info: Any = inspect.type_info(kind)
    return Message(
        name=kind.__name__,
        tag="" if kind in BASES else str(kind.__struct_config__.tag or ""),
        base=_base(kind),
        module=kind.__module__.rpartition(".")[2],
        text=message_docs.summarise(kind),
        fields=tuple(
            Field(
                field.name,
                _type(field.type, kind.__name__ + field.name.title()),
                needed=field.required,
                default=_default(field),
                text=said[field.name].meaning,
                bounds=said[field.name].bounds,
            )
            for field in info.fields
        ),
        bulk=getattr(kind, "BULK", ()),
    )


def _base(kind: type) -> str:
    return next(
        (base.__name__ for base in BASES if kind is not base and issubclass(kind, base)), ""
    )


def _default(field: Any) -> Any:
    value = field.default
    if field.required:
        return None
    if value is msgspec.NODEFAULT:
        value = field.default_factory()
    if isinstance(value, Struct):
        assert value == type(value)()
        return Part(type(value).__name__)
    return value or () if isinstance(value, dict) else value


def _type(t: Any, name: str) -> Type:
    """Return the type. name: of a union or an enumeration that has no other name."""
    match t:
        case inspect.Metadata():
            return _type(t.type, name)
        case inspect.BoolType():
            return Bool()
        case inspect.IntType():
            return Int(t.ge, t.le)
        case inspect.FloatType():
            low = t.ge if t.gt is None else t.gt
            return Float(low, t.le, above=t.gt is not None)
        case inspect.StrType():
            return Text(t.min_length or 0, t.max_length)
        case inspect.BytesType():
            return Bin(t.min_length or 0, t.max_length)
        case inspect.LiteralType():
            return _words(t, name)
        case inspect.TupleType():
            item = _type(t.item_types[0], name)
            assert isinstance(item, (Int, Float))
            assert all(_type(other, name) == item for other in t.item_types)
            return Fixed(item, len(t.item_types))
        case inspect.VarTupleType():
            return Array(_type(t.item_type, name), t.min_length or 0, t.max_length)
        case inspect.DictType():
            key = _type(t.key_type, name)
            assert isinstance(key, Text)
            return Map(key, _type(t.value_type, name), t.max_length)
        case inspect.StructType():
            return Part(t.cls.__name__)
        case inspect.AnyType():
            return Anything()
        case inspect.UnionType():
            return _union(t.types, name)
        case _:
            raise TypeError(f"{t}: no type of a message")


def _words(t: Any, name: str) -> Words:
    for known, literal in WORDS.items():
        if set(get_args(literal)) == set(t.values):
            return Words(known, get_args(literal))
    return Words(name, t.values)


def _union(types: tuple[Any, ...], name: str) -> Type:
    left = [t for t in types if not isinstance(t, inspect.NoneType)]
    if len(left) < len(types):
        return Maybe(_type(left[0], name) if len(left) == 1 else _union(tuple(left), name))
    kinds = tuple(t.cls for t in left if isinstance(t, inspect.StructType))
    if not kinds:
        whole, real, text = (_type(t, name) for t in left if not isinstance(t, inspect.BoolType))
        assert isinstance(whole, Int)
        assert isinstance(real, Float)
        assert isinstance(text, Text)
        return Scalar(whole, real, text)
    literals = [t for t in left if isinstance(t, inspect.LiteralType)]
    name = next((known for known, union in UNIONS.items() if _same(union, kinds, literals)), name)
    bases = {_base(kind) for kind in kinds}
    return Union(
        name,
        tuple(kind.__name__ for kind in kinds),
        words=_words(literals[0], f"{name}Word") if literals else None,
        base=bases.pop() if len(bases) == 1 else "",
    )


def _same(union: Any, kinds: tuple[type, ...], literals: list[inspect.LiteralType]) -> bool:
    parts = get_args(union)
    classes = {part for part in parts if isinstance(part, type)}
    return classes == set(kinds) and len(parts) == len(kinds) + len(literals)
