"""Which devices are found and opened, and what the user sees where one cannot be."""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.usb_autd import UsbAutd
from pacinian_plugins.backends.usb_autd.troubles import explained, holders

from ..usb_in_memory import Bus, Plugged, error
from .playing import ARRAY, UDEV, Setup, frame

if TYPE_CHECKING:
    from pathlib import Path


def test_a_dead_device_that_is_still_listed_is_passed_over() -> None:
    it = Setup("PUA-1")
    it.bus.stale = True
    it.device.unplug()
    it.refused(it.open, "usb-autd: is not connected; there are: none")
    again = Plugged("PUA-1", now=it.clock.now)
    it.bus.plug(again)
    it.open()
    it.play()
    assert again.model.levels()[1].any()
    it.backend.close()


def test_a_device_that_is_listed_and_answers_nothing() -> None:
    it = Setup("PUA-1", serials=["PUA-1"])
    it.device.configured = it.device.mute = True
    silent = "bus 1, address 2: it does not answer: unplug it and plug it in again"
    it.refused(it.open, f"usb-autd PUA-1: is not connected; there are: none; {silent}")


def test_it_is_plugged_in_while_the_program_runs() -> None:
    it = Setup("PUA-1")
    it.bus.devices.clear()
    it.refused(it.open, "usb-autd: is not connected; there are: none")
    it.bus.plug(it.device)
    it.open()
    it.backend.close()


def test_no_permission() -> None:
    it = Setup("PUA-1", "PUA-2")
    it.device.denied = True
    it.array = ARRAY
    it.backend.serials = ["PUA-1"]
    told = f"bus 1, address 2: {UDEV}"
    it.refused(it.open, f"usb-autd PUA-1: is not connected; there are: PUA-2; {told}")
    it.backend.serials = ()
    it.open()  # the other one is enough
    it.backend.close()


def test_no_driver_on_windows() -> None:
    it = Setup("PUA-1")
    it.device.driverless = True
    it.refused(
        it.open,
        "usb-autd: is not connected; there are: none; bus 1, address 2: it has no driver that "
        "programs may use: give it WinUSB with Zadig (https://zadig.akeo.ie)",
    )


def test_another_program_has_it() -> None:
    it = Setup("PUA-1")
    other = UsbAutd(library=it.bus)
    other.open(ARRAY)
    other.send(frame())
    it.clock.advance(0.004)
    it.refused(
        it.open, "usb-autd PUA-1: opening it: it is in use by another program: end that first"
    )
    assert it.sounding()  # it is the other's
    other.close()
    it.open()
    it.backend.close()


def test_who_holds_it_is_told_where_that_can_be_known(tmp_path: Path) -> None:
    for pid, node in (
        (12, "/dev/null"),
        (345, "/dev/bus/usb/001/002"),
        (7, "/dev/bus/usb/001/002"),
    ):
        fds = tmp_path / str(pid) / "fd"
        fds.mkdir(parents=True)
        (fds / "3").symlink_to(node)
        (fds.parent / "comm").write_text(f"program{pid}\n")
    (tmp_path / "99").mkdir()  # it has ended since
    assert holders(1, 2, tmp_path) == "program7 (7), program345 (345)"
    assert holders(1, 3, tmp_path) == ""
    assert str(os.getpid()) not in holders(250, 250)


def test_a_driver_that_has_it_gives_way_and_is_back_afterwards() -> None:
    it = Setup("PUA-1")
    it.device.driver = True
    it.open()
    assert it.bus.calls == ["detach", "set_configuration"]
    it.play()
    it.backend.close()
    assert it.bus.calls[-1] == "attach"
    assert it.device.driver


def test_a_device_that_has_its_configuration_keeps_it() -> None:
    it = Setup("PUA-1").open()
    it.backend.close()
    it.bus.calls.clear()
    it.open()
    assert not it.bus.calls
    it.backend.close()


def test_several_devices_of_one_kind_are_told_apart_by_their_serials() -> None:
    it = Setup("PUA-2", "PUA-1").open()
    levels = np.zeros((1, 498), np.uint16)
    levels[:, :249], levels[:, 249:] = 1, 2
    it.backend.send(pc.Frame(0, 0.0, levels, levels))
    it.clock.advance(0.004)
    second, first = (int(one.model.levels()[1].max()) for one in it.plugged)
    assert (first, second) == (1, 2)
    it.backend.close()
    it.backend.serials = ["PUA-2", "PUA-1"]
    it.open()
    assert [board.link.serial for board in it.backend.boards] == ["PUA-2", "PUA-1"]
    it.backend.close()


def test_two_devices_with_one_serial_are_an_error() -> None:
    it = Setup("PUA-1", "PUA-1")
    it.refused(
        it.open,
        "usb-autd PUA-1: 2 devices have this serial number, at bus 1, address 2 and bus 1, address 3",
    )
    assert it.bus.open == 0


def test_devices_of_other_kinds_are_left_alone() -> None:
    it = Setup("PUA-1", "PUA-2")
    it.plugged[1].interface = 0xFF, 0x41, 2  # the next major version
    it.array = ARRAY
    it.open()
    it.backend.close()


def test_a_report_that_is_none_is_an_error_of_the_device() -> None:
    it = Setup()
    it.device.model.ask = lambda request: b"\0" * 64  # type: ignore[method-assign]
    it.refused(
        it.open,
        "usb-autd PUA-1: is no device of this format: a report of 64 bytes, that says 0, of at least 64",
    )
    it.device.model.ask = lambda request: bytes([64, 1, 0, 99]) + bytes(60)  # type: ignore[method-assign]
    it.refused(it.open, "usb-autd PUA-1: is no device of this format: 99 units of 0 transducers")


@pytest.mark.parametrize(
    ("options", "can", "message"),
    [
        ({"watchdog": 0.2}, {}, "usb-autd PUA-1: its watchdog can be 5 to 100 ms, not 200 ms"),
        (
            {},
            {"transducers": 100},
            "usb-autd: the array has 249 transducers, and its devices 100: usb-autd PUA-1 (100)",
        ),
        (
            {},
            {"amplitudes": 256},
            "usb-autd PUA-1: has version, phases, amplitudes and rate (1, 640, 256, 2000), "
            "not (1, 640, 320, 2000): update Pacinian, or the device's firmware",
        ),
    ],
)  # fmt: skip
def test_a_device_that_does_not_fit_is_given_back(options: Any, can: Any, message: str) -> None:
    device = Plugged("PUA-1", **can)
    bus = Bus(device)
    backend = UsbAutd(library=bus, **options)
    with pytest.raises(pc.BackendError) as caught:
        backend.open(ARRAY)
    assert str(caught.value) == message
    assert (bus.open, backend.boards) == (0, [])


def test_an_array_that_is_no_units_needs_a_description() -> None:
    it = Setup()
    it.array = pc.lattice(0.15, 0.15, 0.01)
    it.refused(
        it.open, "usb-autd: 256 transducers are no whole AUTD units of 249: give a `description`"
    )


def test_no_library(monkeypatch: pytest.MonkeyPatch) -> None:
    import usb.core

    def find(**_: Any) -> Any:
        raise usb.core.NoBackendError("No backend available")

    monkeypatch.setattr(usb.core, "find", find)
    message = "usb-autd: libusb is not installed: `apt install libusb-1.0-0`, or `pip install libusb-package`"
    it = Setup()
    it.refused(it.open, message)
    (found,) = UsbAutd.found()
    assert f"usb-autd: {found.problem}" == message


def test_errors_that_nobody_expected_say_what_was_being_done() -> None:
    told = explained(error(errno.EIO), "usb-autd X", "sending a frame")
    assert str(told).startswith("usb-autd X: sending a frame: ")
    assert "Input/Output Error" in str(told)


def test_what_is_connected_is_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    it = Setup("PUA-2", "PUA-1", "PUA-3")
    it.plugged[2].denied = True
    find = __import__("usb.core").core.find
    monkeypatch.setattr("usb.core.find", lambda **given: find(**{**given, "backend": it.bus}))
    found = list(UsbAutd.found())
    assert [one.serial for one in found] == ["", "PUA-1", "PUA-2"]
    assert found[0].problem == UDEV
    assert found[1] == pc.Found("usb-autd", "PUA-1", "AUTD units, bus 1, address 3")
    assert it.bus.open == 0


@pytest.mark.parametrize("options", [{"watchdog": 0}, {"lead": -1}, {"timeout": 0.0}])
def test_bad_settings_are_named(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        UsbAutd(**options)
