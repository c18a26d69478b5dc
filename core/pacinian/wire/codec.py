"""Bytes to messages, and back. Whatever the bytes are, they either make a valid message or a WireError.

Nothing is allocated that the bytes do not hold: msgspec checks lengths and types while it reads, skips what it
does not know, and refuses what is nested deeper than Python's recursion limit. Of a key that comes twice the last
one counts.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
from msgspec import Struct
from msgspec.msgpack import Decoder, Encoder

from pacinian.errors import WireError
from pacinian.wire.commands import AnyCommand
from pacinian.wire.control import CONTROLS, AnyControl
from pacinian.wire.protocol import MAX_COMMAND_BYTES, MAX_CONTROL_BYTES, MAX_REPLY_BYTES, Id
from pacinian.wire.replies import AnyReply
from pacinian.wire.state import AnyState, State

if TYPE_CHECKING:
    Bytes = bytes | bytearray | memoryview

T = TypeVar("T")

PROBLEM, PATH = 300, 200  # characters that are told
FIELD = re.compile(r"(?:Object missing required field )?`(\w+)`")  # named by a problem
WRONG = (
    msgspec.MsgspecError,
    ValueError,
    TypeError,
    OverflowError,
    RecursionError,
    MemoryError,
)


class _Known(Struct):
    """What is looked for in a message that is not valid."""

    id: Id = 0


_encoder = Encoder()
_commands: Decoder[AnyCommand] = Decoder(AnyCommand)
_controls: Decoder[AnyControl] = Decoder(AnyControl)
_replies: Decoder[AnyReply | State] = Decoder(AnyReply | State)
_states: Decoder[AnyState] = Decoder(AnyState)
_known = Decoder(_Known)


def encode(message: Struct) -> bytes:
    """A message as bytes: fields in their order, defaults too. Raises WireError if it is too long."""
    try:
        data = _encoder.encode(message)
    except WRONG as error:
        raise _explained(error) from error
    most = MAX_CONTROL_BYTES if isinstance(message, CONTROLS) else MAX_COMMAND_BYTES
    if len(data) > most:
        raise _too_long(data, most)
    return data


def decode_command(data: Bytes) -> AnyCommand:
    """A message of the command socket. Raises WireError."""
    return _decode(_commands, data, MAX_COMMAND_BYTES)


def decode_control(data: Bytes) -> AnyControl:
    """A message of the control socket. Raises WireError."""
    return _decode(_controls, data, MAX_CONTROL_BYTES)


def decode_reply(data: Bytes) -> AnyReply | State:
    """A message of the server. Raises WireError."""
    return _decode(_replies, data, MAX_REPLY_BYTES)


def decode_state(data: Bytes) -> AnyState:
    """What the server publishes, without its topic. Raises WireError."""
    return _decode(_states, data, MAX_REPLY_BYTES)


def checked(decoder: Decoder[T], value: Any, path: str = "$") -> T:
    """A part of a message that is at `path`, if it is valid. Raises WireError."""
    try:
        return decoder.decode(_encoder.encode(value))
    except WRONG as error:
        raised = _explained(error)
        raise WireError(raised.problem, path + raised.path.removeprefix("$")) from error


def id_of(data: Bytes) -> int:
    """The `id` of a message that is not valid, so that the error can be told; 0 if it has none."""
    try:
        return _decode(_known, data, MAX_COMMAND_BYTES).id
    except WireError:
        return 0


def _decode(decoder: Decoder[T], data: Bytes, most: int) -> T:
    if len(data) > most:
        raise _too_long(data, most)
    try:
        return decoder.decode(data)
    except WRONG as error:
        raise _explained(error) from error


def _too_long(data: Bytes, most: int) -> WireError:
    return WireError(f"is {len(data):,} bytes: keep to {most:,}", "$")


def _explained(error: Any) -> WireError:
    if isinstance(error, RecursionError):
        return WireError("is nested too deeply", "$")
    if isinstance(error, MemoryError):
        return WireError("is too large", "$")
    problem, _, path = str(error).rpartition(" - at `")
    problem, path = (problem, path) if problem else (str(error), "$")
    path = path.rstrip("`").removeprefix("key` in `")
    if field := FIELD.match(problem):
        path = f"{path}.{field[1]}"
    return WireError(problem[:PROBLEM], path[:PATH])
