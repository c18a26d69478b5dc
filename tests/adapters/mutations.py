"""Tampered messages, and what Python makes of them, for readers in other languages."""

from __future__ import annotations

import copy
import json
import math
from typing import TYPE_CHECKING, Any

import msgpack

from pacinian.errors import WireError
from pacinian.wire.codec import encode
from pacinian_lab.vectors.vectors import DECODE

from . import tools

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator

FILES = "command", "control", "reply", "state", "tolerated", "malformed"
WIRE = tools.ADAPTERS.parent / "tests" / "wire"
JUNK: list[Any] = [
    *(None, True, False, 0, 1, -1, 26, 2**32, 2**63 - 1, -(2**63), 0.5, 5.0, 1e-12, 1e300),
    *(math.nan, math.inf, -math.inf, "", "sphere", "ü" * 64, "\U0001f590" * 65, "x" * 201, b""),
    *(bytes(4), bytes(12), bytes(36), bytes(84), b"\x00\x00\xc0\x7f" * 3, [], [0.0] * 3, {}),
    *({"type": "sphere", "radius": 0.1}, {"radius": 0.1, "type": "sphere"}, [[1, {"a": 2}]]),
    *({"": {}}, msgpack.ExtType(5, b"12"), msgpack.Timestamp(1), "samples", "buzzing"),
]
HEADS = b"\xc0\xc1\xc4\xc7\xca\xcb\xcf\xd0\xd4\xd9\xdb\xdd\xdf\x80\x90\xa0\xff"


def vectors() -> list[tuple[str, bytes]]:
    """Return socket and bytes of all vectors."""
    found: list[dict[str, Any]] = []
    for name in FILES:
        found += json.loads((WIRE / f"{name}.json").read_text(encoding="utf-8"))
    return [(vector["socket"], bytes.fromhex(vector["hex"])) for vector in found]


def verdict(socket: str, data: bytes) -> str:
    """Return a line: socket, bytes, and "valid" with the usual bytes or "refused" with the path of the error."""
    try:
        said = "valid", encode(DECODE[socket](data)).hex()
    except WireError as error:
        said = "refused", error.path
    return "\t".join([socket, data.hex(), *said])


def mutated(known: list[tuple[str, bytes]], choose: random.Random) -> tuple[str, bytes]:
    """Return one of these messages with other values or bytes."""
    socket, data = choose.choice(known)
    socket = choose.choice([*DECODE]) if choose.random() < 0.05 else socket
    try:
        if choose.random() < 0.5:
            return socket, _other_values(data, choose)
    except (ValueError, TypeError, IndexError, OverflowError):
        pass  # it was not a message before, or the inserted bytes are not
    return socket, _other_bytes(data, choose)


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield all maps and arrays, with each of their keys."""
    if isinstance(value, (dict, list)):
        for key, item in list(value.items() if isinstance(value, dict) else enumerate(value)):
            yield value, key
            yield from _places(item)


def _other_values(data: bytes, choose: random.Random) -> bytes:
    """Replace, remove, add or reorder something."""
    value: Any = msgpack.unpackb(data, strict_map_key=False)
    places = list(_places(value))
    holder, key = choose.choice(places)
    way = choose.randrange(8)
    if way == 0:
        del holder[key]
    elif way == 1 and isinstance(holder, dict):
        holder[choose.choice(["x", "", "type", "name", 5])] = choose.choice(JUNK)
    elif way == 2 and isinstance(holder, dict):
        items = choose.sample(list(holder.items()), len(holder))
        holder.clear()
        holder.update(items)
    elif way <= 4:
        source, name = choose.choice(places)
        holder[key] = copy.deepcopy(source[name])
    else:
        holder[key] = choose.choice([*JUNK, 10.0 ** choose.randint(-9, 9)])
    single = choose.random() < 0.1
    return bytes(msgpack.packb(value, use_single_float=single) or b"")


def _other_bytes(data: bytes, choose: random.Random) -> bytes:
    """Change, cut out, insert or copy a few bytes."""
    made = bytearray(data)
    for _ in range(choose.randint(1, 3)):
        at, way = choose.randrange(len(made) + 1), choose.randrange(10)
        new = choose.choice([*HEADS, choose.randrange(256)])
        if way < 4 and at < len(made):
            made[at] = new
        elif way < 6:
            del made[at : at + choose.randint(1, 4)]
        elif way < 8:
            made[at:at] = bytes([new])
        elif way < 9:
            start = choose.randrange(len(made) + 1)
            made[at:at] = made[start : start + choose.randint(1, 20)]
        elif choose.random() < 0.2:
            del made[at:]
    return bytes(made)
