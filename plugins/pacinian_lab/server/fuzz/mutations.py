"""Mutations of valid messages, by structure or by bytes. The same seed gives the same mutations."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, Any

import msgspec

from pacinian_lab.server.fuzz.messages import COMMANDS, HELLO, OBJECTS, STOP

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

    from pacinian_lab.server.fuzz.messages import Message

ODD: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**31, 2**53 + 1, 2**63 - 1, -(2**63), 2**64 - 1, 0.0, -0.0,
    math.nan, math.inf, -math.inf, 1e308, 5e-324, "", "x", "a" * 300, "\0", "../../etc/passwd",
    "{0.__class__}", "\N{PILE OF POO}" * 70, b"", b"\0", b"\xff" * 64, b"\0\0\xc0\x7f" * 12,
    [], [[]], {}, {"": {}}, [None] * 300, {"type": "point"}, {"type": "nothing"}, [0.0] * 3,
    msgspec.msgpack.Ext(5, b"abc"), msgspec.msgpack.Ext(-1, b"\xff" * 12),
)  # fmt: skip
TYPES = (
    "put", "move", "remove", "clear", "envelope", "hands", "quiet", "field", "renew", "disarm",
    "reset", "select", "capabilities", "status", "error", "state", "Put", "point", "sphere", "am",
    "", "welcome", "ok",
)  # fmt: skip
LENGTHS = b"\xdc", b"\xdd", b"\xde", b"\xdf", b"\xd9", b"\xda", b"\xdb", b"\xc5", b"\xc6", b"\xc9"
DEEP = 5000
MAX_LONG_BYTES = 200_000  # [bytes] maximum of the long ones, which are rare

encode: Callable[[Any], bytes] = msgspec.msgpack.Encoder().encode


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths to all values inside a message."""
    if isinstance(value, dict):
        items: Any = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    else:
        return [at]
    return [at, *(place for key, inner in items for place in places(inner, (*at, key)))]


def replace_value(value: Any, at: tuple[Any, ...], change: Callable[[Any], Any]) -> Any:
    """Return the message with the value at a path changed. Copies only the containers along the path."""
    if not at:
        return change(value)
    key, rest = at[0], at[1:]
    made = list(value) if isinstance(value, list) else dict(value)
    made[key] = replace_value(value[key], rest, change)
    return made


class Spoiler:
    """An endless source of mutated messages. session: of the client that sends them."""

    def __init__(self, random: Random, session: bytes) -> None:
        self.random, self.session = random, session
        self.sequence = 0
        self._kept: list[bytes] = [b"\x80"]
        self._ways = (
            (12, "odd value", self._set_odd_value),
            (6, "missing", self._remove_value),
            (6, "moved", self._misplace_object),
            (5, "other type", self._change_type),
            (4, "unknown field", self._add_field),
            (4, "bytes flipped", self._flip_bits),
            (3, "cut", self._cut),
            (3, "joined", self._join_messages),
            (3, "number", self._set_number),
            (2, "bulk", self._replace_bulk),
            (2, "replayed", self._replay_message),
            (2, "sequence", self._change_sequence),
            (2, "session", self._change_session),
            (2, "length bomb", self._declare_length),
            (2, "bad UTF-8", self._break_text),
            (2, "twice", self._repeat_key),
            (2, "good", self._leave),
            (1, "deep", self._nest),
            (1, "many", self._put_many),
            (4, "random bytes", self._randomise),
            (0.02, "long", self._pad),
        )
        self._weights = [way[0] for way in self._ways]

    def next(self, examples: tuple[Message, ...], time: float) -> tuple[str, bytes]:
        """Return the name of the mutation and the message."""
        _, name, way = self.random.choices(self._ways, self._weights)[0]
        self.sequence += 1
        head = {"session": self.session, "id": self.random.randrange(2)}
        if examples is COMMANDS:
            head |= {"sequence": self.sequence, "time": time, "ttl": 1.0}
        made = way({**self.random.choice(examples), **head})
        data = made if isinstance(made, bytes) else encode(made)
        if len(data) < 1000 and self.random.random() < 0.01:
            self._kept = [*self._kept[-63:], data]
        return name, data

    def hello(self) -> tuple[str, bytes]:
        """Return a mutated hello, or a stop."""
        if self.random.random() < 0.2:
            return "stop", encode({**STOP, "id": self.random.choice(["", -1, math.nan, [], {}])})
        ways: tuple[tuple[str, Callable[[Message], Any]], ...] = (
            ("hello, odd", self._set_odd_value), ("hello, missing", self._remove_value), ("hello, good", self._leave),
        )  # fmt: skip
        name, way = self.random.choice(ways)
        return name, encode(way(HELLO))

    def _at(self, message: Message) -> tuple[Any, ...]:
        return self.random.choice(places(message))

    def _set_odd_value(self, message: Message) -> Any:
        return replace_value(message, self._at(message), lambda _: self.random.choice(ODD))

    def _remove_value(self, message: Message) -> Any:
        at = self._at(message)
        if not at:
            return b""

        def without(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: inner for key, inner in value.items() if key != at[-1]}
            return [inner for n, inner in enumerate(value) if n != at[-1]]

        return replace_value(message, at[:-1], without)

    def _misplace_object(self, message: Message) -> Any:
        other = self.random.choice(list(OBJECTS.values()))
        return replace_value(message, self._at(message), lambda _: other)

    def _change_type(self, message: Message) -> Any:
        at = self.random.choice([p for p in places(message) if p and p[-1] == "type"])
        return replace_value(message, at, lambda _: self.random.choice(TYPES))

    def _add_field(self, message: Message) -> Any:
        return {**message, "a" * self.random.randrange(1, 60): self.random.choice(ODD)}

    def _set_number(self, message: Message) -> Any:
        value = struct.unpack("<d", self.random.randbytes(8))[0]
        numbers = [p for p in places(message) if isinstance(_get(message, p), float)]
        return replace_value(message, self.random.choice(numbers or [()]), lambda _: value)

    def _replace_bulk(self, message: Message) -> Any:
        found = [p for p in places(message) if p[-1:] != ("session",)]
        found = [p for p in found if isinstance(_get(message, p), bytes)]
        value = self.random.randbytes(self.random.choice([1, 4, 12, 28, 312, 3000]))
        return replace_value(message, self.random.choice(found or [()]), lambda _: value)

    def _change_sequence(self, message: Message) -> Any:
        wrong = self.random.choice([-1, 0, 1, self.sequence, 2**53, 2**60, 1.5, "1"])
        return {**message, "sequence": wrong if wrong != 2**53 else 1, "time": -1e9}

    def _change_session(self, message: Message) -> Any:
        return {**message, "session": self.random.randbytes(self.random.choice([0, 15, 16, 17]))}

    def _leave(self, message: Message) -> Any:
        return message

    def _put_many(self, message: Message) -> Any:
        item = self.random.choice(list(OBJECTS.values()))
        return {**message, "type": "put", "objects": {str(n): item for n in range(300)}}

    def _nest(self, message: Message) -> bytes:
        opening = self.random.choice([b"\x91", b"\x81\xa1a", b"\x81\xa7objects"])
        return opening * self.random.randrange(100, DEEP) + b"\xc0" * self.random.randrange(2)

    def _flip_bits(self, message: Message) -> bytes:
        data = bytearray(encode(message))
        for _ in range(self.random.randrange(1, 4)):
            data[self.random.randrange(len(data))] ^= 1 << self.random.randrange(8)
        return bytes(data)

    def _cut(self, message: Message) -> bytes:
        data = encode(message)
        return data[: self.random.randrange(len(data))]

    def _join_messages(self, message: Message) -> bytes:
        return encode(message) + self.random.choice(self._kept)

    def _replay_message(self, message: Message) -> bytes:
        return self.random.choice(self._kept)

    def _declare_length(self, message: Message) -> bytes:
        head = b"" if self.random.random() < 0.5 else b"\x82\xa4type\xa3put\xa7objects"
        return head + self.random.choice(LENGTHS) + b"\xff" * 4 + self.random.randbytes(8)

    def _break_text(self, message: Message) -> bytes:
        text = self.random.choice(
            [b"\xa2\xff\xfe", b"\xa3\xed\xa0\x80", b"\xa1\x80", b"\xa2\xc0\xaf"]
        )
        key = self.random.choice([b"type", b"client", b"names", b"objects"])
        return b"\x81" + bytes([0xA0 + len(key)]) + key + text

    def _repeat_key(self, message: Message) -> bytes:
        data = encode(message)
        pairs = b"".join(encode(k) + encode(v) for k, v in message.items())
        return bytes([data[0] + 1]) + pairs + encode("type") + encode(message["type"])

    def _randomise(self, message: Message) -> bytes:
        return self.random.randbytes(self.random.choice([0, 1, 2, 16, 100, 1000]))

    def _pad(self, message: Message) -> bytes:
        return self.random.choice([b"\x90", b"\x80", b"\xc0"]) * self.random.randrange(
            MAX_LONG_BYTES
        )


def _get(message: Any, at: tuple[Any, ...]) -> Any:
    for key in at:
        message = message[key]
    return message
