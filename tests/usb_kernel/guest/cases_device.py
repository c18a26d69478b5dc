"""Life and faults of devices on a kernel's USB: run in the guest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.usb_autd import UsbAutd
from pacinian_plugins.backends.usb_autd.link import DEVICES
from pacinian_plugins.backends.usb_autd.protocol import State

from .device_setup import GONE, ROW, TIMEOUT, Playing, until

if TYPE_CHECKING:
    from collections.abc import Iterator

LATE = "it does not answer in time: it hangs, or the bus is overloaded"
WATCHDOG = 0.02  # [s]


@pytest.fixture
def it() -> Iterator[Playing]:
    """A device that plays."""
    with Playing("PUA-1") as made:
        made.open().play()
        assert made.sounding
        yield made


def test_it_is_listed_opened_by_its_serial_and_given_back() -> None:
    with Playing("PUA-1", serials=["PUA-1"]) as it:
        title = f"AUTD units, {it.places()[0]}"
        assert list(UsbAutd.find_devices()) == [pc.FoundDevice("usb-autd", "PUA-1", title)]
        it.open()
        assert it.model.status().state == State.SILENT
        it.play()
        assert it.model.status().state == State.SOUNDING
        it.backend.close()
        assert it.model.status().state == State.DISARMED
        it.open()
        it.play()
        assert it.sounding


def test_frames_for_nine_units_are_played_row_by_row_as_they_were_sent() -> None:
    random = np.random.default_rng(9)
    with Playing("PUA-9", kind={"units": 9}, lead=0.0) as it:
        it.open()
        for k in range(20):
            rows = 2, len(it.array)
            phase = random.integers(0, 640, rows, np.uint16)
            amplitude = random.integers(0, 320, rows, np.uint16)
            it.backend.send(pc.Frame(k, 0.0, phase, amplitude))
            for row in range(2):
                it.clock.time += ROW
                emitted = it.model.levels()
                np.testing.assert_array_equal(emitted[0], phase[row])
                np.testing.assert_array_equal(emitted[1], amplitude[row])
        status = it.model.status()
        assert (status.accepted, status.refused, status.corrupt, status.lost) == (20, 0, 0, 0)


def test_unplugged_in_the_middle_of_a_write(it: Playing) -> None:
    it.device.fault = "unplug"
    it.refused(lambda: it.play(1), GONE)
    it.refused(lambda: it.play(1), GONE)
    it.backend.silence()
    it.backend.close()
    until(lambda: not DEVICES.list_devices())
    it.refused(it.open, "usb-autd: is not connected; there are: none")


def test_plugged_in_again_it_is_silent_until_it_is_opened_by_its_serial(it: Playing) -> None:
    before = it.places()
    it.device.unplug()
    until(lambda: not DEVICES.list_devices())
    it.refused(lambda: it.play(1), GONE)
    it.device.plug()
    assert it.places() != before
    it.refused(lambda: it.play(1), GONE)
    assert it.model.status().state == State.DISARMED
    it.open()
    assert not it.sounding
    it.play()
    assert it.sounding


def test_a_stall_ends_with_silence(it: Playing) -> None:
    it.device.fault = "stall"
    for _ in range(2):
        it.refused(lambda: it.play(1), "usb-autd PUA-1: sending a frame: it refuses (stall)")
    assert it.model.status().accepted == 4
    it.backend.silence()
    assert not it.sounding
    it.play()
    assert it.sounding
    assert it.model.status().accepted == 8


def test_after_a_short_write_the_next_frame_is_found(it: Playing) -> None:
    taken = it.device.fault = 512
    it.refused(
        lambda: it.play(1),
        f"usb-autd PUA-1: sending a frame: it took {taken} of 847 bytes in {1e3 * TIMEOUT:g} ms: "
        "it hangs, or the bus is overloaded",
    )
    it.play(2)  # without the silence that the loop asks for after an error
    status = it.model.status()
    assert (status.accepted, status.corrupt, status.lost) == (6, 1, 1)
    assert it.sounding


def test_a_device_that_takes_nothing(it: Playing) -> None:
    it.device.fault = "timeout"
    it.refused(lambda: it.play(1), f"usb-autd PUA-1: sending a frame: {LATE}")
    assert it.sounding
    it.backend.silence()
    assert not it.sounding
    it.device.fault = None
    it.play()
    assert it.sounding
    status = it.model.status()
    assert (status.accepted, status.corrupt) == (8, 0)


def test_a_device_that_answers_nothing_is_silenced_by_its_watchdog(it: Playing) -> None:
    it.device.fault = "hang"
    it.refused(lambda: it.play(1), f"usb-autd PUA-1: sending a frame: {LATE}")
    it.refused(it.backend.silence, f"usb-autd PUA-1: asking for silence: {LATE}")
    assert it.sounding
    it.clock.time += WATCHDOG
    assert not it.sounding
    assert it.model.status().tripped == 1


def test_two_devices_are_chosen_by_serial() -> None:
    with Playing("PUA-1", "PUA-2", serials=["PUA-2", "PUA-1"]) as it:
        it.open()
        levels = np.zeros((1, 498), np.uint16)
        levels[:, :249], levels[:, 249:] = 2, 1
        it.backend.send(pc.Frame(0, 0.0, levels, levels))
        it.clock.time += 0.0025
        assert [int(one.model.levels()[1].max()) for one in it.plugged] == [1, 2]
        it.backend.close()
        it.backend.serials, it.array = ["PUA-2"], pc.autd()
        it.open()
        states = [one.model.status().state for one in it.plugged]
        assert states == [State.DISARMED, State.SILENT]


def test_two_devices_of_one_serial_are_refused() -> None:
    with Playing("PUA-1", "PUA-1") as it:
        where = " and ".join(it.places())
        it.refused(
            it.open, f"usb-autd PUA-1: 2 devices have this serial number, at {where}: unplug one"
        )
        assert all(one.model.status().state == State.DISARMED for one in it.plugged)
