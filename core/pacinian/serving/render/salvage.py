"""Changes, decoded; where one of them is damaged, the others."""

from __future__ import annotations

import msgspec
from msgspec.msgpack import Decoder

from pacinian.serving.ipc.messages import AnyChange, Changes

_changes, _change = Decoder(Changes), Decoder(AnyChange)
_parts = Decoder(tuple[int, int, list[msgspec.Raw]])


def changes_of(data: bytes) -> tuple[Changes, int]:
    """The changes, and how many are none. Raises msgspec.DecodeError, msgspec.ValidationError."""
    try:
        return _changes.decode(data), 0
    except msgspec.ValidationError:
        number, run, parts = _parts.decode(data)
        found: list[AnyChange] = []
        for part in parts:
            try:
                found.append(_change.decode(part))
            except msgspec.ValidationError:
                continue
        return Changes(number, run, tuple(found)), len(parts) - len(found)
