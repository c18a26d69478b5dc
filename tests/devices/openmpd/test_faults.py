"""What goes wrong while it plays: what the user sees, what it costs, and that nothing is repeated."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.openmpd.protocol import RESYNC_PAUSE

from .chips import BITMODE, GONE, LATENCY, RESET, TIMEOUT, Setup


def test_it_is_silent_when_it_is_open_sounds_with_frames_and_is_silent_when_it_is_closed() -> None:
    it = Setup(led=[0, 9, 0])
    it.fpga.take(bytes([0x80] + [0] * 255 + [64] * 256))  # what a program before it has left
    assert it.sounding()
    it.open()
    assert it.chip.requests == [(RESET, 0), (BITMODE, 0xFF), (LATENCY, 2), (RESET, 1), (RESET, 2)]
    assert it.clock.now() == RESYNC_PAUSE
    assert not it.sounding()
    assert (it.fpga.divider, it.fpga.colour) == (19, 0x000900)
    it.play()
    assert it.sounding()
    assert it.backend.capability.watchdog is None
    it.backend.silence()
    it.backend.silence()
    assert not it.sounding(0.005)
    it.play()
    assert it.sounding()
    it.backend.close()
    it.backend.close()
    assert not it.sounding(0.005)
    assert it.fpga.colour == 0
    assert (it.bus.open, it.chip.holder) == (0, None)
    it.refused(lambda: it.backend.send(it.frame()), "openmpd is not open")
    it.backend.silence()


SHORT = "the board hangs, has no power, or the bus is overloaded"
WRITES: dict[Any, str] = {
    "unplug": GONE,
    "stall": "openmpd FT1: sending a frame: it refuses (stall)",
    "timeout": f"openmpd FT1: sending a frame: {TIMEOUT}",
    100: f"openmpd FT1: sending a frame: it took 100 of 1024 bytes in 11 ms: {SHORT}",
    512: f"openmpd FT1: sending a frame: it took 512 of 1024 bytes in 11 ms: {SHORT}",
    700: f"openmpd FT1: sending a frame: it took 700 of 1024 bytes in 11 ms: {SHORT}",
}


@pytest.mark.parametrize("fault", WRITES)
def test_a_write_that_fails_is_an_error_at_once_and_not_repeated(fault: Any) -> None:
    it = Setup().open()
    it.play()
    assert not it.fpga.waiting
    writes, played = len(it.chip.writes), len(it.fpga.played)
    it.chip.fault = fault
    it.refused(lambda: it.backend.send(it.frame()), WRITES[fault])
    assert len(it.chip.writes) == writes + 1  # once
    it.clock.advance(0.005)
    whole = fault // 512 if isinstance(fault, int) else 0
    assert len(it.fpga.played) == played + whole
    assert it.sounding()  # there is no watchdog
    it.chip.fault = None
    if fault == "unplug":
        it.refused(it.backend.silence, GONE)  # it cannot be, and that is told
        it.backend.close()
        return
    it.backend.silence()  # the loop's answer to any error
    assert not it.sounding(0.005)
    it.refused(
        lambda: it.backend.send(it.frame()),
        "openmpd FT1: a frame was cut: it takes 1.3 s until the board has forgotten it",
    )
    assert not it.sounding(RESYNC_PAUSE)
    it.play()  # after a reset of the renderer
    assert it.sounding()
    assert it.fpga.waiting == 0
    it.backend.close()


def test_frames_after_a_cut_one_wait_for_as_long_as_it_takes_also_without_a_silence() -> None:
    it = Setup().open()
    it.play()
    it.chip.fault = 700
    with pytest.raises(pc.BackendError):
        it.backend.send(it.frame())
    assert it.fpga.waiting == 188
    it.clock.advance(1.0)
    it.refused(
        lambda: it.backend.send(it.frame()),
        "openmpd FT1: a frame was cut: it takes 0.3 s until the board has forgotten it",
    )
    it.clock.advance(0.31)
    it.play()
    np.testing.assert_allclose(np.abs(it.fpga.gains()), np.sin(0.5 * np.pi * 40 / 64))
    it.backend.close()


def test_the_wait_after_a_cut_frame_begins_with_the_last_bytes_that_were_sent() -> None:
    it = Setup().open()
    it.play()
    it.chip.fault = 700
    with pytest.raises(pc.BackendError):
        it.backend.send(it.frame())
    it.clock.advance(0.9)
    it.backend.silence()  # which is 188 bytes late in the FIFO
    it.clock.advance(0.6)
    assert it.fpga.waiting == 188
    it.refused(
        lambda: it.backend.send(it.frame()),
        "openmpd FT1: a frame was cut: it takes 0.7 s until the board has forgotten it",
    )
    it.clock.advance(0.7)
    it.play()
    assert it.fpga.waiting == 0
    it.backend.close()


def test_a_silence_that_fails_is_told_and_can_be_asked_for_again() -> None:
    it = Setup().open()
    it.play()
    for fault in ("timeout", 600, "stall"):
        it.chip.fault = fault
        with pytest.raises(pc.BackendError, match="openmpd FT1: sending a frame"):
            it.backend.silence()
        it.chip.fault = None
    it.backend.silence()
    assert not it.sounding(0.005)
    it.backend.close()


def test_a_board_that_hangs_holds_nobody_up() -> None:
    it = Setup().open()
    it.play()
    it.chip.fault = "hang"
    for act in (lambda: it.backend.send(it.frame()), it.backend.silence):
        it.refused(act, f"openmpd FT1: sending a frame: {TIMEOUT}")
    assert max(timeout for _, timeout in it.chip.writes) == 11  # [ms]
    it.backend.close()
    assert it.bus.open == 0


def test_one_that_hangs_does_not_keep_the_others_from_silence() -> None:
    it = Setup("FT1", "FT2").open()
    it.play()
    it.chip.fault = "hang"
    with pytest.raises(pc.BackendError, match="FT1"):
        it.backend.silence()
    it.clock.advance(0.005)
    assert it.fpga.pulses().any()  # until it is switched off
    assert not it.chips[1].model.pulses().any()
    it.chip.fault = None
    it.backend.close()
    assert not it.sounding(0.005)


def test_unplugged_and_plugged_in_again_it_is_found_by_its_serial_and_silenced() -> None:
    it = Setup("FT1", "FT2").open()
    it.play()
    it.chip.unplug()
    it.refused(lambda: it.play(1), GONE)
    it.refused(it.backend.silence, GONE)
    it.clock.advance(0.005)
    assert it.fpga.pulses().any()
    assert not it.chips[1].model.pulses().any()
    it.refused(it.open, "openmpd FT1: is not connected; there are: FT2")
    it.bus.plug(it.chip)
    assert it.chip.address == 4
    it.refused(lambda: it.backend.send(it.frame()), "openmpd is not open")
    it.open()
    assert not it.sounding()
    it.play()
    assert all(chip.model.pulses().any() for chip in it.chips)
    it.backend.close()


def test_when_the_server_is_killed_in_the_middle_of_a_frame_the_next_finds_its_way() -> None:
    it = Setup().open()
    it.play()
    it.chip.fault = 300
    with pytest.raises(pc.BackendError):
        it.backend.send(it.frame())
    it.clock.advance(0.5)
    assert it.sounding()  # nobody has told it anything
    it.bus.plug(it.chip)  # what the system does: the claim ends
    it.backend.boards = []
    it.open()
    assert not it.sounding()
    it.play(level=64)
    np.testing.assert_allclose(np.abs(it.fpga.gains()), 1.0)
    assert it.fpga.waiting == 0
    it.backend.close()


def test_frames_do_not_pile_up_and_silence_is_soon() -> None:
    it = Setup().open()
    for _ in range(2000):
        it.backend.send(it.frame())
        it.clock.advance(1e-3)
        assert it.fpga.waiting == 0  # two frames of 0.475 ms
    it.backend.send(it.frame())
    it.backend.silence()
    assert it.sounding(2.9 * 19 / 40_000)  # two frames, and zeros
    assert not it.sounding(0.2 * 19 / 40_000)
    it.backend.close()


def test_a_loop_that_makes_up_for_lost_time_fills_the_fifo_and_silence_waits_for_it() -> None:
    it = Setup().open()
    begun = it.clock.now()
    for _ in range(40):
        it.backend.send(it.frame())  # blocks where the board is full, and fails not
    assert it.clock.now() - begun > 40 * 19 / 40_000
    assert it.fpga.waiting > 28 * 512
    it.backend.silence()
    assert it.sounding()
    assert not it.sounding(32 * 19 / 40_000)
    it.backend.close()


def test_a_loop_that_is_too_slow_is_told() -> None:
    it = Setup().open()
    it.backend.send(it.frame(rows=16))
    it.refused(
        lambda: it.backend.send(it.frame(rows=17)),
        "openmpd: a tick has 17 frames, but the boards can hold only 16: "
        "run the loop at 125 Hz or more, or lower `rate`",
    )
    for frame in (it.frame(level=65), it.frame(phase=128)):
        it.refused(
            lambda frame=frame: it.backend.send(frame),
            "openmpd: a frame contains levels that the boards cannot emit",
        )
    it.backend.close()
