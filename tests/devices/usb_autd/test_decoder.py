"""The same bytes, the same verdicts: of the reference device and of the decoder in C."""

from __future__ import annotations

import json
import random
import subprocess
from pathlib import Path
from typing import Any

import pytest

from pacinian_plugins.backends.usb_autd.protocol import Verdict

from . import cases

ROOT = Path(__file__).parents[3]
SOURCES = ROOT / "firmware" / "usb-autd"
STRICT = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic", "-g", "-O1"]
SAFE = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
CASES = cases.cases()


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The C decoder, which ends at the first byte it may not touch."""
    made = tmp_path_factory.mktemp("usb-autd") / "check"
    sources = [SOURCES / "decoder.c", Path(__file__).parent / "check.c"]
    command = ["gcc", *STRICT, *SAFE, f"-I{SOURCES}", *sources, "-o", made]
    subprocess.run(command, check=True)
    return made


def test_the_file_is_what_the_script_writes() -> None:
    assert json.loads(cases.FILE.read_text(encoding="utf-8")) == cases.vectors()


def test_every_verdict_is_in_the_file() -> None:
    read = json.loads(cases.FILE.read_text(encoding="utf-8"))
    told = {v for case in read["cases"] for step in case["steps"] for v in step.get("verdicts", ())}
    assert told == {verdict.name for verdict in Verdict}


EXPECTED = {
    "a short write: the next frame is found": [[], [Verdict.CORRUPT, Verdict.OK], [Verdict.OK]],
    "cut, then silenced": [[], [Verdict.SEQUENCE], [Verdict.OK]],
    "a frame within a damaged frame": [[Verdict.CORRUPT, Verdict.OK], [Verdict.OK]],
    "a kind of a newer minor version": [[Verdict.KIND], [Verdict.OK]],
    "flags of a newer minor version": [[Verdict.OK]],
    "just attached": [[Verdict.DISARMED]],
    "armed anew": [[Verdict.OK], [Verdict.OK], [Verdict.SESSION], [Verdict.OK]],
    "the sequence begins anew": [[Verdict.OK], [Verdict.OK]],
    "an older frame": [[Verdict.OK], [Verdict.SEQUENCE]],
}


@pytest.mark.parametrize("name", EXPECTED)
def test_some_by_hand(name: str) -> None:
    assert cases.ask(*CASES[name])[0] == EXPECTED[name]


@pytest.mark.deep("gcc")
def test_both_say_the_same_of_the_vectors(program: Path) -> None:
    lines = iter(cases.run(program, "".join(cases.script(*case) for case in CASES.values())))
    for name, case in CASES.items():
        verdicts, end = cases.ask(*case)
        assert [[int(v) for v in next(lines).split()] for _ in verdicts] == verdicts, name
        assert [int(v) for v in next(lines).split()] == end, name


@pytest.mark.deep("gcc")
def test_both_say_the_same_of_damaged_streams(program: Path) -> None:
    chance = random.Random(1)
    told = [(can, _damaged(steps, chance)) for _ in range(25) for can, steps in CASES.values()]
    lines = iter(cases.run(program, "".join(cases.script(*case) for case in told)))
    sound = 0
    for case in told:
        verdicts, end = cases.ask(*case)
        assert [[int(v) for v in next(lines).split()] for _ in verdicts] == verdicts
        assert [int(v) for v in next(lines).split()] == end
        sound += end[0]
    assert sound > len(told) / 4  # not only noise


def _damaged(steps: list[cases.Step], chance: random.Random) -> list[cases.Step]:
    """The same with its bytes cut elsewhere, and some of them wrong, twice, or gone; and a frame that is right."""
    made: list[cases.Step] = []
    for name, *value in steps:
        if name != "feed":
            made.append([name, *value])
            continue
        data = bytearray(value[0])
        for _ in range(chance.choice((0, 0, 1, 1, 2, 5))):
            _spoil(data, chance)
        while data:
            size = chance.choice((1, 3, 20, 64, 512, 4096))
            made.append(["feed", bytes(data[:size])])
            del data[:size]
    return [*made, ["feed", cases.message(chance.randrange(1 << 32))]]


def _spoil(data: bytearray, chance: random.Random) -> Any:
    if not data:
        return
    at = chance.randrange(len(data))
    match chance.randrange(5):
        case 0:
            data[at] ^= 1 << chance.randrange(8)
        case 1:
            del data[at : at + chance.randrange(64)]
        case 2:
            data[at:at] = data[at : at + chance.randrange(64)]
        case 3:
            data[at:at] = chance.choice((b"\xa5", b"\xa5U", b"\xa5UAD", cases.message(9)[:24]))
        case _:
            start = data.find(b"\xa5UAD", at)
            # a header that is right, and says something else
            if start >= 0 and len(data) >= start + 36:
                length = int.from_bytes(data[start + 8 : start + 12], "little")
                if start + length <= len(data):
                    place = chance.choice((4, 5, 8, 9, 12, 16, 24, 26, 27, 28, 30, 32))
                    whole = bytes(data[start : start + length])
                    if place + 1 < len(whole) - 4:
                        wrong = cases.altered(whole, place, chance.randrange(256))
                        data[start : start + length] = wrong
