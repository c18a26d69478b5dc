"""A server's guard, killed and not, with its device on a kernel's USB: run in the guest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.usb_autd import UsbAutd
from pacinian_plugins.backends.usb_autd.link import DEVICES
from pacinian_plugins.backends.usb_autd.protocol import Request, State

from .device_setup import GONE, TIMEOUT, until
from .plugged import Plugged
from .server import Server

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Note = Callable[[str, object], None]

WATCHDOG = 0.02  # [s]
STEP = 2.5e-4  # [s] of looking


@pytest.fixture
def device() -> Iterator[Plugged]:
    """A device with a clock of its own."""
    made = Plugged("PUA-1")
    made.plug()
    until(DEVICES.list_devices)
    yield made
    made.unplug()
    until(lambda: not DEVICES.list_devices())


def test_a_server_that_is_killed_is_survived_by_its_guard_which_silences(
    device: Plugged, record_property: Note
) -> None:
    with Server() as server:
        parent = server.adopted()
        server.until(lambda told: told.sounding, playing=True)
        device.kill = parent.kill  # in the middle of a write
        server.play()
        parent.wait()
        until(lambda: device.model.status().state == State.DISARMED)
        told = [(at, request) for at, request in device.told if at > device.written]
        assert told[0][1] == Request.SILENCE
        assert told[-1][1] == Request.DISARM
        record_property("seconds from the kill to SILENCE", told[0][0] - device.written)


def test_unplugged_it_plays_again_after_a_reset_and_when_the_guard_is_killed_its_watchdog_silences(
    device: Plugged, record_property: Note
) -> None:
    with Server() as server:
        guard = server.start()  # once for both: it takes long here
        server.until(lambda told: told.sounding, playing=True)
        device.unplug()
        assert server.until(lambda told: told.fault, playing=True).fault == GONE
        device.plug()
        until(DEVICES.list_devices)
        server.play()
        assert device.model.status().state == State.DISARMED
        server.reset()
        assert not server.device().fault
        server.until(lambda told: told.sounding, playing=True)
        assert device.model.status().accepted > 0
        told: list[tuple[float, int]] = []

        def kill() -> None:  # in the middle of a write
            told.extend(device.told)
            guard.kill()

        device.kill = kill
        server.play()
        guard.wait()
        late = silent_after(device)
        # its time runs from the last whole frame, which on a slow machine came some milliseconds before this write
        assert late < WATCHDOG + 2.0 * STEP
        assert device.told == told  # nobody tells a device of that
        assert device.model.status().state == State.SILENT
        record_property("seconds from the kill to silence", late)
    after = UsbAutd(timeout=TIMEOUT)
    after.open(pc.autd())  # it is free, and silent until the next frame
    assert len(device.told) > len(told)
    assert device.model.status().state == State.SILENT
    after.close()


def silent_after(device: Plugged) -> float:
    """From the last write to silence, by the model's own clock [s]."""
    with device.lock:
        after = STEP * np.arange(1, round(0.1 / STEP))
        loud = [bool(device.model.levels(device.written + t)[1].any()) for t in after]
    assert any(loud)
    return float(after[np.flatnonzero(loud)[-1] + 1])
