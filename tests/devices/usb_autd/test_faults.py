"""What goes wrong while it plays: what the user sees, that it is silent, and that nothing is repeated."""

from __future__ import annotations

from typing import Any

import pytest

import pacinian as pc
from pacinian_plugins.backends.usb_autd.protocol import State

from .device_setup import AGAIN, GONE, Setup, frame


def test_it_is_silent_when_it_is_open_sounds_with_frames_and_is_disarmed_when_it_is_closed() -> (
    None
):
    it = Setup().open()
    assert it.device.model.status().state == State.SILENT
    it.play()
    assert it.sounding()
    assert it.backend.capability == pc.Capability(640, 320, 2000, 0.02)
    it.backend.silence()
    it.backend.silence()
    assert not it.sounding()
    it.play()
    assert it.sounding()
    it.backend.close()
    it.backend.close()
    assert not it.sounding()
    assert it.device.model.status().state == State.DISARMED
    assert (it.bus.open, it.device.holder) == (0, None)
    it.refused(lambda: it.backend.send(frame()), "usb-autd is not open")
    it.backend.silence()


WRITES: dict[Any, str] = {
    "unplug": GONE,
    "stall": "usb-autd PUA-1: sending a frame: it refuses (stall)",
    "timeout": "usb-autd PUA-1: sending a frame: it does not answer in time: it hangs, or the bus is overloaded",
    100: "usb-autd PUA-1: sending a frame: it took 100 of 847 bytes in 10 ms: it hangs, or the bus is overloaded",
    512: "usb-autd PUA-1: sending a frame: it took 512 of 847 bytes in 10 ms: it hangs, or the bus is overloaded",
    0: "usb-autd PUA-1: sending a frame: it took 0 of 847 bytes in 10 ms: it hangs, or the bus is overloaded",
}


@pytest.mark.parametrize("fault", WRITES)
def test_a_write_that_fails_is_an_error_at_once_and_not_repeated(fault: Any) -> None:
    it = Setup().open()
    it.play()
    assert it.sounding()
    accepted, writes = it.device.model.status().accepted, len(it.device.writes)
    it.device.fault = fault
    it.refused(lambda: it.backend.send(frame()), WRITES[fault])
    assert len(it.device.writes) == writes + 1  # once
    assert it.device.model.status().accepted == accepted
    it.device.fault = None
    it.backend.silence()  # the loop's answer to any error
    assert not it.sounding()
    if fault == "unplug":
        return
    it.play()  # after a reset of the renderer: what was cut does no harm
    status = it.device.model.status()
    assert it.sounding()
    assert (status.accepted, status.corrupt) == (accepted + 5, 0)
    it.backend.close()


def test_without_a_silence_a_short_write_costs_that_frame_only() -> None:
    it = Setup().open()
    it.play(3)
    it.device.fault = 300
    with pytest.raises(pc.BackendError):
        it.backend.send(frame())
    it.play(3)
    status = it.device.model.status()
    assert (status.accepted, status.corrupt, status.lost) == (6, 1, 1)
    it.backend.close()


def test_a_device_that_hangs_holds_nobody_up_and_its_watchdog_silences_it() -> None:
    it = Setup().open()
    it.play()
    it.device.fault = "hang"
    late = "it does not answer in time: it hangs, or the bus is overloaded"
    it.refused(lambda: it.backend.send(frame()), f"usb-autd PUA-1: sending a frame: {late}")
    it.refused(it.backend.silence, f"usb-autd PUA-1: asking for silence: {late}")
    assert {timeout for _, timeout in it.device.writes} == {10}  # [ms]
    it.clock.advance(0.02)
    assert not it.sounding()
    it.backend.close()


def test_one_that_hangs_does_not_keep_the_others_from_silence() -> None:
    it = Setup("PUA-1", "PUA-2").open()
    it.play()
    it.device.fault = "hang"
    with pytest.raises(pc.BackendError, match="PUA-1"):
        it.backend.silence()
    assert it.device.model.levels()[1].any()  # until its watchdog
    assert not it.plugged[1].model.levels()[1].any()
    it.backend.close()


def test_when_the_server_is_killed_the_watchdog_silences_it() -> None:
    it = Setup().open()
    it.play()
    assert it.sounding()
    it.clock.advance(0.02)  # nothing more comes, and nobody says so
    assert not it.sounding()
    assert it.device.model.status().tripped == 1


def test_unplugged_and_plugged_in_again_it_is_found_by_its_serial_and_silent_until_armed() -> None:
    it = Setup("PUA-1", "PUA-2").open()
    it.play()
    it.device.unplug()
    it.refused(lambda: it.play(1), GONE)
    it.backend.silence()  # of the other one; the one that has gone is silent by itself
    assert not it.sounding()
    it.refused(
        it.open,
        "usb-autd: the array has 498 transducers, and its devices 249: usb-autd PUA-2 (249)",
    )
    it.bus.plug(it.device)
    assert it.device.address == 4
    it.refused(lambda: it.backend.send(frame(N=498)), "usb-autd is not open")
    assert not it.sounding()
    it.open()
    assert not it.sounding()
    it.play()
    assert all(one.model.status().state == State.SOUNDING for one in it.plugged)
    it.backend.close()


def test_a_device_that_was_disarmed_is_noticed() -> None:
    it = Setup().open()
    it.play()
    it.device.model.reset()  # as a suspend does
    message = (
        f"usb-autd PUA-1: is disarmed: it was reset, is too hot, or another program has it: {AGAIN}"
    )
    it.refused(lambda: it.play(300), message)
    it.backend.close()


def test_a_device_that_accepts_nothing_is_noticed() -> None:
    it = Setup().open()
    it.backend.boards[0]._sequence = 0x7FFFFFFF
    it.refused(
        lambda: it.play(300), "usb-autd PUA-1: accepts no frames: the last refusal was 'sequence'"
    )
    it.backend.close()


def test_a_loop_that_is_too_slow_for_the_buffer_is_told() -> None:
    it = Setup().open()
    it.refused(
        lambda: it.backend.send(frame(rows=20)),
        "usb-autd: a tick has 20 rows, but the device can hold only 12: run the loop at 167 Hz or more, or with a "
        "shorter `lead`",
    )
    it.refused(
        lambda: it.backend.send(frame(level=320)),
        "usb-autd: a frame contains levels that the device cannot emit",
    )
    it.backend.close()
