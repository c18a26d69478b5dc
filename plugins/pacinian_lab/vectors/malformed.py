"""Bytes that are no message, and bytes that are one though nobody should write it so."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import msgpack

from pacinian.wire import codec
from pacinian.wire.protocol import MAX_OBJECTS, MAX_PARTS
from pacinian_lab.vectors.examples import make_examples

if TYPE_CHECKING:
    from collections.abc import Iterator

NAN_F4 = b"\x00\x00\xc0\x7f"
DEEP = 40  # arrays in arrays: enough for a reader that counts
BOMBS = {
    "array": b"\xdd\xff\xff\xff\xff",
    "map": b"\xdf\xff\xff\xff\xff",
    "text": b"\xdb\xff\xff\xff\xff",
    "bin": b"\xc6\xff\xff\xff\xff",
}


def make_tolerated() -> Iterator[tuple[str, str, bytes]]:
    """Name, socket and bytes of messages that must be understood."""
    stop: dict[str, Any] = {"type": "stop", "id": 5}
    yield "unknown fields", "control", _pack(stop | {"later": {"a": [1, "b", None]}})
    yield (
        "an unknown field, nested",
        "control",
        _pack(stop)[:1].replace(b"\x82", b"\x83")
        + _pack(stop)[1:]
        + b"\xa1x"
        + b"\x91" * DEEP
        + b"\xc0",
    )
    yield (
        "an unknown field of a type of its own",
        "control",
        _pack(stop | {"x": msgpack.ExtType(5, b"1")}),
    )
    yield "an unknown field that is NaN", "control", _pack(stop | {"x": math.nan})
    yield "the type last", "control", _pack({"id": 5, "type": "stop"})
    yield "defaults left out", "control", _pack({"type": "stop"})
    yield "a key twice: the last counts", "control", b"\x83" + _pack(stop)[1:] + b"\xa2id\x06"
    yield (
        "numbers longer than they need be",
        "control",
        b"\x82" + _pack("type") + _pack("stop") + _pack("id") + b"\xcf" + bytes(7) + b"\x05",
    )
    move = _example("select am")
    move["technique"]["frequency"] = 150
    yield "a whole number for a float", "control", _pack(move)
    put = _example("put point")
    put["objects"]["a"]["force"] = 0.5
    single: Any = msgpack.packb(put, use_single_float=True)
    yield "single precision", "command", single


def make_malformed() -> Iterator[tuple[str, str, bytes]]:
    """Name, socket and bytes of what must be refused."""
    stop = _pack({"type": "stop", "id": 5})
    yield "nothing", "control", b""
    yield "no map", "control", _pack([1, 2])
    yield "cut short", "control", stop[:-1]
    yield "trailing bytes", "control", stop + b"\x00"
    yield "a byte that is never used", "control", b"\xc1"
    yield "text that is not UTF-8", "control", stop.replace(b"stop", b"st\xffp")
    yield "no type", "control", _pack({"id": 5})
    yield "an unknown type", "control", _pack({"type": "halt", "id": 5})
    yield "a command on the control socket", "control", _pack(_example("clear"))
    yield "a key that is a number", "control", _pack({"type": "stop", 5: 5})
    yield "a key that is an array", "control", b"\x82\xa4type\xa4stop\x91\x01\x01"
    yield "another type", "control", _pack({"type": "stop", "id": "5"})
    yield "an extension type", "control", _pack({"type": "stop", "id": msgpack.ExtType(5, b"1")})
    yield "below the bounds", "control", _pack({"type": "stop", "id": -1})
    yield "above the bounds", "control", _pack({"type": "stop", "id": 2**32})
    yield (
        "a session's key that is too short",
        "control",
        _pack(_example("bye") | {"session": b"short"}),
    )
    yield (
        "a session's key as text",
        "control",
        _pack(_example("bye") | {"session": "0123456789abcdef"}),
    )
    yield "a name that is too long", "control", _pack(_example("hello") | {"client": "n" * 65})
    for kind, head in BOMBS.items():
        yield f"a length bomb: {kind}", "control", b"\x82\xa4type\xa4stop\xa2id" + head
        yield (
            f"a length bomb in an unknown field: {kind}",
            "control",
            b"\x82\xa4type\xa4stop\xa1x" + head,
        )
    yield from _commands()
    yield "a reply with a code that is unknown", "reply", _pack(_example("error") | {"code": "odd"})
    yield "a reply without its session", "reply", _pack({"type": "welcome", "id": 1})
    yield "a state that is a reply", "state", _pack(_example("ok"))


def _commands() -> Iterator[tuple[str, str, bytes]]:
    clear = _example("clear")
    yield "a time that is NaN", "command", _pack(clear | {"time": math.nan})
    yield "a time that is infinite", "command", _pack(clear | {"time": math.inf})
    yield "a sequence number of 0", "command", _pack(clear | {"sequence": 0})
    yield "a life that is too long", "command", _pack(clear | {"ttl": 61.0})
    yield "a field that is missing", "command", _pack({k: clear[k] for k in clear if k != "time"})
    for name, place, value in (
        ("an unknown object", ("type",), "sponge"),
        ("an unknown shape", ("shape", "type"), "cube"),
        (
            "a shape that only volumes have",
            ("shape",),
            {"type": "capsule", "radius": 0.1, "length": 0.1},
        ),
        ("a radius below 0", ("shape", "radius"), -0.03),
        ("a radius that is NaN", ("shape", "radius"), math.nan),
        ("two coordinates", ("pose", "position"), [0.0, 0.0]),
        ("an unknown preset", ("envelope",), "humming"),
        ("an unknown technique", ("technique",), {"type": "fm"}),
    ):
        put = _example("put surface sphere")
        _set(put["objects"]["a"], place, value)
        yield name, "command", _pack(put)
    put = _example("put point")
    yield (
        "a key of objects that is a number",
        "command",
        _pack(put | {"objects": {1: put["objects"]["a"]}}),
    )
    yield (
        "a name of an object that is empty",
        "command",
        _pack(put | {"objects": {"": put["objects"]["a"]}}),
    )
    yield (
        "too many objects",
        "command",
        _pack(put | {"objects": {str(i): 0 for i in range(MAX_OBJECTS + 1)}}),
    )
    put = _example("put volume union")
    put["objects"]["a"]["shape"]["parts"] = [{"type": "sphere", "radius": 0.1}] * (MAX_PARTS + 1)
    yield "too many parts", "command", _pack(put)
    put["objects"]["a"]["shape"]["parts"] = [{"type": "union", "parts": []}]
    yield "a union in a union", "command", _pack(put)
    put = _example("put surface mesh")
    put["objects"]["a"]["shape"]["faces"] = bytes([4, 0, 0, 0] * 3)
    yield "a face of a vertex that is not there", "command", _pack(put)
    put = _example("put surface height-map")
    put["objects"]["a"]["shape"]["grid"] = [2, 3]
    yield "a grid of another size", "command", _pack(put)
    put = _example("put particles")
    put["objects"]["a"]["positions"] = NAN_F4 * 3
    yield "positions that are NaN", "command", _pack(put)
    move = _example("move")
    yield "poses of other names", "command", _pack(move | {"names": ["a"]})
    yield "poses that are not rows", "command", _pack(move | {"poses": bytes(55)})
    yield "poses that are NaN", "command", _pack(move | {"poses": NAN_F4 * 14})
    yield "poses in an array", "command", _pack(move | {"poses": [0.0] * 14})
    hands = _example("hands")
    hands["hands"][0]["joints"] = bytes(12)
    yield "a hand of one joint", "command", _pack(hands)


def _set(item: dict[str, Any], place: tuple[str, ...], value: object) -> None:
    *way, last = place
    for key in way:
        item = item[key]
    item[last] = value


def _example(name: str) -> Any:
    """An example as plain values, to be changed."""
    return next(msgpack.unpackb(codec.encode(m)) for n, _, m in make_examples() if n == name)


def _pack(value: object) -> bytes:
    return bytes(msgpack.packb(value) or b"")
