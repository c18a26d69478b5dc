"""The bytes: by hand, and against what the FPGA makes of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian_plugins.backends.sonicsurface import SonicSurface
from pacinian_plugins.backends.sonicsurface.protocol import SELECT, Packer, frame_message

from .fpga import Board

VECTORS = json.loads((Path(__file__).parent / "vectors.json").read_text(encoding="utf-8"))
ALL = np.arange(256)
STRAIGHT = pc.Wiring("", 256, ALL, ALL)


def levels(given: dict[str, int]) -> np.ndarray:
    made = np.zeros(256, np.uint16)
    for channel, level in given.items():
        made[int(channel)] = level
    return made


@pytest.mark.parametrize("case", VECTORS["frames"], ids=lambda case: case["what"])
def test_frames_by_hand(case: dict[str, Any]) -> None:
    pattern = Packer([STRAIGHT]).pack(levels(case["phase"]), levels(case["amplitude"]))
    want = bytearray([case["fill"]]) * 256
    for at, byte in case["bytes"].items():
        want[int(at)] = byte
    assert frame_message(pattern, SELECT) == b"\xfe" + want + b"\xfd"


def test_two_boards_by_hand() -> None:
    one, two = bytes([5]) * 256, bytes([32]) * 256
    want = b"\xc0\xfe" + one + b"\xc1\xfe" + two + b"\xfd"
    assert frame_message(one + two, SELECT) == want
    as_the_readme_has_it = b"\xc0\xfe" + one + b"\xc0\xfe" + two + b"\xfd"
    assert frame_message(one + two, (0xC0, 0xC0)) == as_the_readme_has_it


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_the_board_emits_the_gains_that_the_levels_stand_for(seed: int) -> None:
    random = np.random.default_rng(seed)
    phase = random.integers(0, 32, 512, np.uint16)
    amplitude = random.integers(0, 2, 512, np.uint16)
    order = random.permutation(256)
    wirings = [pc.Wiring("A", 256, ALL, order), pc.Wiring("B", 256, ALL, 256 + ALL)]
    boards = Board(), Board(secondary=True)
    data = frame_message(Packer(wirings).pack(phase, amplitude), SELECT)
    for board in boards:
        board.take(data)
    want = pc.Frame(0, 0.0, phase[None], amplitude[None]).gains(SonicSurface().capability)[0]
    np.testing.assert_allclose(boards[0].gains(), want[order], atol=1e-6)
    np.testing.assert_allclose(boards[1].gains(), want[256:], atol=1e-6)


def test_dead_channels_are_off() -> None:
    alive = np.delete(ALL, [3, 200])
    packer = Packer([pc.Wiring("", 256, alive, np.arange(254))])
    ones = np.ones(254, np.uint16)
    pattern = packer.pack(ones, ones)
    assert [at for at, byte in enumerate(pattern) if byte != 31] == [3, 200]
    assert {pattern[3], pattern[200]} == {32}


def test_a_frame_that_was_cut_costs_itself_alone() -> None:
    board = Board()
    old, new = bytes([1]) * 256, bytes([2]) * 256
    board.take(frame_message(old, SELECT))
    board.take(frame_message(new, SELECT)[:100])
    assert (board.heard == 1).all()
    board.take(frame_message(new, SELECT))
    assert (board.heard == 2).all()
