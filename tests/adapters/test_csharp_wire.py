"""The C# core reads and writes every message as Python does, for any bytes, and without garbage."""

from __future__ import annotations

import random
import re
import subprocess
from typing import TYPE_CHECKING

import pytest

from pacinian.wire import commands, control, objects, protocol, replies
from pacinian.wire.codec import encode

from . import jsons, tools
from .mutations import mutated, vectors, verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from msgspec import Struct

    Program = Callable[[str], Path]

pytestmark = pytest.mark.deep("mono", "mcs")

TESTS = tools.CSHARP / "tests"
HUGE = re.compile(rb"\xcf[\x80-\xff]")  # integers beyond 63 bits, which C# has no type for
KNOWN = vectors()
STOP = b"\x82\xa4type\xa4stop"


@pytest.fixture(scope="module")
def both_sides(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the core with readers and writers of all messages."""
    return tools.core(tmp_path_factory.mktemp("both-sides"), tools.SERVER_SIDE.glob("*.cs"))


@pytest.fixture
def program(both_sides: Path) -> Program:
    """Return a function that compiles a test program beside the core, once."""

    def made(name: str) -> Path:
        path = both_sides.with_name(f"{name}.exe")
        sources = [TESTS / f"{name}.cs", TESTS / "VectorsDecoder.cs"]
        return path if path.exists() else tools.csharp(path, sources, both_sides)

    return made


def told(program: Path, lines: Iterable[str], folder: Path) -> str:
    """Return the last output of a program for some lines in a file; fail if it finds differences."""
    (folder / "lines").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return tools.run("mono", program, folder / "lines").splitlines()[-1]


def test_every_vector(program: Program, tmp_path: Path) -> None:
    lines = [verdict(*vector) for vector in KNOWN]
    assert told(program("Vectors"), lines, tmp_path) == f"{len(KNOWN)} messages, 0 differ"


def sizes() -> Iterator[tuple[str, Struct]]:
    """Yield socket and messages with heads of all lengths, and with numbers of all lengths."""
    key = {"session": bytes(16), "sequence": 1, "time": 0.0}
    for n in (31, 32, 255, 256, 1000):
        yield "reply", replies.Error(code="busy", message="ü" * n)
    for n in (0, 21, 22, 5461, 5462, 10_000):
        points = objects.Particles(positions=bytes(12 * n), force=1.0)
        yield "command", commands.Put(objects={"a": points}, **key)
    for n in (15, 16, 256):
        names = tuple(f"\U0001f590{i}" for i in range(n))
        yield "command", commands.Remove(names=names, **key)
        point = objects.Point(position=(0.0, 0.0, 0.1), priority=-n)
        yield "command", commands.Put(objects=dict.fromkeys(names, point), **key)
    edges = [
        s * 2**k + d for k in (0, 5, 7, 8, 15, 16, 31, 32, 62) for s in (1, -1) for d in (-1, 0)
    ]
    for whole in (*edges, 2**63 - 1, -(2**63)):
        choice = control.Choice(name="a", options={"a": whole, "b": float(whole)})
        yield "control", control.Select(session=bytes(16), solver=choice)


def test_all_lengths_of_heads_and_numbers(program: Program, tmp_path: Path) -> None:
    lines = [verdict(socket, encode(message)) for socket, message in sizes()]
    assert all("\tvalid\t" in line for line in lines)
    assert told(program("Vectors"), lines, tmp_path) == f"{len(lines)} messages, 0 differ"


def test_of_a_name_that_comes_twice_the_last_counts(program: Program, tmp_path: Path) -> None:
    """Also checks that a reused object never occurs twice."""
    points = {name: objects.Point(position=(0.0, 0.0, ord(name) / 1000)) for name in "abcd"}
    put = commands.Put(session=bytes(16), sequence=1, time=0.0, objects=points)
    data = encode(put)
    twice = data.replace(b"\xa1b", b"\xa1a"), data.replace(b"\xa1c", b"\xa1a")
    assert data.count(b"\xa1b") == data.count(b"\xa1c") == 1
    lines = [verdict("command", each) for each in (data, *twice, data, *twice)]
    assert told(program("Vectors"), lines, tmp_path) == "6 messages, 0 differ"


@pytest.mark.parametrize("seed", range(2))
def test_what_was_tampered_with(program: Program, tmp_path: Path, seed: int) -> None:
    choose = random.Random(seed)
    made = (mutated(KNOWN, choose) for _ in range(5000))
    lines = [verdict(socket, data) for socket, data in made if not HUGE.search(data)]
    assert told(program("Vectors"), lines, tmp_path) == f"{len(lines)} messages, 0 differ"
    assert 300 < sum("\tvalid\t" in line for line in lines) < 3000


DEPTH = protocol.MAX_CONTROL_BYTES - 100
SKIPPED = b"\x83" + STOP[1:] + b"\xa2id\x05\xa1x"
READ = STOP + b"\xa2id"
MEANT = "valid", "82a474797065a473746f70a2696405"


@pytest.mark.parametrize(
    ("data", "wanted"),
    [
        (SKIPPED + b"\x91" * DEPTH + b"\xc0", MEANT),
        (SKIPPED + b"\x81\xa1a" * (DEPTH // 3) + b"\xc0", MEANT),
        (SKIPPED + b"\xdd" + DEPTH.to_bytes(4, "big") + b"\x90" * DEPTH, MEANT),
        (SKIPPED + b"\xdd\xff\xff\xff\xff" * (DEPTH // 5), ("refused", "$")),
        (SKIPPED + b"\xdf\xff\xff\xff\xff" * (DEPTH // 5), ("refused", "$")),
        (b"\xdf\xff\xff\xff\xff" + b"\xa1a\x00" * (DEPTH // 3), ("refused", "$")),
        (READ + b"\x91" * DEPTH, ("refused", "$.id")),
        (READ + bytes(protocol.MAX_CONTROL_BYTES), ("refused", "$")),
    ],
)
def test_what_is_long_or_deep(
    program: Program, tmp_path: Path, data: bytes, wanted: tuple[str, str]
) -> None:
    """The stack must not overflow, and skipped values must not be stored."""
    line = "\t".join(["control", data.hex(), *wanted])
    assert told(program("Vectors"), [line], tmp_path) == "1 messages, 0 differ"
    told(program("VectorsGarbage"), [line], tmp_path)


def test_decoding_and_encoding_again_allocates_nothing(program: Program, tmp_path: Path) -> None:
    """Also checks that a rejected message allocates at most a few times its length."""
    lines = [verdict(*vector) for vector in KNOWN]
    last = told(program("VectorsGarbage"), lines, tmp_path)
    assert last == f"{len(lines)} messages, 0 with garbage"


def test_flat_json_as_msgspec_reads_it(program: Program) -> None:
    cases = list(jsons.cases(5000))
    given = "".join(f"{text.encode().hex()} {name.encode().hex()}\n" for text, name in cases)
    done = subprocess.run(
        ["mono", program("VectorsJson")], input=given, capture_output=True, text=True, check=True
    )
    for (text, name), line in zip(cases, done.stdout.splitlines(), strict=True):
        assert line.rstrip() == jsons.found(text, name), (text, name)
