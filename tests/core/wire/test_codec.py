from __future__ import annotations

import math
import tracemalloc
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import msgpack
import msgspec
import numpy as np
import pytest

from pacinian.errors import WireError
from pacinian.wire import (
    codec,
    commands,
    control,
    decode_errors,
    objects,
    protocol,
    replies,
    shapes,
    state,
)
from pacinian.wire.codec import (
    check_part,
    decode_command,
    decode_control,
    decode_reply,
    decode_state,
    encode,
    id_of,
)
from pacinian_lab.vectors.examples import make_examples
from pacinian_lab.vectors.vectors import DECODE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


EXAMPLES = list(make_examples())
PLAIN = [(socket, msgpack.unpackb(encode(message))) for _, socket, message in EXAMPLES]
STOP = encode(control.Stop(id=5))
CLEAR = encode(commands.Clear(session=bytes(16), sequence=1, time=0.0))


def test_a_message_is_the_same_after_the_wire() -> None:
    for _, socket, message in EXAMPLES:
        assert DECODE[socket](encode(message)) == message
        assert DECODE[socket](memoryview(encode(message))) == message


@contextmanager
def allocating(most: int) -> Iterator[None]:
    """Check that less than this number of bytes is allocated at any time."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < most
    finally:
        tracemalloc.stop()


def refused(decode: Callable[[Any], object], data: bytes, path: str = "$") -> WireError:
    with pytest.raises(WireError) as caught:
        decode(data)
    assert caught.value.path == path
    return caught.value


# known mistakes of MessagePack readers


@pytest.mark.parametrize("head", [b"\xdd", b"\xdf", b"\xc6", b"\xdb"])
@pytest.mark.parametrize(
    "place", [b"", b"\x82\xa4type\xa4stop\xa2id", b"\x82\xa4type\xa4stop\xa1x"]
)
def test_a_length_bomb_allocates_nothing(head: bytes, place: bytes) -> None:
    with allocating(100_000):
        for decode in DECODE.values():
            with pytest.raises(WireError):
                decode(place + head + b"\xff\xff\xff\xff")


@pytest.mark.parametrize("wrap", [b"\x91", b"\x81\xa1a"], ids=["array", "map"])
@pytest.mark.parametrize("depth", [1, 100, 1000, 20_000])
def test_what_is_nested_deeply_is_refused_or_skipped(wrap: bytes, depth: int) -> None:
    known = b"\x82\xa4type\xa4stop\xa2id" + wrap * depth + b"\xc0"
    refused(decode_control, known, "$.id")
    unknown = b"\x83\xa4type\xa4stop\xa2id\x05\xa1x" + wrap * depth + b"\xc0"
    assert id_of(unknown) in ((5,) if depth <= 100 else (0, 5))
    try:
        skipped = decode_control(unknown) == control.Stop(id=5)
    except WireError:
        skipped = depth > 100  # near Python's recursion limit
    assert skipped


def test_a_million_levels_neither_crash_nor_allocate() -> None:
    data = CLEAR[:-1].replace(b"\x86", b"\x87", 1) + b"\x00\xa1x" + b"\x91" * 1_000_000 + b"\xc0"
    with allocating(100_000):
        assert "deep" in refused(decode_command, data).problem


def test_a_mebibyte_of_empty_lists_is_skipped_without_a_list() -> None:
    many = 1_000_000
    data = b"\x87" + CLEAR[1:] + b"\xa1x\xdd" + many.to_bytes(4, "big") + b"\x90" * many
    with allocating(100_000):
        assert isinstance(decode_command(data), commands.Clear)


def test_too_many_of_anything_are_refused_before_they_are_read() -> None:
    many = 250_000
    head = b"\x87" + CLEAR[1:].replace(b"clear", b"remove").replace(b"\xa5remove", b"\xa6remove")
    for names in (b"\x90" * many, b"\xa1a" * many):
        data = head + b"\xa5names\xdd" + many.to_bytes(4, "big") + names
        with allocating(100_000):
            refused(decode_command, data, "$.names")


def test_a_message_of_many_small_things_takes_a_few_times_its_length() -> None:
    parts = (shapes.Placed(shapes.Sphere(0.1), shapes.Pose((0.1, 0.2, 0.3))),) * protocol.MAX_PARTS
    item = objects.Volume(shape=shapes.Union(parts), force=1.0)
    many = {str(i): item for i in range(protocol.MAX_OBJECTS)}
    data = encode(commands.Put(session=bytes(16), sequence=1, time=0.0, objects=many))
    least = data.replace(
        b"\xcb\x00" + bytes(7), b"\x00"
    )  # zeros in one byte, as the shortest encoding
    with allocating(8 * len(least)):
        decode_command(least)


@pytest.mark.parametrize("key", [b"\x05", b"\x90", b"\xc0", b"\xcb" + bytes(8), b"\xc4\x01a"])
def test_a_key_that_is_no_text_is_refused(key: bytes) -> None:
    refused(decode_control, b"\x82\xa4type\xa4stop" + key + b"\x05")


def test_of_a_key_that_comes_twice_the_last_counts() -> None:
    twice = b"\x83" + STOP[1:] + b"\xa2id\x06"
    assert decode_control(twice) == control.Stop(id=6)


def test_an_extension_type_is_refused_where_it_is_read_and_skipped_where_not() -> None:
    refused(decode_control, b"\x82\xa4type\xa4stop\xa2id\xd4\x05\x00", "$.id")
    assert decode_control(b"\x82\xa4type\xa4stop\xa1x\xd4\x05\x00") == control.Stop()


@pytest.mark.parametrize("name", ["time", "ttl"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300, True, "1", None])
def test_numbers_that_are_none_are_refused(name: str, value: object) -> None:
    plain = msgpack.unpackb(CLEAR) | {name: value}
    refused(decode_command, msgpack.packb(plain), f"$.{name}")


def number_places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from number_places(item, (*path, key))
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from number_places(item, (*path, i))
    elif isinstance(value, float):
        yield path


def changed(value: Any, path: tuple[Any, ...], new: object) -> Any:
    if not path:
        return new
    made = value.copy()
    made[path[0]] = changed(value[path[0]], path[1:], new)
    return made


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_no_number_of_a_client_may_be_nan_or_infinite(wrong: float) -> None:
    places = [
        (socket, plain, place)
        for socket, plain in PLAIN
        if socket in ("command", "control")
        for place in number_places(plain)
    ]
    assert len(places) > 100
    for socket, plain, place in places:
        with pytest.raises(WireError):
            DECODE[socket](msgpack.packb(changed(plain, place, wrong)))


def bin_places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], bytes]]:
    if isinstance(value, bytes) and path[-1] != "session":
        yield path, value
    elif isinstance(value, (dict, list)):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, item in items:
            yield from bin_places(item, (*path, key))


@pytest.mark.parametrize("wrong", [b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f", b"\xff\xff\xff\xff"])
def test_no_bulk_number_may_be_nan_or_infinite_but_in_hands(wrong: bytes) -> None:
    seen = set()
    for socket, plain in PLAIN:
        for place, data in bin_places(plain) if socket == "command" else ():
            sent = msgpack.packb(changed(plain, place, wrong + data[4:]))
            if plain["type"] == "hands" or not data:
                continue
            with pytest.raises(WireError):
                DECODE[socket](sent)
            seen.add(place[-1])
    assert seen >= {"poses", "velocities", "points", "positions", "vertices", "faces", "heights"}
    assert seen >= {"values", "samples"}


def test_bulk_numbers_that_are_no_rows_are_refused() -> None:
    for socket, plain in PLAIN:
        for place, data in bin_places(plain) if socket == "command" else ():
            for wrong in (data[:-1], data + b"\x00", data[: len(data) // 2 + 1]):
                if wrong and len(wrong) != len(data):
                    with pytest.raises(WireError):
                        DECODE[socket](msgpack.packb(changed(plain, place, wrong)))


def test_text_that_is_not_utf_8_is_refused() -> None:
    refused(decode_control, STOP.replace(b"stop", b"st\xffp"))
    hello = encode(control.Hello(protocol=(1, 0), client="game"))
    refused(decode_control, hello.replace(b"game", b"g\xc3\x28e"))


@pytest.mark.parametrize(
    "data", [b"", b"\xc1", b"\xc0", b"\x05", b"\x90", STOP[:-1], STOP + b"\x00", b"GET / HTTP/1.1"]
)
def test_what_is_no_message_is_refused(data: bytes) -> None:
    for decode in DECODE.values():
        with pytest.raises(WireError):
            decode(data)


def test_what_is_too_long_is_refused_unread() -> None:
    long = bytes(protocol.MAX_COMMAND_BYTES + 1)
    for decode in DECODE.values():
        assert "1,04" in refused(decode, long).problem or "65,536" in refused(decode, long).problem
    refused(decode_control, STOP + bytes(protocol.MAX_CONTROL_BYTES))
    assert id_of(long) == 0


def test_nothing_too_long_is_sent() -> None:
    mesh = objects.Particles(positions=bytes(1_200_000), force=1.0)
    put = commands.Put(session=bytes(16), sequence=1, time=0.0, objects={"a": mesh})
    refused(encode, put)  # type: ignore[arg-type]
    refused(encode, control.Hello(protocol=(1, 0), client="x" * 70_000))  # type: ignore[arg-type]


@pytest.mark.parametrize("wrong", ["\ud800", 1 << 70, object()])
def test_what_cannot_be_written_is_told(wrong: Any) -> None:
    refused(encode, replies.Plugin(name="a", options={"x": wrong}))  # type: ignore[arg-type]


def test_a_missing_field_is_named_in_the_path() -> None:
    refused(decode_control, msgpack.packb({"type": "bye"}), "$.session")


def test_a_problem_is_told_in_few_words() -> None:
    long = msgpack.packb({"type": "x" * 60_000})
    assert len(str(refused(decode_control, long, "$.type"))) < 400
    odd = msgpack.packb({"type": "stop - at `$.id`"})
    refused(decode_control, odd, "$.type")


def test_the_id_of_a_message_that_is_not_valid() -> None:
    assert id_of(msgpack.packb({"type": "nothing", "id": 7, "x": [1, {"y": 2}]})) == 7
    assert id_of(encode(commands.Clear(session=b"short", sequence=0, time=0.0, id=9))) == 9
    for data in (
        b"",
        b"\xc1",
        msgpack.packb([]),
        msgpack.packb({"id": -1}),
        msgpack.packb({"id": "7"}),
    ):
        assert id_of(data) == 0


def test_each_socket_has_its_own_messages() -> None:
    for _, socket, message in EXAMPLES:
        for other, decode in DECODE.items():
            if other != socket and not isinstance(message, state.State):
                with pytest.raises(WireError):
                    decode(encode(message))
    published = next(m for _, _, m in EXAMPLES if isinstance(m, state.State))
    assert decode_reply(encode(published)) == decode_state(encode(published)) == published


def test_a_part_is_checked_by_its_path() -> None:
    decoder = msgspec.msgpack.Decoder(objects.Material)
    with pytest.raises(WireError) as caught:
        check_part(decoder, objects.Material(-1.0), "$.material")
    assert caught.value.path == "$.material.stiffness"


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.float16, np.int64, np.uint8])
def test_numpy_s_scalars_are_numbers(kind: Any) -> None:
    plain = objects.Point(position=(0.0, 0.0, 0.25), radiation_pressure=2.0)
    x, y, z = kind(0), kind(0), np.float64(0.25)
    numpy = objects.Point(position=(x, y, z), radiation_pressure=kind(2))
    one, two = (
        commands.Put(session=bytes(16), sequence=1, time=0.0, objects={"a": p})
        for p in (plain, numpy)
    )
    assert decode_command(encode(two)) == decode_command(encode(one))


def test_a_truth_of_numpy_is_a_truth() -> None:
    values = msgspec.msgpack.decode(codec._encoder.encode([np.bool_(True), np.str_("a")]))
    assert values == [True, "a"]


@pytest.mark.parametrize("value", [np.ones(2), object(), 1j, np.complex128(1j), {1, 2}.__iter__])
def test_other_values_are_refused_with_their_kind(value: Any) -> None:
    point = objects.Point(position=(0.0, 0.0, 0.2), radiation_pressure=value)
    with pytest.raises(WireError):
        encode(commands.Put(session=bytes(16), sequence=1, time=0.0, objects={"a": point}))


@pytest.mark.parametrize(
    ("field", "known"),
    [
        ("shape", ["rectangle", "disc", "sphere", "height-map", "mesh", "box", "union", "line"]),
        ("envelope", ["sine", "wave", "noise"]),
        ("technique", ["am", "stm", "lm", "simultaneous"]),
    ],
)
def test_a_misspelt_type_is_answered_with_those_that_there_are(
    field: str, known: list[str]
) -> None:
    surface = {
        "type": "surface",
        "shape": {"type": "disc", "radius": 0.01},
        "radiation_pressure": 1.0,
    }
    surface[field] = {"type": "bananaa"}
    message = {
        "type": "put",
        "session": bytes(16),
        "sequence": 1,
        "time": 0.0,
        "objects": {"a": surface},
    }
    error = refused(decode_command, msgspec.msgpack.encode(message), f"$.objects[...].{field}.type")
    for name in known:
        assert name in error.problem
    assert len(error.problem) <= decode_errors.PROBLEM
