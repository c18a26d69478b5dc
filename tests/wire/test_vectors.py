from __future__ import annotations

import itertools
import json
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgpack
import pytest
from msgspec import Struct
from msgspec.structs import fields

from pacinian.errors import WireError
from pacinian.wire import commands, control, modulation, objects, replies, shapes, state
from pacinian.wire.codec import encode
from pacinian_lab.vectors.examples import make_examples
from pacinian_lab.vectors.vectors import DECODE, make_lines, make_text, make_vectors

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
MADE = make_vectors()
FILES = {name: json.loads((HERE / f"{name}.json").read_text(encoding="utf-8")) for name in MADE}


def test_the_files_are_what_is_written() -> None:
    for name, made in MADE.items():
        assert (HERE / f"{name}.json").read_bytes() == make_text(made).encode()


def held(value: object) -> set[type]:
    """The classes of a value, and of all that it holds."""
    if isinstance(value, (tuple, list)):
        return set().union(*map(held, value))
    if isinstance(value, dict):
        return held(list(value.values()))
    fields = getattr(value, "__struct_fields__", None)
    if fields is None:
        return set()
    return {type(value)}.union(*(held(getattr(value, name)) for name in fields))


def test_every_class_of_the_wire_is_in_them() -> None:
    seen = set().union(*(held(message) for _, _, message in make_examples()))
    wanted: set[Any] = {*commands.COMMANDS, *control.CONTROLS, *replies.REPLIES, *state.STATES}
    wanted |= {*objects.OBJECTS, commands.HandFrame, commands.Zone, control.Choice, replies.Plugin}
    for group in (
        shapes.Shell,
        shapes.Solid,
        shapes.Curve,
        modulation.Envelope,
        modulation.Technique,
    ):
        wanted |= {kind for kind in group.__args__ if isinstance(kind, type)}
    assert not wanted - seen
    modules = commands, control, objects, replies, shapes, state, modulation
    all_there_are = {
        kind
        for module in modules
        for kind in vars(module).values()
        if isinstance(kind, type)
        and hasattr(kind, "__struct_fields__")
        and kind.__module__ == module.__name__
    }
    assert all_there_are - seen == {
        commands.Command,
        control.Request,
        replies.Reply,
        objects.HapticObject,
    }


def every(value: object) -> Iterator[tuple[type, str]]:
    """Fields that are not at their default, of a value and of all that it holds."""
    if isinstance(value, (tuple, list)):
        yield from itertools.chain.from_iterable(map(every, value))
    elif isinstance(value, dict):
        yield from every(list(value.values()))
    elif isinstance(value, Struct):
        for field in fields(value):
            if getattr(value, field.name) != field.default:
                yield type(value), field.name
            yield from every(getattr(value, field.name))


def test_every_field_is_in_them_with_something_in_it() -> None:
    seen = {found for _, _, message in make_examples() for found in every(message)}
    kinds = set().union(*(held(message) for _, _, message in make_examples()))
    shared = {*objects.HapticObject.__struct_fields__, *commands.Command.__struct_fields__}
    for kind in kinds:
        for field in fields(kind):
            if field.name not in shared:
                assert (kind, field.name) in seen
    for name in shared:
        assert any(name == found for _, found in seen), name


def write(value: list[str]) -> bytes:
    """Bytes from lines alone, by the rules of the README: a writer in another language, as it were."""
    out = bytearray()
    for line in value:
        path, kind, *rest = line.split(" ", 2)
        content = rest[0] if rest else ""
        if path != "$" and not path.endswith("]"):
            out += text_of(path.rpartition(".")[2])
        out += {
            "map": lambda c: sized(int(c), 0x80, 16, (0, 0xDE, 0xDF)),
            "array": lambda c: sized(int(c), 0x90, 16, (0, 0xDC, 0xDD)),
            "str": text_of,
            "bin": lambda c: sized(len(c) // 2, 0, 0, (0xC4, 0xC5, 0xC6)) + bytes.fromhex(c),
            "int": lambda c: integer(int(c)),
            "float": lambda c: b"\xcb" + struct.pack(">d", float(c)),
            "bool": lambda c: b"\xc3" if c == "true" else b"\xc2",
            "nil": lambda _: b"\xc0",
        }[kind](content)
    return bytes(out)


def text_of(content: str) -> bytes:
    data = content.encode()
    return sized(len(data), 0xA0, 32, (0xD9, 0xDA, 0xDB)) + data


def sized(length: int, short: int, below: int, heads: tuple[int, int, int]) -> bytes:
    if length < below:
        return bytes([short | length])
    if heads[0] and length < 1 << 8:
        return bytes([heads[0], length])
    if length < 1 << 16:
        return bytes([heads[1]]) + struct.pack(">H", length)
    return bytes([heads[2]]) + struct.pack(">I", length)


def integer(value: int) -> bytes:
    if -32 <= value < 128:
        return struct.pack("b", value) if value < 0 else bytes([value])
    if value < 0:
        form = next(f for f in "bhiq" if value >= -(1 << (8 * struct.calcsize(f) - 1)))
        return bytes([0xD0 + "bhiq".index(form)]) + struct.pack(f">{form}", value)
    form = next(f for f in "BHIQ" if value < 1 << 8 * struct.calcsize(f))
    return bytes([0xCC + "BHIQ".index(form)]) + struct.pack(f">{form}", value)


@pytest.mark.parametrize("name", [name for name in FILES if name != "malformed"])
def test_an_independent_reader_and_writer_agree_with_ours(name: str) -> None:
    for vector in FILES[name]:
        data = bytes.fromhex(vector["hex"])
        value = msgpack.unpackb(data, strict_map_key=True)
        assert list(make_lines(value)) == vector["value"], vector["name"]
        message = DECODE[vector["socket"]](data)
        assert encode(message).hex() == vector.get("meant", vector["hex"]), vector["name"]
        if name != "tolerated":
            assert write(vector["value"]) == data, vector["name"]


@pytest.mark.parametrize("vector", FILES["malformed"], ids=lambda vector: vector["name"])
def test_what_is_malformed_is_refused_with_its_path(vector: dict[str, Any]) -> None:
    with pytest.raises(WireError) as caught:
        DECODE[vector["socket"]](bytes.fromhex(vector["hex"]))
    assert caught.value.path == vector["path"]


def test_the_files_are_flat() -> None:
    for file in FILES.values():
        for vector in file:
            for value in vector.values():
                assert isinstance(value, str) or all(isinstance(line, str) for line in value)
                assert "\n" not in "".join(value)
        names = [(vector["socket"], vector["name"]) for vector in file]
        assert len(set(names)) == len(names)
