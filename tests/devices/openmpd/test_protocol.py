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
from pacinian.testing import ManualClock
from pacinian_plugins.backends.openmpd import OpenMpd, protocol
from pacinian_plugins.backends.openmpd.protocol import Packer, encode_divider, encode_off

from .fpga import Fpga

VECTORS = json.loads((Path(__file__).parent / "vectors.json").read_text(encoding="utf-8"))
ALL = np.arange(256)
STRAIGHT = pc.Wiring("A", 256, ALL, ALL)


def levels(given: dict[str, int]) -> np.ndarray:
    made = np.zeros((1, 256), np.uint16)
    for channel, level in given.items():
        made[0, int(channel)] = level
    return made


@pytest.mark.parametrize("case", VECTORS["frames"], ids=lambda case: case["what"])
def test_frames_by_hand(case: dict[str, Any]) -> None:
    (made,) = Packer([STRAIGHT]).pack(levels(case["phase"]), levels(case["amplitude"]))
    want = bytearray([case["fill"][0]] * 256 + [case["fill"][1]] * 256)
    for at, byte in case["bytes"].items():
        want[int(at)] = byte
    assert made.tobytes() == want


@pytest.mark.parametrize("case", VECTORS["off"], ids=lambda case: case["what"])
def test_what_silences_by_hand(case: dict[str, Any]) -> None:
    want = bytearray(3 * 512)
    for at in case["flags"]:
        want[512 + at] = 0x80
    assert encode_off(case["divide"], case["led"]).tobytes() == want


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4))
def test_the_board_emits_the_gains_that_the_levels_stand_for(seed: int, rows: int) -> None:
    random = np.random.default_rng(seed)
    phase = random.integers(0, 128, (rows, 256), np.uint16)
    amplitude = random.integers(0, 65, (rows, 256), np.uint16)
    clock = ManualClock()
    board = Fpga(clock.now)
    (made,) = Packer([STRAIGHT]).pack(phase, amplitude)
    assert board.take(made.tobytes()) == rows * 512
    clock.advance(0.01)
    want = pc.Frame(0, 0.0, phase, amplitude).gains(OpenMpd().capability)[-1]
    heard = board.gains()
    np.testing.assert_allclose(np.abs(heard), np.abs(want), atol=1e-6)
    odd = amplitude[-1] % 2 == 1  # they begin on a tick, and so are half a tick early
    np.testing.assert_allclose(heard[~odd], want[~odd], atol=1e-6)
    early = np.exp(2j * np.pi * 0.5 / 128)
    np.testing.assert_allclose(heard[odd], want[odd] * early, atol=1e-6)
    assert len(board.played) == rows


def test_pulse_lengths_make_the_sound_pressures_that_are_told() -> None:
    assert (protocol.PULSE_PRESSURES[0], protocol.PULSE_PRESSURES[-1]) == (0.0, 1.0)
    clock = ManualClock()
    board = Fpga(clock.now)
    (made,) = Packer([STRAIGHT]).pack(
        np.zeros((1, 256), np.uint16), np.minimum(ALL, 64)[None].astype(np.uint16)
    )
    board.take(made.tobytes())
    np.testing.assert_allclose(np.abs(board.gains())[:65], protocol.PULSE_PRESSURES, atol=1e-12)


def test_channels_of_boards_in_their_own_order_and_the_dead_are_silent() -> None:
    order = np.random.default_rng(1).permutation(256)
    alive = np.delete(ALL, [3, 200])
    two = pc.Wiring("B", 256, alive, 256 + np.arange(254))
    packer = Packer([pc.Wiring("A", 256, ALL, order), two])
    phase = (np.arange(510, dtype=np.uint16) % 128)[None].repeat(2, 0)
    amplitude = np.full((2, 510), 64, np.uint16)
    first, second = (np.frombuffer(made, np.uint8) for made in packer.pack(phase, amplitude))
    want = -order % 128
    want[0] |= 128
    for k in range(2):
        np.testing.assert_array_equal(first[512 * k :][:256], want)
    duty = second[256:512]
    assert (duty[3], duty[200]) == (0, 0)
    assert (duty[alive] == 64).all()
    np.testing.assert_array_equal(second[1:3], [127 & -257, 127 & -258])


@given(st.floats(100.0, 10_000.0))
def test_boards_play_a_little_faster_than_frames_come(rate: float) -> None:
    n = encode_divider(rate)
    assert 1 <= n <= 255
    assert 40_000.0 / n > rate
    assert n == 255 or 40_000.0 / (n + 1) <= rate


def test_dividers_of_usual_rates() -> None:
    assert [encode_divider(rate) for rate in (100.0, 1000.0, 2000.0, 10_000.0)] == [255, 39, 19, 3]


def test_light_and_divider_reach_the_board() -> None:
    clock = ManualClock()
    board = Fpga(clock.now)
    board.take(encode_off(39, (1, 2, 128)).tobytes())
    clock.advance(0.01)
    assert not board.waiting
    assert (board.divider, board.colour) == (39, 0x800201)
    assert not board.pulses().any()


@settings(max_examples=40)
@given(st.integers(0, 2048 + 1536), st.integers(0, 2**32 - 1))
def test_what_silences_does_so_wherever_frames_or_a_silence_were_cut(cut: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    clock = ManualClock()
    board = Fpga(clock.now)
    frames = random.integers(0, 128, 4 * 512, np.uint8)
    frames[::512] |= 128
    quiet = encode_off(19, (0, 0, 0)).tobytes()
    board.take((frames.tobytes() + quiet)[:cut])
    board.take(quiet)
    clock.advance(12 * 19 / 40_000)
    assert not board.pulses().any()
    assert board.divider == 19
    clock.advance(protocol.RESYNC_PAUSE)
    assert board.waiting == 0
    (made,) = Packer([STRAIGHT]).pack(levels({}), levels({"7": 64}))
    board.take(made.tobytes())
    assert board.pulses()[7].sum() == 64
