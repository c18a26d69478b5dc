"""Coalescing: of the messages received together, keep only the newest hands, and the newest move of the same objects.

Superseded messages are not decoded, so an overloading client does not build up latency.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import msgspec
from msgspec import Raw, Struct

REPLACED = "move", "hands"  # kinds of messages of which a newer one replaces the older


class Message(NamedTuple):
    """A received message: its connection, user, data and time of receipt [s]."""

    peer: bytes
    user: str
    data: bytes
    time: float


class _Glance(Struct):
    """The fields that tell whether one message supersedes another; the others are not decoded."""

    type: str
    session: bytes
    names: Raw = Raw(b"")
    id: int = 0


_decoder = msgspec.msgpack.Decoder(_Glance)


def coalesce(messages: list[Message]) -> tuple[list[Message], Counter[bytes]]:
    """Drop superseded messages. Return the rest in order, and the number of superseded messages by session.

    A message that expects a reply is always kept, and so is one that cannot be decoded.
    """
    replaced: Counter[bytes] = Counter()
    if len(messages) < 2:
        return messages, replaced
    seen: set[tuple[bytes, bytes, str, bytes]] = set()
    kept: list[Message] = []
    for message in reversed(messages):
        try:
            glance = _decoder.decode(message.data)
        except (msgspec.MsgspecError, ValueError, RecursionError, MemoryError):
            kept.append(message)
            continue
        if glance.type in REPLACED and not glance.id:
            key = message.peer, glance.session, glance.type, bytes(glance.names)
            if key in seen:
                replaced[glance.session] += 1
                continue
            seen.add(key)
        kept.append(message)
    kept.reverse()
    return kept, replaced
