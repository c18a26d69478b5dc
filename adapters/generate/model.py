"""The messages of `pacinian.wire` without Python types, as the generators of other languages read them.

`wire.read()` creates the Model. A type is one of:

    Bool Int Float Text Words Bin      single values with their bounds
    Fixed                              an array of a fixed length: `Fixed(Float, 3)` is a position
    Array Map                          arrays of one type; maps from text to one type
    Part                               another message, by its name
    Union                              one of several messages with different `type`s, or one of several words
    Scalar Anything                    a bool, int, float or text; any value of MessagePack
    Maybe                              one of these, or nil

Rules for `bin` fields (`Message.bulk`) are those of `pacinian.wire.binary_arrays`: Rows, Grid, Indices. A reader checks
them in order after all fields were read and each is valid by itself. Lengths of text are in code points, those of `bin`
in bytes. A bound of None means no bound. An Int without bounds is signed and has 64 bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pacinian.wire.binary_arrays import Grid, Indices, Rows


@dataclass(frozen=True)
class Bool:
    """A boolean."""


@dataclass(frozen=True)
class Int:
    """An integer in low..high."""

    low: int | None = None
    high: int | None = None


@dataclass(frozen=True)
class Float:
    """A number in low..high, without NaN; without bounds, any number including NaN. above: low itself is excluded."""

    low: float | None = None
    high: float | None = None
    above: bool = False


@dataclass(frozen=True)
class Text:
    """Text of `least` to `most` code points."""

    least: int = 0
    most: int | None = None


@dataclass(frozen=True)
class Words:
    """One of several words. name: of the enumeration."""

    name: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class Bin:
    """`least` to `most` bytes."""

    least: int = 0
    most: int | None = None


@dataclass(frozen=True)
class Fixed:
    """An array of `count` numbers."""

    item: Int | Float
    count: int


@dataclass(frozen=True)
class Array:
    """An array of `least` to `most` items."""

    item: Type
    least: int = 0
    most: int | None = None


@dataclass(frozen=True)
class Map:
    """A map of at most `most` keys. If a key is repeated, the last value counts."""

    key: Text
    item: Type
    most: int | None = None


@dataclass(frozen=True)
class Part:
    """A message, by its name."""

    name: str


@dataclass(frozen=True)
class Union:
    """One of several messages, by their names, or one of several words. base: the base of all these messages, or ""."""

    name: str
    kinds: tuple[str, ...]
    words: Words | None = None
    base: str = ""


@dataclass(frozen=True)
class Scalar:
    """A bool, an int, a float or a text, each with its bounds."""

    whole: Int
    real: Float
    text: Text


@dataclass(frozen=True)
class Anything:
    """Any value of MessagePack."""


@dataclass(frozen=True)
class Maybe:
    """An item or nil."""

    item: Type


Type = (
    Bool
    | Int
    | Float
    | Text
    | Words
    | Bin
    | Fixed
    | Array
    | Map
    | Part
    | Union
    | Scalar
    | Anything
    | Maybe
)


@dataclass(frozen=True)
class Field:
    """A field of a message.

    needed: it has no default. default: None, bool, int, float, text, bytes, a tuple of numbers; () for an empty array
    or map; a Part for that message with all its defaults. text: its description. bounds: in words, with the unit.
    """

    name: str
    type: Type
    needed: bool
    default: Any
    text: str
    bounds: str


@dataclass(frozen=True)
class Message:
    """A message, or a part of one.

    tag: its `type`, the first key on the wire, or "" for a part without. base: the message from which its first fields
    come, or "". fields: all fields in order. bulk: rules for its `bin` fields. module: of `pacinian.wire`.
    """

    name: str
    tag: str
    base: str
    module: str
    text: str
    fields: tuple[Field, ...]
    bulk: tuple[Rows | Grid | Indices, ...]


@dataclass(frozen=True)
class Model:
    """The whole wire.

    messages: each after those that it contains. bases: bases of messages; never on the wire themselves. words, unions:
    by name. sockets: the messages of each, and the most bytes. constants: numbers of the protocol. written, heard:
    names of the messages, bases, words and unions that a client writes, and that it reads.
    """

    messages: tuple[Message, ...]
    bases: tuple[Message, ...]
    words: tuple[Words, ...]
    unions: tuple[Union, ...]
    sockets: dict[str, tuple[Union, int]]
    constants: dict[str, int | float]
    written: frozenset[str]
    heard: frozenset[str]


def is_whole(model: Model, name: str) -> bool:
    """Return whether a client both writes and reads the type with this name."""
    return name in model.written and name in model.heard
