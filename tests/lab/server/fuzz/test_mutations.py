from __future__ import annotations

from collections import Counter
from random import Random

import msgspec
import pytest

from pacinian.errors import WireError
from pacinian.wire.codec import decode_command, decode_control
from pacinian.wire.commands import COMMANDS as KINDS
from pacinian.wire.control import Arm, Bye, Hello, Stop
from pacinian_lab.server.fuzz.messages import COMMANDS, CONTROLS, HELLO
from pacinian_lab.server.fuzz.mutations import Spoiler, encode, places, replace_value
from pacinian_lab.server.fuzz.packets import packet, within

HEAD = {"session": b"k" * 16, "id": 1, "sequence": 1, "time": 0.0}


def test_the_examples_are_good_and_there_is_one_of_each_command() -> None:
    seen = {type(decode_command(encode({**message, **HEAD}))) for message in COMMANDS}
    assert seen == set(KINDS)
    for message in CONTROLS:
        decode_control(encode({**HEAD, **message}))
    assert isinstance(decode_control(encode(HELLO)), Hello)


def test_the_same_seed_spoils_alike_and_another_does_not() -> None:
    def some(seed: int) -> list[tuple[str, bytes]]:
        spoiler = Spoiler(Random(seed), b"k" * 16)
        return [spoiler.next(COMMANDS, 1.0) for _ in range(200)]

    assert some(1) == some(1) != some(2)


def test_whatever_is_made_is_a_message_or_a_wire_error_and_each_way_is_gone() -> None:
    spoiler, refused, taken = Spoiler(Random(3), b"k" * 16), Counter[str](), Counter[str]()
    for n in range(4000):
        examples, decode = ((COMMANDS, decode_command), (CONTROLS, decode_control))[n % 2]
        name, data = spoiler.next(examples, 1.0)
        try:
            decode(data)
            taken[name] += 1
        except WireError:
            refused[name] += 1
    assert {"random bytes", "deep", "length bomb", "bad UTF-8", "cut", "odd value"} <= set(refused)
    assert {"good", "unknown field", "twice", "session"} <= set(taken)
    assert not taken["random bytes"] + taken["bad UTF-8"] + taken["length bomb"]


@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_a_good_stop_or_takes_the_output(seed: int) -> None:
    spoiler = Spoiler(Random(seed), b"k" * 16)
    for _ in range(3000):
        for _, data in (spoiler.next(CONTROLS, 1.0), spoiler.hello()):
            try:
                assert not isinstance(decode_control(data), Stop | Arm | Bye)
            except WireError:
                continue


def test_places_and_replacing() -> None:
    value = {"a": [1, {"b": 2}]}
    assert places(value) == [(), ("a",), ("a", 0), ("a", 1), ("a", 1, "b")]
    assert replace_value(value, ("a", 1, "b"), lambda v: v + 1) == {"a": [1, {"b": 3}]}
    assert value == {"a": [1, {"b": 2}]}


def test_packets_are_of_many_kinds_and_bytes() -> None:
    random = Random(1)
    made = [make(random) for make in (packet, within) for _ in range(500)]
    assert len({name for name, _ in made}) > 25
    assert all(isinstance(data, bytes) for _, data in made)
    assert msgspec.msgpack.decode(encode({"a": 1})) == {"a": 1}
