"""Codec: bytes to messages and back. Any bytes give either a valid message or a WireError.

Memory use is bounded by the bytes received: msgspec checks lengths and types while it reads, skips unknown fields, and
refuses messages that are nested deeper than Python's recursion limit. If a key occurs twice, the last one counts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from msgspec import Struct
from msgspec.msgpack import Decoder, Encoder

from pacinian.errors import WireError
from pacinian.wire.commands import AnyCommand
from pacinian.wire.control import CONTROLS, AnyControl
from pacinian.wire.decode_errors import CODEC_ERRORS, convert_error
from pacinian.wire.protocol import MAX_COMMAND_BYTES, MAX_CONTROL_BYTES, MAX_REPLY_BYTES, Id
from pacinian.wire.replies import AnyReply
from pacinian.wire.state import AnyState, State

if TYPE_CHECKING:
    Bytes = bytes | bytearray | memoryview

T = TypeVar("T")


class _Known(Struct):
    """The only field that is read from an invalid message."""

    id: Id = 0


def _make_plain(value: object) -> object:
    """Return a NumPy scalar as a number of Python. Raises TypeError for other values."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a value of type {type(value).__name__} cannot be sent")


_encoder = Encoder(enc_hook=_make_plain)
_commands: Decoder[AnyCommand] = Decoder(AnyCommand)
_controls: Decoder[AnyControl] = Decoder(AnyControl)
_replies: Decoder[AnyReply | State] = Decoder(AnyReply | State)
_states: Decoder[AnyState] = Decoder(AnyState)
_known = Decoder(_Known)


def encode(message: Struct) -> bytes:
    """Encode a message, with its fields in order and with defaults. Raises WireError if it is too long."""
    try:
        data = _encoder.encode(message)
    except CODEC_ERRORS as error:
        raise convert_error(error) from error
    most = MAX_CONTROL_BYTES if isinstance(message, CONTROLS) else MAX_COMMAND_BYTES
    if len(data) > most:
        raise _too_long(data, most)
    return data


def decode_command(data: Bytes) -> AnyCommand:
    """Decode a message from the command socket. Raises WireError."""
    return _decode(_commands, data, MAX_COMMAND_BYTES)


def decode_control(data: Bytes) -> AnyControl:
    """Decode a message from the control socket. Raises WireError."""
    return _decode(_controls, data, MAX_CONTROL_BYTES)


def decode_reply(data: Bytes) -> AnyReply | State:
    """Decode a reply of the server. Raises WireError."""
    return _decode(_replies, data, MAX_REPLY_BYTES)


def decode_state(data: Bytes) -> AnyState:
    """Decode a published message, without its topic. Raises WireError."""
    return _decode(_states, data, MAX_REPLY_BYTES)


def check_part(decoder: Decoder[T], value: Any, path: str = "$") -> T:
    """Validate the part of a message at `path` and return it. Raises WireError."""
    try:
        return decoder.decode(_encoder.encode(value))
    except CODEC_ERRORS as error:
        raised = convert_error(error)
        raise WireError(raised.problem, path + raised.path.removeprefix("$")) from error


def id_of(data: Bytes) -> int:
    """Return the `id` of an invalid message, so that the error can be answered; 0 if it has none."""
    try:
        return _decode(_known, data, MAX_COMMAND_BYTES).id
    except WireError:
        return 0


def _decode(decoder: Decoder[T], data: Bytes, most: int) -> T:
    if len(data) > most:
        raise _too_long(data, most)
    try:
        return decoder.decode(data)
    except CODEC_ERRORS as error:
        raise convert_error(error) from error


def _too_long(data: Bytes, most: int) -> WireError:
    return WireError(f"is {len(data):,} bytes: keep to {most:,}", "$")
