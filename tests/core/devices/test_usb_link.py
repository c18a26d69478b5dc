"""A claimed device: transfers, errors, and that no transfer is repeated."""

from __future__ import annotations

from array import array
from typing import Any

import pytest

import pacinian as pc
from pacinian.devices.usb import UsbKind
from pacinian.devices.usb_link import UsbLink
from pacinian.testing import UsbBus

from .fake_usb_devices import HANGS, PADS, Pad, plugged, refused

BUSY = "pads A: opening it: it is in use by another program: end that first"
FRAME = bytes(range(200))


def linked(bus: UsbBus, kind: UsbKind = PADS, serial: str = "A") -> UsbLink:
    return UsbLink(kind, kind.select(kind.list_devices(bus), serial))


@pytest.fixture
def bus() -> UsbBus:
    return UsbBus(Pad("A"))


@pytest.fixture
def pad(bus: UsbBus) -> Any:
    return bus.devices[0]


def test_frames_reach_it_whole_and_in_order_until_it_is_given_back(bus: UsbBus, pad: Pad) -> None:
    link = linked(bus)
    assert (link.serial, link.name, link.interface, link.gone) == ("A", "pads A", 0, False)
    assert (bus.open, pad.holder is None, pad.resets) == (1, False, 1)
    link.write(FRAME, 0.01)
    link.write(array("B", FRAME[::-1]), 0.0201)
    assert pad.took == FRAME + FRAME[::-1]
    assert pad.writes == [(200, 10), (200, 20)]
    link.write(b"", 0.0)
    assert pad.writes[-1] == (0, 1)  # timeout [ms]; 0 would be forever
    link.close()
    link.close()
    assert (bus.open, pad.holder) == (0, None)
    for act, doing in (
        (lambda: link.write(FRAME, 0.01), "sending a frame"),
        (lambda: link.control((0xC1, 1, 0, 0), 9, 0.01, "asking"), "asking"),
        (link.clear_halt, "ending a stall"),
    ):
        refused(act, f"pads A: {doing}: it is closed")
    assert (bus.open, len(pad.writes)) == (0, 3)


def test_requests_and_their_answers(bus: UsbBus, pad: Pad) -> None:
    link = linked(bus)
    link.write(FRAME, 0.01)
    assert link.control((0xC1, 1, 2, 3), 64, 0.01, "asking") == FRAME[:64]
    assert link.control((0x41, 2, 0, 0), b"hello", 0.01, "telling") == b""
    assert pad.told == [((0xC1, 1, 2, 3), b""), ((0x41, 2, 0, 0), b"hello")]
    for data in (64, b"hello"):
        setup = 0xC1 if data == 64 else 0x41, 9, 0, 0
        refused(
            lambda setup=setup, data=data: link.control(setup, data, 0.01, "asking"),
            "pads A: asking: it refuses (stall)",
        )
    pad.unplug()
    refused(lambda: link.control((0xC1, 1, 0, 0), 64, 0.01, "asking"), "pads A: " + PADS.gone)
    assert link.gone
    link.close()


def short(taken: int, hangs: str = HANGS) -> str:
    return f"pads A: sending a frame: it took {taken} of 200 bytes in 10 ms: {hangs}"


WRITES: dict[Any, str] = {
    "unplug": "pads A: it is gone: push it in",
    "stall": "pads A: sending a frame: it refuses (stall)",
    "timeout": f"pads A: sending a frame: it does not answer in time: {HANGS}",
    0: short(0),
    1: short(1),
    199: short(199),
}


@pytest.mark.parametrize("fault", WRITES)
def test_a_write_that_fails_is_an_error_at_once_and_not_repeated(
    bus: UsbBus, pad: Pad, fault: Any
) -> None:
    link = linked(bus)
    pad.fault = fault
    refused(lambda: link.write(FRAME, 0.01), WRITES[fault])
    assert len(pad.writes) == 1
    assert link.gone == (fault == "unplug")
    pad.fault = None
    if fault == "unplug":
        refused(link.clear_halt, WRITES[fault])
    else:
        link.clear_halt()
        link.write(FRAME, 0.01)
        assert pad.took.endswith(FRAME)
    link.close()
    assert bus.open == 0


def test_a_stall_lasts_until_it_is_mended(bus: UsbBus, pad: Pad) -> None:
    link = linked(bus)
    pad.fault = "stall"
    for _ in range(3):
        refused(lambda: link.write(FRAME, 0.01), WRITES["stall"])
    link.clear_halt()
    link.write(FRAME, 0.01)
    assert pad.took == FRAME
    link.close()


def test_why_it_may_hang_is_the_kinds(bus: UsbBus, pad: Pad) -> None:
    link = linked(bus, UsbKind("pads", PADS.usb, hangs="it is asleep"))
    pad.fault = "hang"
    late = "it does not answer in time: it is asleep"
    refused(lambda: link.write(FRAME, 0.01), f"pads A: sending a frame: {late}")
    refused(lambda: link.control((0xC1, 1, 0, 0), 9, 0.01, "asking"), f"pads A: asking: {late}")
    pad.fault = 7
    refused(lambda: link.write(FRAME, 0.01), short(7, "it is asleep"))
    assert not link.gone
    link.close()


def test_plugged_in_again_it_is_another_device_to_the_link(bus: UsbBus, pad: Pad) -> None:
    link = linked(bus)
    pad.unplug()
    bus.plug(pad)
    refused(lambda: link.write(FRAME, 0.01), WRITES["unplug"])
    assert link.gone
    assert not pad.took
    link.close()
    again = linked(bus)
    again.write(FRAME, 0.01)
    assert pad.took == FRAME
    again.close()
    assert bus.open == 0


def test_another_program_has_it_and_is_not_disturbed(bus: UsbBus, pad: Pad) -> None:
    first = linked(bus)
    refused(lambda: linked(bus), BUSY)
    first.write(FRAME, 0.01)
    assert (pad.took, pad.resets, bus.open) == (FRAME, 1, 1)
    first.close()
    linked(bus).close()


@pytest.mark.parametrize("configured", [False, True])
def test_a_driver_that_has_it_gives_way_and_is_back_afterwards(
    bus: UsbBus, pad: Pad, configured: bool
) -> None:
    pad.kernel_driver_bound, pad.configured = True, configured
    link = linked(bus)
    assert bus.calls == ["detach"] + ["set_configuration"] * (not configured)
    link.write(FRAME, 0.01)
    link.close()
    assert bus.calls[-1] == "attach"
    assert pad.kernel_driver_bound
    link.close()
    assert bus.calls.count("attach") == 1


def test_a_driver_is_back_also_where_it_could_not_be_claimed(bus: UsbBus, pad: Pad) -> None:
    pad.kernel_driver_bound, pad.configured, pad.holder = True, True, "another program"
    refused(lambda: linked(bus), BUSY)
    assert (bus.calls, pad.kernel_driver_bound) == (["detach", "attach"], True)


def test_systems_that_know_of_no_drivers(bus: UsbBus, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(*_: Any) -> bool:
        raise NotImplementedError

    monkeypatch.setattr(bus, "is_kernel_driver_active", unknown)
    linked(bus).close()
    assert bus.calls == ["set_configuration"]


def test_a_device_that_has_its_configuration_keeps_it(bus: UsbBus, pad: Pad) -> None:
    linked(bus).close()
    linked(bus).close()
    assert (pad.resets, bus.calls) == (1, ["set_configuration"])


@pytest.mark.parametrize("endpoints", [(), (0x81,)])
def test_one_that_has_no_endpoint_for_frames(
    bus: UsbBus, pad: Pad, endpoints: tuple[int, ...]
) -> None:
    pad.endpoints = endpoints
    refused(lambda: linked(bus), "pads A: opening it: it has no endpoint for frames (bulk OUT)")
    assert (bus.open, pad.holder) == (0, None)


def test_one_whose_interface_has_changed_since_it_was_seen(bus: UsbBus, pad: Pad) -> None:
    kind = UsbKind("pads", ((0xFF, 0x41, 1),))
    pad.interface = 0xFF, 0x41, 1
    one = kind.select(kind.list_devices(bus))
    pad.interface = 0xFF, 0x41, 2
    refused(
        lambda: UsbLink(kind, one), "pads A: opening it: it has no endpoint for frames (bulk OUT)"
    )


def test_it_goes_between_seeing_and_opening(bus: UsbBus, pad: Pad) -> None:
    one = PADS.select(PADS.list_devices(bus))
    pad.unplug()
    refused(lambda: UsbLink(PADS, one), "pads A: it is gone: push it in")
    assert bus.open == 0


def test_an_interruption_gives_it_back(
    bus: UsbBus, pad: Pad, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    pad.kernel_driver_bound = True
    monkeypatch.setattr(bus, "claim_interface", interrupted)
    with pytest.raises(KeyboardInterrupt):
        linked(bus)
    assert (bus.open, pad.kernel_driver_bound) == (0, True)


def test_errors_name_the_device_of_several() -> None:
    bus, pads = plugged("B", "A")
    links = [linked(bus, serial=serial) for serial in ("A", "B")]
    pads[0].fault = "stall"
    links[0].write(FRAME, 0.01)
    with pytest.raises(pc.BackendError, match=r"^pads B: sending a frame"):
        links[1].write(FRAME, 0.01)
    for link in links:
        link.close()
    assert bus.open == 0
