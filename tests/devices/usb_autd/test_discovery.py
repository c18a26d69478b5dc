"""Which devices are found and opened, and what the user sees where one cannot be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import UsbBus
from pacinian_plugins.backends.usb_autd import UsbAutd

from .device_setup import ARRAY, UDEV, Setup
from .units import Units


def test_without_serials_those_that_can_be_used_are_enough() -> None:
    it = Setup("PUA-1", "PUA-2", "PUA-3", "PUA-4")
    it.device.denied = True
    it.plugged[2].interface = 0xFF, 0x41, 2  # the next major version
    it.plugged[3].serial = None
    nameless = "it has no serial number: its firmware must give it one"
    it.array, it.backend.serials = ARRAY, ["PUA-1"]
    it.refused(
        it.open,
        "usb-autd PUA-1: is not connected; there are: PUA-2; "
        f"bus 1, address 2: {UDEV}; bus 1, address 5: {nameless}",
    )
    it.backend.serials = ()
    it.open()
    assert [board.name for board in it.backend.boards] == ["usb-autd PUA-2"]
    it.backend.close()


def test_none_is_connected() -> None:
    it = Setup()
    it.bus.devices.clear()
    it.refused(it.open, "usb-autd: is not connected; there are: none")


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


def test_a_report_that_is_none_is_an_error_of_the_device() -> None:
    it = Setup()
    it.device.model.ask = lambda request: b"\0" * 64  # type: ignore[method-assign]
    it.refused(
        it.open,
        "usb-autd PUA-1: is no device of this format: "
        "the report has 64 bytes and states a length of 0; at least 64 are needed",
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
    device = Units("PUA-1", **can)
    bus = UsbBus(device)
    backend = UsbAutd(library=bus, **options)
    with pytest.raises(pc.BackendError) as caught:
        backend.open(ARRAY)
    assert str(caught.value) == message
    assert (bus.open, backend.boards) == (0, [])


def test_another_backend_has_it_and_is_not_disturbed() -> None:
    it = Setup("PUA-1").open()
    it.play()
    other = UsbAutd(library=it.bus)
    it.refused(
        lambda: other.open(ARRAY),
        "usb-autd PUA-1: opening it: it is in use by another program: end that first",
    )
    assert it.sounding()
    it.play()
    it.backend.close()
    other.open(ARRAY)
    other.close()


def test_what_is_connected_is_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    it = Setup("PUA-2", "PUA-1", "PUA-3")
    it.plugged[2].denied = True
    find = __import__("usb.core").core.find
    monkeypatch.setattr("usb.core.find", lambda **given: find(**{**given, "backend": it.bus}))
    assert list(UsbAutd.find_devices()) == [
        pc.FoundDevice("usb-autd", "", "AUTD units, bus 1, address 4", UDEV),
        pc.FoundDevice("usb-autd", "PUA-1", "AUTD units, bus 1, address 3"),
        pc.FoundDevice("usb-autd", "PUA-2", "AUTD units, bus 1, address 2"),
    ]
    assert it.bus.open == 0


def test_an_array_that_is_no_units_needs_a_description() -> None:
    it = Setup()
    it.array = pc.lattice(0.15, 0.15, 0.01)
    it.refused(
        it.open, "usb-autd: 256 transducers are no whole AUTD units of 249: give a `description`"
    )


@pytest.mark.parametrize("options", [{"watchdog": 0}, {"lead": -1}, {"timeout": 0.0}])
def test_bad_settings_are_named(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        UsbAutd(**options)
