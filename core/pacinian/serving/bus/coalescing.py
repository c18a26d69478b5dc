"""Of messages that came together, those that matter: of moves of the same objects, and of hands, the newest.

What a newer one replaces is not decoded, so that a client which sends more than can be done is late with nothing.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import msgspec
from msgspec import Raw, Struct

REPLACED = "move", "hands"  # of these, one says all that one before it said


class Message(NamedTuple):
    """What came: over which connection, of which user, and when [s]."""

    peer: bytes
    user: str
    data: bytes
    time: float


class _Glance(Struct):
    """What tells whether one message replaces another; the rest is not looked at."""

    type: str
    session: bytes
    names: Raw = Raw(b"")
    id: int = 0


_decoder = msgspec.msgpack.Decoder(_Glance)


def coalesce(messages: list[Message]) -> tuple[list[Message], Counter[bytes]]:
    """Those that are to be done, in their order; how many of each session were replaced by another of its own.

    One that is to be answered is always done, and so is what cannot be read.
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
