from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Any

import msgpack
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.errors import WireError
from pacinian.wire.codec import encode, id_of
from pacinian.wire.commands import Envelopes, Put
from pacinian.wire.control import Select
from pacinian.wire.convert import envelope_to_scene, technique_to_scene, to_scene
from pacinian_lab.vectors.examples import make_examples
from pacinian_lab.vectors.vectors import DECODE

if TYPE_CHECKING:
    from collections.abc import Iterator


bounded = settings(max_examples=400)

PLAIN = [(socket, msgpack.unpackb(encode(message))) for _, socket, message in make_examples()]


def changed(value: Any, path: tuple[Any, ...], new: object) -> Any:
    if not path:
        return new
    made = value.copy()
    made[path[0]] = changed(value[path[0]], path[1:], new)
    return made


JUNK = st.sampled_from(
    [
        *(None, True, 0, -1, 2**63, -(2**63), 2**64 - 1, 1.0, math.nan, math.inf, "", "x" * 300),
        *(b"", bytes(3), bytes(12), bytes(84), [], [[]] * 40, {}, {"type": "sphere"}, {"": {}}),
        *(msgpack.ExtType(5, b"1"), msgpack.Timestamp(1), [0.0, 0.0, 0.0], "sphere", "put"),
    ]
)


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield path
    items = value.items() if isinstance(value, dict) else ()
    items = enumerate(value) if isinstance(value, list) else items
    for key, item in items:
        yield from places(item, (*path, key))


ALL = [(socket, plain, list(places(plain))) for socket, plain in PLAIN]


def convert(message: Any) -> None:
    match message:
        case Put(objects=objects):
            for name, item in objects.items():
                to_scene(name, item)
        case Envelopes(envelope=envelope):
            envelope_to_scene(envelope)
        case Select(technique=technique) if technique is not None:
            technique_to_scene(technique)


def survives(data: bytes) -> None:
    """Check that decoders either read bytes, and read their own encoding equally, or raise WireError with a path.

    What they read becomes objects of the scene, or the conversion raises WireError with a path.
    """
    assert 0 <= id_of(data) < 2**32
    for decode in DECODE.values():
        try:
            message = decode(data)
            again = encode(message)
            assert encode(decode(again)) == again
            convert(message)
        except WireError as error:
            told = error
        else:
            continue
        assert told.path.startswith("$")
        assert len(told.path) <= 200
        assert told.problem


@bounded
@given(
    which=st.sampled_from(ALL),
    seed=st.integers(0, 2**32 - 1),
    junk=st.lists(JUNK, min_size=1, max_size=3),
    known=st.booleans(),
)
def test_messages_with_any_value_anywhere_are_survived(
    which: Any, seed: int, junk: list[Any], known: bool
) -> None:
    _, plain, held = which
    choose = random.Random(seed)
    for value in junk:
        place = choose.choice(held)
        new = [*place, "later"] if isinstance(value, dict) and not known else place
        try:
            plain = changed(plain, tuple(new), value)
        except (AttributeError, TypeError, IndexError, KeyError):
            continue  # an earlier change has removed that place
    survives(msgpack.packb(plain, strict_types=False))


@bounded
@given(which=st.sampled_from(ALL), seed=st.integers(0, 2**32 - 1), times=st.integers(1, 4))
def test_messages_with_any_byte_changed_are_survived(which: Any, seed: int, times: int) -> None:
    data, choose = bytearray(msgpack.packb(which[1])), random.Random(seed)
    for _ in range(times):
        i = choose.randrange(len(data) + 1)
        how = choose.randrange(4)
        if how == 0:
            data[i : i + 1] = bytes([choose.randrange(256)])
        elif how == 1:
            del data[i : i + choose.randrange(1, 9)]
        elif how == 2:
            data[i:i] = choose.choice([b"\xdd\xff\xff\xff\xff", b"\x91", b"\xc1", b"\x82", b"\xcb"])
        else:
            data[i:i] = data[: choose.randrange(20)]
        data = data or bytearray(1)
    survives(bytes(data))


@bounded
@given(data=st.binary(max_size=200))
def test_any_bytes_are_survived(data: bytes) -> None:
    survives(data)
