"""Finding devices, choosing one, and the message if that is not possible."""

from __future__ import annotations

import errno
from typing import Any

import pytest

import pacinian as pc
from pacinian.devices.usb import ListedDevice, UsbKind
from pacinian.devices.usb_errors import advice, has_gone
from pacinian.testing import UsbBus
from pacinian.testing.usb_device import error

from .fake_usb_devices import KIND, PADS, UDEV, Pad, plugged, refused

NONE = "is not connected; there are: none"
WHERE = "bus 1, address 2"


def describe_listed(listed: list[ListedDevice]) -> list[tuple[str, str, str]]:
    return [(one.serial, one.address, one.problem) for one in listed]


def test_those_of_the_vendor_and_product_are_seen_by_serial_and_none_stays_open() -> None:
    bus, _ = plugged("B", "A")
    other = Pad("C")
    other.product = 0x0003
    bus.plug(other)
    listed = PADS.list_devices(bus)
    assert describe_listed(listed) == [("A", "bus 1, address 3", ""), ("B", WHERE, "")]
    assert bus.open == 0
    assert not bus.calls


def test_those_of_the_interface_are_seen_whoever_made_them() -> None:
    bus, (ours, newer, odd) = plugged("A", "B", "C")
    ours.interface = odd.interface = 0xFF, 0x41, 1
    newer.interface = 0xFF, 0x41, 2
    odd.vendor = 0x16D0
    assert [one.serial for one in KIND.list_devices(bus)] == ["A", "C"]


def test_a_device_whose_descriptors_cannot_be_read_is_none_of_an_interface(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bus, (broken, ours) = plugged("A", "B")
    ours.interface = broken.interface = 0xFF, 0x41, 1
    read = bus.get_configuration_descriptor

    def descriptor(dev: Any, *at: int) -> Any:
        if dev is broken:
            raise error(errno.EIO)
        return read(dev, *at)

    monkeypatch.setattr(bus, "get_configuration_descriptor", descriptor)
    assert [one.serial for one in KIND.list_devices(bus)] == ["B"]
    whole = describe_listed(PADS.list_devices(bus))  # the vendor id is enough
    assert whole == [("", WHERE, "[Errno 5] Input/Output Error"), ("B", "bus 1, address 3", "")]


def test_one_without_a_serial_number_says_so() -> None:
    bus, _ = plugged(None, "")
    nameless = "it has no serial number, by which it could be chosen"
    assert {one.problem for one in PADS.list_devices(bus)} == {nameless}
    assert {one.serial for one in PADS.list_devices(bus)} == {""}
    kind = UsbKind("pads", PADS.usb, anonymous="give it one")
    assert {one.problem for one in kind.list_devices(bus)} == {"give it one"}
    refused(
        lambda: PADS.select(PADS.list_devices(bus), "A"),
        f"pads A: {NONE}; {WHERE}: {nameless}; bus 1, address 3: {nameless}",
    )


def test_a_dead_device_that_is_still_listed_is_passed_over() -> None:
    bus, (pad,) = plugged("A")
    bus.stale = True
    pad.unplug()
    assert not PADS.list_devices(bus)
    bus.plug(Pad("A"))
    assert [one.address for one in PADS.list_devices(bus)] == ["bus 1, address 3"]


@pytest.mark.parametrize("trouble", [{"mute": True}, {"fault": "hang"}])
def test_one_that_is_listed_and_answers_nothing(trouble: dict[str, Any]) -> None:
    bus, (pad,) = plugged("A")
    vars(pad).update(configured=True, **trouble)
    silent = "it does not answer: unplug it and plug it in again"
    assert describe_listed(PADS.list_devices(bus)) == [("", WHERE, silent)]


def test_without_the_right_or_a_driver_the_problem_says_what_to_do() -> None:
    bus, (denied, driverless, _) = plugged("A", "B", "C")
    denied.denied = driverless.no_user_driver = True
    driver = (
        "it has no driver that programs may use: give it WinUSB with Zadig (https://zadig.akeo.ie)"
    )
    place = "bus 1, address 3"
    assert describe_listed(PADS.list_devices(bus))[:2] == [("", WHERE, UDEV), ("", place, driver)]
    refused(
        lambda: PADS.select(PADS.list_devices(bus), "A"),
        f"pads A: is not connected; there are: C; {WHERE}: {UDEV}; {place}: {driver}",
    )
    assert PADS.select(PADS.list_devices(bus)).serial == "C"


def test_it_is_plugged_in_while_the_program_runs() -> None:
    bus, _ = plugged()
    refused(lambda: PADS.select(PADS.list_devices(bus)), f"pads: {NONE}")
    bus.plug(Pad("A"))
    assert PADS.select(PADS.list_devices(bus)).serial == "A"


def test_it_is_picked_by_its_serial_and_without_one_only_if_it_is_alone() -> None:
    listed = PADS.list_devices(plugged("B", "A")[0])
    assert PADS.select(listed, "B").address == WHERE
    refused(lambda: PADS.select(listed, "C"), "pads C: is not connected; there are: A, B")
    refused(lambda: PADS.select(listed), "pads: there are several: say which; there are: A, B")


def test_two_with_one_serial_are_an_error() -> None:
    refused(
        lambda: PADS.select(PADS.list_devices(plugged("A", "A")[0]), "A"),
        f"pads A: 2 devices have this serial number, at {WHERE} and bus 1, address 3: unplug one",
    )


def test_no_library(monkeypatch: pytest.MonkeyPatch) -> None:
    import usb.core

    def find(**_: Any) -> Any:
        raise usb.core.NoBackendError("No backend available")

    monkeypatch.setattr(usb.core, "find", find)
    missing = "libusb is not installed: `apt install libusb-1.0-0`, or `pip install libusb-package`"
    refused(PADS.list_devices, f"pads: {missing}")
    assert PADS.describe("a pad") == [("", "", missing)]


def test_a_bus_that_cannot_be_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> Any:
        raise error(errno.EIO)

    bus = UsbBus()
    monkeypatch.setattr(bus, "enumerate_devices", broken)
    with pytest.raises(pc.BackendError, match=r"pads: looking for devices: .*Input/Output Error"):
        PADS.list_devices(bus)


def test_what_is_told_of_them() -> None:
    bus, (pad, _) = plugged("B", "A")
    pad.denied = True
    assert PADS.describe("a pad", bus) == [
        ("", f"a pad, {WHERE}", UDEV),
        ("A", "a pad, bus 1, address 3", ""),
    ]


def test_errors_say_what_was_being_done_and_whose() -> None:
    assert str(PADS.convert_error(error(errno.EIO), "dreaming", "X")).startswith(
        "pads X: dreaming: [Errno 5] Input/Output Error"
    )
    assert str(PADS.convert_error(error(errno.EPIPE), "dreaming")) == (
        "pads: dreaming: it refuses (stall)"
    )
    assert str(PADS.convert_error(error(errno.ENODEV), "dreaming", "X")) == (
        "pads X: it is gone: push it in"
    )


@pytest.mark.parametrize("number", [errno.ENODEV, errno.ESHUTDOWN, errno.ENXIO])
def test_it_has_gone(number: int) -> None:
    assert has_gone(OSError(number, ""))
    assert not has_gone(OSError(errno.EIO, ""))
    assert not has_gone(ValueError())


def test_an_error_without_words_is_named() -> None:
    assert advice(KeyError()) == "KeyError"
    assert advice(OSError(errno.EPERM, "")) == UDEV
    assert "Zadig" in advice(OSError(errno.ENOSYS, ""))
